"""The disk in the plane z = 0, with or without a hole."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.flat import plane_crossing, plane_normal
from lenstrace.optics.shapes.shape import Roots
from lenstrace.optics.turns import turned
from lenstrace.optics.vectors import Vector, root_or_zero


@pytree
class Disk:
    """F = z, where hole <= r <= radius, r^2 = x^2 + y^2; mm, hole 0 for none."""

    radius: Any
    hole: Any = 0.0

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """-z / n; see `Shape.roots`. A ray that starts on the disk never meets it again."""
        (x, y, distance), real = plane_crossing(point, direction, on)
        r2 = x * x + y * y
        return ((distance, real & (r2 <= self.radius * self.radius) & (r2 >= self.hole * self.hole)),)

    def value(self, point: Vector) -> jax.Array:
        """z."""
        return point[2]

    def normal(self, point: Vector) -> Vector:
        """(0, 0, 1)."""
        return plane_normal(point)

    def bounds(self) -> tuple[Vector, Vector]:
        """The square about the disk: a box of no height."""
        r, zero = self.radius, jnp.zeros_like(self.radius)
        return (-r, -r, zero), (r, r, zero)

    def area(self) -> jax.Array:
        """pi (radius^2 - hole^2), mm^2."""
        return jnp.pi * (self.radius - self.hole) * (self.radius + self.hole)

    def place(self, u: jax.Array, v: jax.Array) -> Vector:
        """The point of two numbers in [0, 1): even numbers give points even by area.

        r^2 = hole^2 + u (radius^2 - hole^2), and the angle 2 pi v about z.
        """
        r = root_or_zero(self.hole * self.hole + u * (self.radius - self.hole) * (self.radius + self.hole))
        cos, sin = turned(v)
        return r * cos, r * sin, jnp.zeros_like(u)
