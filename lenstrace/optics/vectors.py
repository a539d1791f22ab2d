"""Vectors as three separate arrays, and the few guarded functions that keep derivatives finite.

Separate components let XLA fuse a whole surface into one loop; an (N, 3) array costs seven times as much.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp

Vector = tuple[jax.Array, jax.Array, jax.Array]


def dot(a: Vector, b: Vector) -> jax.Array:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def normalize(a: Vector) -> Vector:
    """The unit vector along `a`; `a` must not be zero. As in `divide_where`, quotients are taken last."""
    length = jnp.sqrt(dot(a, a))
    return a[0] / length, a[1] / length, a[2] / length


def safe_sqrt(x: jax.Array, substitute: float = 1.0) -> jax.Array:
    """sqrt(x) where x > 0, else sqrt(substitute): value and derivative are finite on both sides."""
    return jnp.sqrt(jnp.where(x > 0, x, substitute))


@jax.custom_jvp
def root_or_zero(x: jax.Array) -> jax.Array:
    """sqrt(x) where x > 0, else 0, with derivative 0 there. A test for > 0 of the result costs less than one of x."""
    return jnp.sqrt(jnp.maximum(x, 0))


@root_or_zero.defjvp
def _(primals: tuple[jax.Array], tangents: tuple[jax.Array]) -> tuple[jax.Array, jax.Array]:
    root = root_or_zero(*primals)
    return root, jnp.where(root > 0, 0.5 / jnp.where(root > 0, root, 1), 0) * tangents[0]


def safe_divide(numerator: jax.Array, denominator: jax.Array) -> jax.Array:
    """numerator / denominator, and 0 where the denominator is 0; finite derivatives on both sides."""
    return divide_where(denominator != 0, numerator, denominator)


def divide_where(condition: jax.Array, numerator: jax.Array, denominator: jax.Array) -> jax.Array:
    """numerator / denominator where the condition holds, else 0; finite derivatives on both sides.

    The quotient is taken last: what uses it more than once does not compute the operands again.
    """
    return jnp.where(condition, numerator, 0) / jnp.where(condition, denominator, 1)


def divide_finite_where(condition: jax.Array, numerator: jax.Array, denominator: jax.Array) -> jax.Array:
    """As `divide_where`, for a numerator that is finite everywhere: the rule of a derivative, linear in it.

    In reverse the mask is then part of the quotient, and is not asked for again by everything that uses it.
    """
    return numerator / jnp.where(condition, denominator, jnp.inf)


def rotation(tilt: jax.Array) -> jax.Array:
    """The matrix Rx Ry Rz of three right-handed angles.

    tilt: (..., 3), radians about x, y, z. Returns (..., 3, 3): global from local.
    """
    (cx, cy, cz), (sx, sy, sz) = (jnp.moveaxis(f(tilt), -1, 0) for f in (jnp.cos, jnp.sin))
    rows = (
        (cy * cz, -cy * sz, sy),
        (cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy),
        (sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy),
    )
    return jnp.stack([jnp.stack(row, -1) for row in rows], -2)


def rotate(matrix: jax.Array, a: Vector) -> Vector:
    """matrix @ a, for one 3 x 3 matrix."""
    x, y, z = (matrix[i, 0] * a[0] + matrix[i, 1] * a[1] + matrix[i, 2] * a[2] for i in range(3))
    return x, y, z


def rotate_back(matrix: jax.Array, a: Vector) -> Vector:
    """matrix.T @ a, the inverse of `rotate`."""
    x, y, z = (matrix[0, i] * a[0] + matrix[1, i] * a[1] + matrix[2, i] * a[2] for i in range(3))
    return x, y, z
