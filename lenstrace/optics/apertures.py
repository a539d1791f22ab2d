"""Apertures: where a surface lets light through. All in the surface's own frame."""

from __future__ import annotations

import enum

import jax
import jax.numpy as jnp

# Relative width of a rim, in eps: rays aimed at the edge of a stop as wide as its aperture arrive there rounded.
RIM = 64.0


class ApertureKind(enum.Enum):
    """The forms of an aperture, the value is the key in a file; each takes up to two numbers in mm."""

    NONE = "none"
    CIRCLE = "circle"  # passes r <= numbers[0]
    ANNULUS = "annulus"  # passes numbers[0] <= r <= numbers[1]
    RECTANGLE = "rectangle"  # passes |x| <= numbers[0] and |y| <= numbers[1]
    OBSCURATION = "obscuration"  # passes r >= numbers[0]


def passes(kind: ApertureKind, numbers: jax.Array, x: jax.Array, y: jax.Array) -> jax.Array:
    """True where a point goes through. numbers: (2,), mm; x, y: mm, one shape.

    The rim itself belongs to the opening, also where the place of a ray on it is rounded.
    """
    more, less = 1 + RIM * jnp.finfo(x.dtype).eps, 1 - RIM * jnp.finfo(x.dtype).eps
    first, second = numbers[0], numbers[1]
    r2 = x * x + y * y
    match kind:
        case ApertureKind.CIRCLE:
            return r2 <= first * first * more
        case ApertureKind.ANNULUS:
            return (r2 >= first * first * less) & (r2 <= second * second * more)
        case ApertureKind.RECTANGLE:
            return (jnp.abs(x) <= first * more) & (jnp.abs(y) <= second * more)
        case ApertureKind.OBSCURATION:
            return r2 >= first * first * less
        case ApertureKind.NONE:
            return jnp.ones(x.shape, bool)
