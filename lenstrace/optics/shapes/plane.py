"""The plane z = 0, without an end."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.flat import plane_crossing, plane_normal
from lenstrace.optics.shapes.shape import Roots
from lenstrace.optics.vectors import Vector


@pytree
class Plane:
    """F = z."""

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """-z / n; see `Shape.roots`. A ray that starts on the plane never meets it again."""
        (_, _, distance), real = plane_crossing(point, direction, on)
        return ((distance, real),)

    def value(self, point: Vector) -> jax.Array:
        """z."""
        return point[2]

    def normal(self, point: Vector) -> Vector:
        """(0, 0, 1)."""
        return plane_normal(point)

    def bounds(self) -> tuple[Vector, Vector]:
        """All of it: a box of no height, and of no end."""
        endless, zero = jnp.asarray(jnp.inf), jnp.asarray(0.0)
        return (-endless, -endless, zero), (endless, endless, zero)
