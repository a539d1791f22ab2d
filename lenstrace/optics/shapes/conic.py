"""The surface of revolution of a conic section; a sphere is conic 0, a plane is curvature 0."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.optics.rays import RayStatus
from lenstrace.optics.shapes.crossing import Crossing
from lenstrace.optics.vectors import Vector, divide_where, root_or_zero, safe_sqrt
from lenstrace.pytree import pytree

MISSED = int(RayStatus.MISSED)


@pytree
class Conic:
    """F = c (x^2 + y^2 + (1 + k) z^2) - 2 z = 0.

    curvature: c = 1 / R, 1/mm, positive when the centre is at larger z.      conic: k, dimensionless.
    """

    curvature: jax.Array
    conic: jax.Array

    def sag(self, x: jax.Array, y: jax.Array) -> jax.Array:
        """Height above the vertex plane, mm.

            z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)),   r^2 = x^2 + y^2

        x, y: mm, one shape. Beyond the rim of the conic the result is nan.
        Source: Spencer & Murty, JOSA 52, 672 (1962), Eq. (2).
        """
        r2 = x * x + y * y
        inside = 1 - (1 + self.conic) * self.curvature**2 * r2
        value = self.curvature * r2 / (1 + safe_sqrt(inside))
        return jnp.where(inside >= 0, jnp.where(inside > 0, value, self.curvature * r2), jnp.nan)

    def normal(self, x: jax.Array, y: jax.Array, z: jax.Array) -> Vector:
        """-grad F / 2 = (-c x, -c y, 1 - (1 + k) c z), not normalized; x, y, z in mm on the surface."""
        return -self.curvature * x, -self.curvature * y, 1 - (1 + self.conic) * self.curvature * z

    def crossing(self, point: Vector, direction: Vector, side: jax.Array) -> Crossing:
        """The crossing on the sheet through the vertex, where the normal and the ray agree in sign with `side`.

        point: mm, anywhere on the ray, best near the vertex plane.      direction: unit vector.
        side: +1 for light that crosses the surface toward +z, -1 toward -z.

        With the ray r + t d the surface is A t^2 - 2 G t + F = 0 where

            A = c (1 + k n^2),  G = n - c (x l + y m + (1 + k) z n),  F = c (x^2 + y^2 + (1 + k) z^2) - 2 z,

        and t = F / (G + s E), E = sqrt(G^2 - A F), the form that is exact at c = 0 and at A = 0; s E is the
        product of normal and direction at the crossing. Where G and s differ in sign (light nearly along the vertex
        plane, or against its sense) the same root is (G - s E) / A, without the cancellation.
        """
        (x, y, z), (l, m, n) = point, direction
        c, one_k = self.curvature, 1 + self.conic
        f = c * (x * x + y * y + one_k * z * z) - 2 * z
        g = n - c * (x * l + y * m + one_k * z * n)
        a = c * (1 + self.conic * n * n)
        against = side * g < 0
        # a plane, or a parabola along its axis, met from behind has no such root
        cosine = root_or_zero(jnp.where(against & (a == 0), 0, g * g - a * f))
        numerator, divisor = jnp.where(against, g - side * cosine, f), jnp.where(against, a, g + side * cosine)
        t = divide_where(cosine > 0, numerator, divisor)
        x, y, z = x + t * l, y + t * m, z + t * n
        normal = self.normal(x, y, z)
        # |N|^2 on the surface, where c (x^2 + y^2 + (1 + k) z^2) = 2 z
        normal_squared = 1 - self.conic * c * z * (2 - one_k * c * z)
        hit = (cosine > 0) & (normal[2] > 0)
        return Crossing(t, (x, y, z), normal, normal_squared, cosine, jnp.where(hit, 0, MISSED))
