"""The surface of revolution of a conic section; a sphere is conic 0, a plane is curvature 0."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.rays import RayStatus
from lenstrace.optics.shapes.crossing import Crossing, approach
from lenstrace.optics.vectors import Vector, divide_finite_where, divide_where, dot, root_or_zero, safe_sqrt

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

        point: mm, anywhere on the ray.      direction: unit vector.
        side: +1 for light that crosses the surface toward +z, -1 toward -z.

        With the ray r + t d from a place near the vertex the surface is A t^2 - 2 G t + F = 0 where

            A = c (1 + k n^2),  G = n - c (x l + y m + (1 + k) z n),  F = c (x^2 + y^2 + (1 + k) z^2) - 2 z,

        and t = F / (G + s E), E = sqrt(G^2 - A F), the form that is exact at c = 0 and at A = 0; s E is the
        product of normal and direction at the crossing. Where G and s differ in sign (light nearly along the vertex
        plane, or against its sense) the same root is (G - s E) / A, without the cancellation.
        """
        c, one_k = self.curvature, 1 + self.conic
        t, (x, y, z), cosine = _meet(self, point, direction, side)
        normal = self.normal(x, y, z)
        hit = (cosine > 0) & (normal[2] > 0)
        # |N|^2 on the surface, where c (x^2 + y^2 + (1 + k) z^2) = 2 z
        normal_squared = 1 - self.conic * c * z * (2 - one_k * c * z)
        return Crossing(t, (x, y, z), normal, normal_squared, cosine, hit, MISSED)


@jax.custom_jvp
def _meet(shape: Conic, point: Vector, direction: Vector, side: jax.Array) -> tuple[jax.Array, Vector, jax.Array]:
    """Distance t to the crossing, the crossing, and E = |N . d| there; E = 0 where there is none."""
    before, (x, y, z) = approach(point, direction)
    l, m, n = direction
    c, one_k = shape.curvature, 1 + shape.conic
    f = c * (x * x + y * y + one_k * z * z) - 2 * z
    g = n - c * (x * l + y * m + one_k * z * n)
    a = c * (1 + shape.conic * n * n)
    against = side * g < 0
    # a plane, or a parabola along its axis, met from behind has no such root
    cosine = root_or_zero(jnp.where(against & (a == 0), 0, g * g - a * f))
    numerator, divisor = jnp.where(against, g - side * cosine, f), jnp.where(against, a, g + side * cosine)
    t = divide_where(cosine > 0, numerator, divisor)
    return before + t, (x + t * l, y + t * m, z + t * n), cosine


@_meet.defjvp
def _(primals: Any, tangents: Any) -> Any:
    """Of the implicit function: the point r + t d stays on F = 0,

    N . (dr + t dd + d dt) = ((x^2 + y^2 + (1 + k) z^2) dc + c z^2 dk) / 2.
    """
    shape, _, direction, side = primals
    moved, point_moved, turned, _ = tangents
    t, there, cosine = _meet(*primals)
    x, y, z = there
    # numbers of the surface as one for each ray: what they receive in reverse is then summed over the rays once
    c, one_k, dc, dk = (a + jnp.zeros_like(x) for a in (shape.curvature, 1 + shape.conic, moved.curvature, moved.conic))
    normal = (-c * x, -c * y, 1 - one_k * c * z)
    moves = tuple(dp + t * dd for dp, dd in zip(point_moved, turned, strict=True))
    rise = ((x * x + y * y + one_k * z * z) * dc + c * z * z * dk) / 2
    dt = divide_finite_where(cosine > 0, side * (rise - dot(normal, moves)), cosine)
    dx, dy, dz = (move + d * dt for move, d in zip(moves, direction, strict=True))
    turns = -(dc * x + c * dx), -(dc * y + c * dy), -(dc * one_k * z + dk * c * z + c * one_k * dz)
    change = side * (dot(turns, direction) + dot(normal, turned))
    return (t, there, cosine), (dt, (dx, dy, dz), change)
