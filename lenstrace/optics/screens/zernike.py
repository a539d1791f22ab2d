"""A sum of Zernike polynomials as a screen: aberrations to order, or the command of a deformable mirror."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.optics.screens.screen import Number, Screen, plain, unless_sound
from lenstrace.optics.zernike import zernike_terms


@pytree
class ZernikeScreen(Screen):
    """W = sum of c_j Z_j(x / R, y / R); beyond r = R the polynomials go on.

    coefficients:  mm, one for each of the static `numbers` j.      radius: R, mm.
    order:         noll, fringe or ansi, see `zernike_index`; static.
    """

    coefficients: tuple[Number, ...]
    radius: Number
    numbers: tuple[int, ...] = static()
    order: str = static()

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:  # noqa: ARG002
        """W, mm."""
        terms = zernike_terms(self.order, self.numbers, x / self.radius, y / self.radius)
        return sum((c * term for c, term in zip(self.coefficients, terms, strict=True)), jnp.zeros_like(x))

    @property
    def label(self) -> str:
        """For the table of a lens."""
        terms = ", ".join(f"{j}: {plain(c)}" for j, c in zip(self.numbers, self.coefficients, strict=True))
        return f"Zernike ({self.order}) {terms} mm, radius {plain(self.radius)} mm"

    @property
    def mistake(self) -> str:
        """No terms, a radius that is none, a term that is not finite."""
        bad = [c for c in self.coefficients if not is_traced(c) and not abs(c) < float("inf")]
        return (
            unless_sound(self.radius, "zernike: the radius", positive=True)
            or ("" if self.numbers else "zernike: at least one term is needed, got none")
            or (f"zernike: a coefficient must be a finite number, got {bad[0]}" if bad else "")
        )
