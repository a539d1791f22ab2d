"""Screens that focus: the one that is perfect for a parallel beam along the axis, and the parabolic one."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.screens.screen import Number, Screen, plain, unless_sound


@pytree
class IdealLens(Screen):
    """W = f - sgn(f) sqrt(f^2 + r^2): in air, all light that comes parallel to the axis goes through one point, at f.

    focal_length: f, mm.
    """

    focal_length: Number

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:  # noqa: ARG002
        """W, mm, as -r^2 / (f + sgn(f) sqrt(f^2 + r^2)), which loses nothing near the axis."""
        r2 = x * x + y * y
        f = jnp.asarray(self.focal_length, x.dtype)
        return -r2 / (f + jnp.sign(f) * jnp.sqrt(f * f + r2))

    @property
    def is_round(self) -> bool:
        """As `Screen.is_round`: it does."""
        return True

    @property
    def label(self) -> str:
        """For the table of a lens."""
        return f"ideal lens f = {plain(self.focal_length)} mm"

    @property
    def mistake(self) -> str:
        """A focal length that is none."""
        return unless_sound(self.focal_length, "ideal_lens: the focal length")


@pytree
class QuadraticLens(Screen):
    """W = -r^2 / 2 f: in air, light parallel to the axis at the height y crosses it at sqrt(f^2 - y^2).

    focal_length: f, mm, of light near the axis.
    """

    focal_length: Number

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:  # noqa: ARG002
        """W, mm."""
        return -(x * x + y * y) / (2 * self.focal_length)

    @property
    def is_round(self) -> bool:
        """As `Screen.is_round`: it does."""
        return True

    @property
    def label(self) -> str:
        """For the table of a lens."""
        return f"quadratic lens f = {plain(self.focal_length)} mm"

    @property
    def mistake(self) -> str:
        """A focal length that is none."""
        return unless_sound(self.focal_length, "quadratic_lens: the focal length")
