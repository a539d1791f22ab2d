"""The axes of a surface: z its normal, x and y any two across it.

Source: T. Duff et al., J. Computer Graphics Techniques 6 (1), 1 (2017), Listing 3: no branch, no square root.
"""

from __future__ import annotations

import jax.numpy as jnp

from lenstrace.optics.vectors import Vector, dot


def axes(normal: Vector) -> tuple[Vector, Vector]:
    """x and y of a frame whose z is a unit vector; right-handed, orthonormal to rounding for every direction."""
    x, y, z = normal
    sign = jnp.where(z >= 0, 1, -1).astype(z.dtype)
    a = -1 / (sign + z)
    b = x * y * a
    return (1 + sign * x * x * a, sign * b, -sign * x), (b, sign + y * y * a, -y)


def to_local(normal: Vector, direction: Vector) -> Vector:
    """A direction of the scene in the axes of the surface."""
    x, y = axes(normal)
    return dot(x, direction), dot(y, direction), dot(normal, direction)


def to_global(normal: Vector, direction: Vector) -> Vector:
    """A direction in the axes of the surface, in the scene."""
    x, y = axes(normal)
    a, b, c = (direction[0] * x[i] + direction[1] * y[i] + direction[2] * normal[i] for i in range(3))
    return a, b, c
