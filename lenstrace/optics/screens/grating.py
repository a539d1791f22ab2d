"""A linear grating: one diffraction order of equidistant lines."""

from __future__ import annotations

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.optics.screens.screen import Number, Screen, plain, unless_sound


@pytree
class Grating(Screen):
    """W = m lambda u / period, u = x cos(a) + y sin(a): light of order m is turned toward +u.

    Across the lines n2 sin(b) = n1 sin(a) + m lambda / period, the grating equation.

    period:  mm, from one line to the next.      order: m, a whole number, of either sign.
    angle:   a, degrees, from x toward y: the direction across the lines.
    """

    period: Number
    order: Number = 1.0
    angle: Number = 0.0

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:
        """W, mm."""
        turn = jnp.asarray(self.angle, x.dtype) * (np.pi / 180)
        return self.order * wavelength / self.period * (x * jnp.cos(turn) + y * jnp.sin(turn))

    def scaled(self, unit: float) -> Grating:
        """The period is a length."""
        return dataclasses.replace(self, period=self.period * unit)

    @property
    def label(self) -> str:
        """For the table of a lens."""
        return f"grating {plain(self.period)} mm, order {plain(self.order)}, {plain(self.angle)} deg"

    @property
    def mistake(self) -> str:
        """A period that is none, an order that is not whole."""
        whole = is_traced(self.order) or float(self.order).is_integer()
        finite = is_traced(self.angle) or np.isfinite(self.angle)
        return (
            unless_sound(self.period, "grating: the period", positive=True)
            or ("" if whole else f"grating: the order must be a whole number, got {self.order:g}")
            or ("" if finite else f"grating: the angle must be a finite number, got {self.angle}")
        )
