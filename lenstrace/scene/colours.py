"""Colours of light in a scene: linear RGB, three arrays, as vectors are."""

from __future__ import annotations

import jax

Colour = tuple[jax.Array, jax.Array, jax.Array]


def scaled(colour: Colour, factor: jax.Array) -> Colour:
    """Colour times a number."""
    r, g, b = colour
    return r * factor, g * factor, b * factor


def times(a: Colour, b: Colour) -> Colour:
    """Product, channel by channel."""
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


def plus(a: Colour, b: Colour) -> Colour:
    """Sum of lights."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def largest(colour: Colour) -> jax.Array:
    """The largest of the three."""
    r, g, b = colour
    return jax.numpy.maximum(jax.numpy.maximum(r, g), b)
