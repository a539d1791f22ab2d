"""Apertures: where a surface lets light through. All in the surface's own frame."""

from __future__ import annotations

import enum

import jax
import jax.numpy as jnp


class ApertureKind(enum.Enum):
    """The forms of an aperture, the value is the key in a file; each takes up to two numbers in mm."""

    NONE = "none"
    CIRCLE = "circle"  # passes r <= numbers[0]
    ANNULUS = "annulus"  # passes numbers[0] <= r <= numbers[1]
    RECTANGLE = "rectangle"  # passes |x| <= numbers[0] and |y| <= numbers[1]
    OBSCURATION = "obscuration"  # passes r >= numbers[0]


def passes(kind: ApertureKind, numbers: jax.Array, x: jax.Array, y: jax.Array) -> jax.Array:
    """True where a point goes through. numbers: (2,), mm; x, y: mm, one shape.

    The rim itself belongs to the opening.
    """
    first, second = numbers[0], numbers[1]
    match kind:
        case ApertureKind.CIRCLE:
            return x * x + y * y <= first * first
        case ApertureKind.ANNULUS:
            r2 = x * x + y * y
            return (r2 >= first * first) & (r2 <= second * second)
        case ApertureKind.RECTANGLE:
            return (jnp.abs(x) <= first) & (jnp.abs(y) <= second)
        case ApertureKind.OBSCURATION:
            return x * x + y * y >= first * first
        case ApertureKind.NONE:
            return jnp.ones(x.shape, bool)
