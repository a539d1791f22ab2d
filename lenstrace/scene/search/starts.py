"""Where a ray begins that leaves a triangle of a mesh: surely on its own side of that triangle and of its neighbours.

The point where a ray has met a triangle is rounded. Near an edge it may lie beyond the neighbour's plane, and a ray
that leaves it would meet the neighbour from the wrong side, or go out through it. So it is brought back into the
triangle, by more than the rounding from each edge, and off it to the side that the ray goes to.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.optics.vectors import Vector, cross, dot, minus
from lenstrace.scene.rays import SceneRay

# How far, in units of epsilon times the largest coordinate of the triangle.
LIFT = 4.0
INSET = 8.0


def off_triangle(triangle: Triangle, ray: SceneRay, on: jax.Array, epsilon: float) -> SceneRay:
    """The ray, moved to its beginning off the triangle where `on` is True.

    epsilon: of the precision in which the mesh is searched.

    The point is a + p (b - a) + q (c - a), with shares 1 - p - q, p and q of the corners. A share of an edge's far
    corner is the distance to the edge over the height of the triangle there, 2 area / edge.
    """
    first, second = minus(triangle.b, triangle.a), minus(triangle.c, triangle.a)
    third = minus(second, first)
    normal = cross(first, second)
    # lengths are scaled so that the area of a small triangle does not vanish
    longest = jnp.maximum(jnp.maximum(_largest(first), _largest(second)), _largest(third))
    longest = jnp.where(longest > 0, longest, 1)
    unit = _scaled(normal, 1 / longest)
    unit = _scaled(unit, 1 / longest)
    area = dot(unit, unit)
    area = jnp.where(area > 0, area, 1)
    away = _scaled(minus(ray.point, triangle.a), 1 / longest)
    p = dot(cross(away, _scaled(second, 1 / longest)), unit) / area
    q = dot(cross(_scaled(first, 1 / longest), away), unit) / area
    rounding = epsilon * jnp.maximum(jnp.maximum(_largest(triangle.a), _largest(triangle.b)), _largest(triangle.c))
    root = jnp.sqrt(area)
    least = INSET * rounding / (longest * longest * root)
    shares = [
        jnp.maximum(share, jnp.minimum(least * jnp.sqrt(dot(edge, edge)), 0.25))
        for share, edge in ((1 - p - q, third), (p, second), (q, first))
    ]
    total = shares[0] + shares[1] + shares[2]
    p, q = shares[1] / total, shares[2] / total
    side = jnp.where(dot(unit, ray.direction) < 0, -1, 1).astype(root.dtype) * LIFT * rounding / root
    point: Any = (
        jnp.where(on, a + p * e + q * f + side * n, x)
        for a, e, f, n, x in zip(triangle.a, first, second, unit, ray.point, strict=True)
    )
    return ray.onward(tuple(point), ray.direction, ray.start)


def _scaled(a: Vector, factor: jax.Array) -> Vector:
    return a[0] * factor, a[1] * factor, a[2] * factor


def _largest(a: Vector) -> jax.Array:
    return jnp.maximum(jnp.maximum(jnp.abs(a[0]), jnp.abs(a[1])), jnp.abs(a[2]))
