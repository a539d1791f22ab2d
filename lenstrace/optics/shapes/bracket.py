"""The root of a function between two places where it has opposite signs, for every ray by itself."""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import lax

# Times the number of bits: more steps than the method has been seen to take; bisection alone takes one a bit.
STEPS_PER_BIT = 3


def bracketed_root(
    function: Callable[[jax.Array], jax.Array], low: jax.Array, high: jax.Array, width: jax.Array
) -> tuple[jax.Array, jax.Array]:
    """A root of `function` between `low` and `high`, and whether the function changes sign between them.

    function:  of an array to an array of that shape, every number by itself; continuous.
    width:     a root is known well enough between places this far apart, > 0.

    Inverse quadratic interpolation where the last three places promise that it gains, else bisection: about ten
    evaluations for the last bit of a simple root, and never many more than bisection takes. 0 where no sign changes.
    Source: Chandrupatla, Advances in Engineering Software 28, 145 (1997).
    """
    at_low, at_high = function(low), function(high)
    real = (at_low < 0) != (at_high < 0)
    most = STEPS_PER_BIT * jnp.finfo(low.dtype).bits

    def unfinished(state: tuple[jax.Array, ...]) -> jax.Array:
        x1, x2, f1, f2, _, count = state
        return jnp.any(_open(x1, x2, f1, f2, width)) & (count < most)

    def advance(state: tuple[jax.Array, ...]) -> tuple[jax.Array, ...]:
        x1, x2, f1, f2, part, count = state
        going = _open(x1, x2, f1, f2, width)
        x = x1 + part * (x2 - x1)
        f = function(x)
        same = (f < 0) == (f1 < 0)
        x3, f3 = jnp.where(same, x1, x2), jnp.where(same, f1, f2)
        x2, f2 = jnp.where(going & ~same, x1, x2), jnp.where(going & ~same, f1, f2)
        x1, f1 = jnp.where(going, x, x1), jnp.where(going, f, f1)
        return x1, x2, f1, f2, _next_part(x1, x2, x3, f1, f2, f3, width), count + 1

    low, high = jnp.where(real, low, 0), jnp.where(real, high, 0)
    half = jnp.full_like(low, 0.5)
    x1, x2, f1, f2, *_ = lax.while_loop(unfinished, advance, (low, high, at_low, at_high, half, jnp.zeros((), int)))
    return jnp.where(jnp.abs(f1) <= jnp.abs(f2), x1, x2), real


def _open(x1: jax.Array, x2: jax.Array, f1: jax.Array, f2: jax.Array, width: jax.Array) -> jax.Array:
    return (jnp.abs(x2 - x1) > width) & (f1 != 0) & (f2 != 0)


def _next_part(
    x1: jax.Array, x2: jax.Array, x3: jax.Array, f1: jax.Array, f2: jax.Array, f3: jax.Array, width: jax.Array
) -> jax.Array:
    """How much of the way from x1 to x2 the next place lies; x1 is the last one, x3 the one that was left."""
    xi, phi = _ratio(x1 - x2, x3 - x2), _ratio(f1 - f2, f3 - f2)
    gains = (phi * phi < xi) & ((1 - phi) * (1 - phi) < 1 - xi) & (f3 != f1) & (f3 != f2)
    part = _ratio(f1, f2 - f1) * _ratio(f3, f2 - f3) + _ratio(x3 - x1, x2 - x1) * _ratio(f1, f3 - f1) * _ratio(
        f2, f3 - f2
    )
    least = jnp.minimum(_ratio(width / 2, jnp.abs(x2 - x1)), 0.5)
    return jnp.clip(jnp.where(gains, part, 0.5), least, 1 - least)


def _ratio(a: jax.Array, b: jax.Array) -> jax.Array:
    return a / jnp.where(b != 0, b, 1)
