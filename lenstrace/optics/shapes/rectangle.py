"""The rectangle in the plane z = 0; with infinite sides, the plane."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.flat import plane_crossing, plane_normal
from lenstrace.optics.shapes.shape import Roots
from lenstrace.optics.vectors import Vector


@pytree
class Rectangle:
    """F = z, where |x| <= half_x and |y| <= half_y; mm, inf for no limit."""

    half_x: jax.Array
    half_y: jax.Array

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """-z / n; see `Shape.roots`. A ray that starts on the rectangle never meets it again."""
        (x, y, distance), real = plane_crossing(point, direction, on)
        return ((distance, real & (jnp.abs(x) <= self.half_x) & (jnp.abs(y) <= self.half_y)),)

    def value(self, point: Vector) -> jax.Array:
        """z."""
        return point[2]

    def normal(self, point: Vector) -> Vector:
        """(0, 0, 1)."""
        return plane_normal(point)

    def bounds(self) -> tuple[Vector, Vector]:
        """The rectangle: a box of no height."""
        zero = jnp.zeros_like(self.half_x)
        return (-self.half_x, -self.half_y, zero), (self.half_x, self.half_y, zero)

    def area(self) -> jax.Array:
        """4 half_x half_y, mm^2."""
        return 4 * self.half_x * self.half_y

    def place(self, u: jax.Array, v: jax.Array) -> Vector:
        """The point of two numbers in [0, 1): even numbers give points even by area. Sides must be finite."""
        return (2 * u - 1) * self.half_x, (2 * v - 1) * self.half_y, jnp.zeros_like(u)
