"""Where along a line something ceases to hold, to the last bit: a limit of total reflection, an extremum, a zero."""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp

# Each halves the range that is left: none of a range of two in 64-bit numbers.
HALVINGS = 64


def edge(holds: Callable[[jax.Array], jax.Array], low: jax.Array, high: jax.Array) -> jax.Array:
    """The largest of the numbers between `low`, where it holds, and `high`, where it does not; of each of an array.

    No derivative, and no start near the answer, is needed: an extremum is where its derivative ceases to be negative.
    """

    def halve(_: int, ends: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        low, high = ends
        middle = low + (high - low) / 2
        below = holds(middle)
        return jnp.where(below, middle, low), jnp.where(below, high, middle)

    return jax.lax.fori_loop(0, HALVINGS, halve, (low, high))[0]
