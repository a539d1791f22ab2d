"""A point mass as a thin lens: light that passes at the distance r is turned toward it by 2 r_s / r."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.screens.screen import Number, Screen, plain, unless_sound


@pytree
class PointMass(Screen):
    """W = -2 r_s ln(r / mm), Shapiro's delay up to a constant: a kick of 2 r_s / r = 4 G M / (c^2 r) toward the mass.

    schwarzschild_radius: r_s = 2 G M / c^2, mm. A ray through the mass itself goes straight on.
    Source: Schneider, Ehlers & Falco, Gravitational Lenses (1992), section 4.3.
    """

    schwarzschild_radius: Number

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:  # noqa: ARG002
        """W, mm; 0 at the mass.

        With s = max(|x|, |y|), ln r = ln s + ln((x/s)^2 + (y/s)^2) / 2 neither overflows nor underflows; it is the same
        for any s, which is therefore a constant to derivatives.
        """
        size = jax.lax.stop_gradient(jnp.maximum(jnp.abs(x), jnp.abs(y)))
        size = jnp.where(size > 0, size, 1)
        u, v = x / size, y / size
        square = u * u + v * v
        return -self.schwarzschild_radius * (2 * jnp.log(size) + jnp.log(jnp.where(square > 0, square, 1)))

    @property
    def is_round(self) -> bool:
        """As `Screen.is_round`: it does."""
        return True

    @property
    def label(self) -> str:
        """For the table of a lens."""
        return f"point mass, Schwarzschild radius {plain(self.schwarzschild_radius)} mm"

    @property
    def mistake(self) -> str:
        """A radius that is none."""
        return unless_sound(self.schwarzschild_radius, "point_mass: the Schwarzschild radius", positive=True)
