"""What a thin phase screen is: an added optical path W(x, y), in mm, positive for delay.

The tangential momentum of light that crosses it changes by grad W: see `interactions.bend`. x and y are those of the
surface that carries the screen, in its own frame. On a mirror W is what the light gains by coming and going together.
"""

from __future__ import annotations

import functools
import math
from typing import Self

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import is_traced

Number = float | jax.Array


class Screen:
    """A frozen pytree of numbers, which JAX may trace."""

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:
        """W, mm; x and y in mm, one shape; wavelength in mm, a scalar."""
        raise NotImplementedError

    def prepared(self) -> Screen:
        """The screen as it is traced: what can be computed once has been."""
        return self

    def scaled(self, unit: float) -> Self:
        """The screen whose lengths, all its numbers, were given in a unit of so many mm."""
        return jax.tree.map(lambda length: length * unit, self)

    @property
    def is_round(self) -> bool:
        """True where W is known to depend on r alone."""
        return False

    @property
    def label(self) -> str:
        """What it is, for the table of a lens."""
        raise NotImplementedError

    @property
    def mistake(self) -> str:
        """What is wrong with its numbers and what to do; "" where nothing is."""
        raise NotImplementedError


def path_and_slopes(
    screen: Screen, x: jax.Array, y: jax.Array, wavelength: jax.Array
) -> tuple[jax.Array, tuple[jax.Array, jax.Array]]:
    """W, mm, and its exact derivatives by x and y, pure numbers."""

    def path(x: jax.Array, y: jax.Array) -> jax.Array:
        return screen.path(x, y, wavelength)

    one, zero = jnp.ones_like(x), jnp.zeros_like(x)
    value, along_x = jax.jvp(path, (x, y), (one, zero))
    _, along_y = jax.jvp(path, (x, y), (zero, one))
    return value, (along_x, along_y)


# traced once for each kind of screen, however often a question asks for the powers of a lens
@functools.partial(jax.jit, inline=True)
def power_at_vertex(screen: Screen, wavelength: jax.Array) -> jax.Array:
    """-d^2 W / dy^2 at the vertex, 1/mm: the paraxial power in the y-z plane."""
    zero = jnp.zeros_like(wavelength)
    return -jax.grad(jax.grad(lambda y: screen.path(zero, y, wavelength)))(zero)


def plain(value: Number) -> str:
    """A number of a label."""
    return "traced" if is_traced(value) else f"{float(value):.8g}"


def unless_sound(value: Number, what: str, *, positive: bool = False) -> str:
    """What to say of a number that is not finite, is 0, or is negative where it must not be; else ""."""
    if is_traced(value) or (math.isfinite(value) and (value > 0 if positive else value != 0)):
        return ""
    return f"{what} must be a finite number {'above' if positive else 'other than'} 0, got {float(value):g}"
