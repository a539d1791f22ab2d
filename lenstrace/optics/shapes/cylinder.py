"""The cylinder about the z axis, closed by a disk at either end."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.shape import Roots
from lenstrace.optics.shapes.slab import slab
from lenstrace.optics.vectors import Vector, dot, root_or_zero


@pytree
class Cylinder:
    """F = max((x^2 + y^2 - R^2) / (2 R), |z| - half_length), a solid.

    radius: R > 0, mm.      half_length: mm; inf for an endless one.
    """

    radius: jax.Array
    half_length: jax.Array

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """Where the later of tube and slab is entered and the first is left, if in this order; see `Shape.roots`.

        In the tube, with A = l^2 + m^2,

            t = (-(x l + y m) -+ sqrt(A R^2 - (x m - y l)^2)) / A,

        and from its surface the roots are 0 and -2 (x l + y m) / A. The cylinder is convex: a ray that starts on it and
        goes outward meets nothing, one that goes inward meets only the place where it leaves.
        """
        (x, y, z), (l, m, n) = point, direction
        z_near, z_far = slab(self.half_length, z, n)
        r_near, r_far, inside = self._tube(x, y, l, m, on & (self._over_side(point) >= self._over_end(point)))
        near, far = jnp.maximum(r_near, z_near), jnp.minimum(r_far, z_far)
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

    def _tube(
        self, x: jax.Array, y: jax.Array, l: jax.Array, m: jax.Array, on: jax.Array
    ) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Where the ray enters and leaves the endless tube, and whether it does; along the axis: before and beyond."""
        limits = jnp.finfo(l.dtype)
        r2 = self.radius * self.radius
        a = l * l + m * m
        along_axis = a < limits.tiny / limits.eps
        inverse = 1 / jnp.where(along_axis, 1, a)
        middle = -(x * l + y * m) * inverse
        moment = x * m - y * l
        half = root_or_zero(a * r2 - moment * moment) * inverse
        near = jnp.where(along_axis, -limits.max, middle - half)
        far = jnp.where(along_axis, limits.max, middle + jnp.where(on, middle, half))
        return near, far, jnp.where(along_axis, x * x + y * y < r2, half > 0)
