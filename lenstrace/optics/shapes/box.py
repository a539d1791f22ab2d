"""The box about the origin, its faces across the axes."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.shape import Roots
from lenstrace.optics.shapes.spans import slab
from lenstrace.optics.vectors import Vector, dot


@pytree
class Box:
    """F = max(|x| - half_x, |y| - half_y, |z| - half_z), a solid; mm."""

    half_x: jax.Array
    half_y: jax.Array
    half_z: jax.Array

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """Where the last slab is entered and the first is left, if in this order; see `Shape.roots`.

        The box is convex: a ray that starts on a face and goes outward meets nothing, one that goes inward meets only
        the place where it leaves.
        """
        (x_near, x_far), (y_near, y_far), (z_near, z_far) = (
            slab(half, p, d) for half, p, d in zip(self._halves, point, direction, strict=True)
        )
        near = jnp.maximum(jnp.maximum(x_near, y_near), z_near)
        far = jnp.minimum(jnp.minimum(x_far, y_far), z_far)
        inward = dot(self.normal(point), direction) < 0
        enters = (near <= far) & ~on
        leaves = jnp.where(on, inward, near <= far)
        return (jnp.where(enters, near, 0), enters), (jnp.where(leaves, far, 0), leaves)

    def value(self, point: Vector) -> jax.Array:
        """F, mm."""
        (across_x, across_y, across_z), on_x, on_y = self._nearest(point)
        return jnp.where(on_x, across_x, jnp.where(on_y, across_y, across_z))

    def normal(self, point: Vector) -> Vector:
        """The axis, with its sign, across the face that is nearest."""
        _, on_x, on_y = self._nearest(point)
        x, y, z = (jnp.copysign(jnp.ones_like(p), p) for p in point)
        return jnp.where(on_x, x, 0), jnp.where(on_y, y, 0), jnp.where(on_x | on_y, 0, z)

    def bounds(self) -> tuple[Vector, Vector]:
        """The box."""
        return (-self.half_x, -self.half_y, -self.half_z), self._halves

    @property
    def _halves(self) -> Vector:
        return self.half_x, self.half_y, self.half_z

    def _nearest(self, point: Vector) -> tuple[Vector, jax.Array, jax.Array]:
        """Heights over the three pairs of faces, and whether the first or the second of them is the greatest."""
        x, y, z = (jnp.abs(p) - half for p, half in zip(point, self._halves, strict=True))
        on_x = (x >= y) & (x >= z)
        return (x, y, z), on_x, ~on_x & (y >= z)
