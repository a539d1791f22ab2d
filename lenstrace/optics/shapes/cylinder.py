"""The cylinder about the z axis, closed by a disk at either end."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.shape import Roots
from lenstrace.optics.shapes.spans import slab, tube
from lenstrace.optics.vectors import Vector, dot


@pytree
class Cylinder:
    """F = max((x^2 + y^2 - R^2) / (2 R), |z| - half_length), a solid.

    radius: R > 0, mm.      half_length: mm; inf for an endless one.
    """

    radius: jax.Array
    half_length: jax.Array

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """Where the later of tube and slab is entered and the first is left, if in this order; see `Shape.roots`.

        The cylinder is convex: a ray that starts on it and goes outward meets nothing, one that goes inward meets only
        the place where it leaves. From the surface of the tube that is twice as far as the middle of its way through.
        """
        (x, y, z), (l, m, n) = point, direction
        z_near, z_far = slab(self.half_length, z, n)
        middle, half, inside = tube(self.radius * self.radius, x, y, l, m)
        on_side = on & (self._over_side(point) >= self._over_end(point))
        near = jnp.maximum(middle - half, z_near)
        far = jnp.minimum(jnp.where(on_side, 2 * middle, middle + half), z_far)
        inward = dot(self.normal(point), direction) < 0
        met = inside & (near <= far)
        enters, leaves = met & ~on, jnp.where(on, inward, met)
        return (jnp.where(enters, near, 0), enters), (jnp.where(leaves, far, 0), leaves)

    def value(self, point: Vector) -> jax.Array:
        """F, mm."""
        over_side, over_end = self._over_side(point), self._over_end(point)
        return jnp.where(over_side >= over_end, over_side, over_end)

    def normal(self, point: Vector) -> Vector:
        """(x / R, y / R, 0) at the side, (0, 0, +-1) at the ends, of the one that is nearer."""
        x, y, z = point
        side = self._over_side(point) >= self._over_end(point)
        inverse = jnp.where(side, 1 / self.radius, 0)
        return x * inverse, y * inverse, jnp.where(side, 0, jnp.copysign(jnp.ones_like(z), z))

    def bounds(self) -> tuple[Vector, Vector]:
        """The box about the cylinder."""
        r, h = self.radius, self.half_length
        return (-r, -r, -h), (r, r, h)

    def _over_side(self, point: Vector) -> jax.Array:
        x, y, _ = point
        return (x * x + y * y - self.radius * self.radius) * (0.5 / self.radius)

    def _over_end(self, point: Vector) -> jax.Array:
        return jnp.abs(point[2]) - self.half_length
