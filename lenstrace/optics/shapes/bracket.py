"""The root of a function between two places where it has opposite signs, for every ray by itself."""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jax import lax

# A place is moved from that of the secant toward the middle, by this part of the square of the bracket's length over
# its first length: the other end of the bracket then follows.
SHIFT = 0.2
# In units of the width that is asked for: two such places on either side of a root close a bracket.
LEAST_SHIFT = 0.375
# A bracket may be so many times longer than if it had halved at every step; longer ones are halved.
AHEAD = 4
MOST_STEPS_PER_BIT = 3


def bracketed_root(
    function: Callable[[jax.Array], jax.Array], low: jax.Array, high: jax.Array, width: jax.Array
) -> tuple[jax.Array, jax.Array]:
    """A root of `function` between `low` and `high`, and whether the function changes sign between them.

    function:  of an array to an array of that shape, every number by itself; continuous.
    width:     a root is known well enough between places this far apart; some times what the numbers are rounded by.

    The secant, with weights of its ends that let neither of them stay, and the middle wherever the bracket has not
    halved at every step but a few: eight to twelve evaluations for the last bit. 0 where no sign changes.
    Source: Anderson & Bjorck, BIT 13, 253 (1973); the way past the root is that of Oliveira &
    Takahashi, ACM Transactions on Mathematical Software 47 (1), 5 (2020).
    """
    at_low, at_high = function(low), function(high)
    real = (at_low < 0) != (at_high < 0)
    low, high = jnp.where(real, low, 0), jnp.where(real, high, 0)
    most = MOST_STEPS_PER_BIT * jnp.finfo(low.dtype).nmant
    shift, least = SHIFT / jnp.where(real, high - low, 1), LEAST_SHIFT * width

    def unfinished(state: tuple[jax.Array, ...]) -> jax.Array:
        a, b, *_, count = state
        return jnp.any(b - a > width) & (count < most)

    def advance(state: tuple[jax.Array, ...]) -> tuple[jax.Array, ...]:
        a, b, at_a, at_b, allowed, last, count = state
        length = b - a
        away = _secant(at_a, at_b, length) - length / 2
        nearer = jnp.maximum(shift * length * length, least)
        away = jnp.sign(away) * jnp.maximum(jnp.abs(away) - nearer, 0)
        free = length <= allowed
        x = a + (length / 2 + jnp.where(free, away, 0))
        value = function(x)
        left = (value < 0) == (at_a < 0)
        moved = jnp.where(left, 1, -1).astype(x.dtype)
        # an end that stays for the second time counts less, or it would stay while the other one creeps
        kept = 1 - _ratio(value, jnp.where(left, at_a, at_b))
        less = jnp.where(moved == last, jnp.where(kept > 0, kept, 0.5), 1)
        a, at_a = jnp.where(left, x, a), jnp.where(left, value, at_a * less)
        b, at_b = jnp.where(left, b, x), jnp.where(left, at_b * less, value)
        return a, b, at_a, at_b, jnp.where(free, allowed / 2, AHEAD * length / 2), moved, count + 1

    first = (low, high, at_low, at_high, AHEAD * (high - low), jnp.zeros_like(low), jnp.zeros((), int))
    a, b, at_a, at_b, *_ = lax.while_loop(unfinished, advance, first)
    return a + _secant(at_a, at_b, b - a), real


def _secant(at_a: jax.Array, at_b: jax.Array, length: jax.Array) -> jax.Array:
    """How far from a the secant is 0."""
    return length * _ratio(at_a, at_a - at_b)


def _ratio(a: jax.Array, b: jax.Array) -> jax.Array:
    return a / jnp.where(b != 0, b, 1)
