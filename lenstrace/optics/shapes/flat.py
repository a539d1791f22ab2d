"""What the rectangle and the disk share: the plane z = 0."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import Vector, divide_where


def plane_crossing(point: Vector, direction: Vector, on: jax.Array) -> tuple[Vector, jax.Array]:
    """x and y on the plane and the distance t = -z / n to it; and where there is one.

    There is none for a ray along the plane, nor for one that starts on it, nor where the distance overflows.
    """
    (x, y, z), (l, m, n) = point, direction
    distance = divide_where(n != 0, -z, n)
    real = (n != 0) & ~on & (jnp.abs(distance) < jnp.inf)
    distance = jnp.where(real, distance, 0)
    return (x + distance * l, y + distance * m, distance), real


def plane_normal(point: Vector) -> Vector:
    """(0, 0, 1)."""
    zero = jnp.zeros_like(point[2])
    return zero, zero, jnp.ones_like(point[2])
