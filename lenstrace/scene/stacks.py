"""Things of several kinds, those of one kind stacked: a loop, or a gather, for each kind and not for each thing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree


@pytree
class Stack:
    """Things 0 to N - 1. Two of them are of one kind where they are pytrees of one structure.

    kinds:  for each kind its numbers, stacked: (K, ...).
    kind:   (N,), the kind of each thing.       place: (N,), its place in the stack of its kind.
    """

    kinds: tuple[Any, ...]
    kind: jax.Array
    place: jax.Array

    def chosen(self, number: jax.Array, function: Callable[[Any], Any]) -> Any:
        """function(numbers of thing `number`), for an array of numbers; every kind is computed, one is taken.

        number: (R,), clipped to what there is. The function sees leaves (R, ...) and returns a pytree of arrays (R,).
        """
        number = jnp.clip(number, 0, self.kind.shape[0] - 1)
        place = self.place[number]
        results = [function(gathered(kind, place)) for kind in self.kinds]
        total = results[0]
        for i, result in enumerate(results[1:], 1):
            here = self.kind[number] == i
            total = jax.tree.map(lambda a, b, here=here: jnp.where(here, b, a), total, result)
        return total


def gathered(stacked: Any, place: jax.Array) -> Any:
    """The numbers at each place of stacked ones; clipped to the stack."""
    return jax.tree.map(lambda a: a[jnp.clip(place, 0, a.shape[0] - 1)], stacked)


def stack(things: Sequence[Any], dtype: Any) -> Stack:
    """Stack things; real numbers become `dtype`."""
    orders: dict[Any, list[int]] = {}
    for number, thing in enumerate(things):
        leaves, structure = jax.tree.flatten(thing)
        orders.setdefault((structure, *(np.shape(leaf) for leaf in leaves)), []).append(number)
    kind, place = np.zeros((2, len(things)), np.int32)
    for i, numbers in enumerate(orders.values()):
        kind[numbers], place[numbers] = i, np.arange(len(numbers))
    kinds = tuple(stacked([things[number] for number in numbers], dtype) for numbers in orders.values())
    return Stack(kinds, jnp.asarray(kind), jnp.asarray(place))


def stacked(things: Sequence[Any], dtype: Any) -> Any:
    """Things of one structure as one, with leaves (K, ...); real numbers become `dtype`."""

    def together(*leaves: Any) -> jax.Array:
        array = np.stack([np.asarray(leaf) for leaf in leaves])
        return jnp.asarray(array, dtype if np.issubdtype(array.dtype, np.floating) else array.dtype)

    return jax.tree.map(together, *things)
