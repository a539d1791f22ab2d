"""Things of several kinds, those of one kind stacked: a loop, or a gather, for each kind and not for each thing."""

from __future__ import annotations

import dataclasses
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

        number: (R,), clipped to what there is. The function sees leaves (..., R) and returns a pytree of arrays (R,).
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
    """The numbers at each place of stacked ones, clipped to the stack: (..., R) of (K, ...)."""
    return own_first(jax.tree.map(lambda a: a[jnp.clip(place, 0, a.shape[0] - 1)], stacked))


def own_first(stacked: Any) -> Any:
    """The axis over things put last: what has axes of its own then goes with arrays of rays like a single one."""
    return jax.tree.map(lambda a: a if a.ndim < 2 else jnp.moveaxis(a, 0, -1), stacked)


@dataclasses.dataclass(frozen=True)
class Many:
    """Things that are stacked already: `count` of them, with leaves (count, ...)."""

    things: Any
    count: int


def stack(things: Sequence[Any], dtype: Any) -> Stack:
    """Stack things, and those of each `Many` in their order; real numbers become `dtype`."""
    groups: dict[Any, list[tuple[int, int, list[np.ndarray]]]] = {}
    total = 0
    for thing in things:
        many = thing if isinstance(thing, Many) else Many(jax.tree.map(lambda a: np.asarray(a)[None], thing), 1)
        leaves, structure = jax.tree.flatten(many.things)
        arrays, count = [np.asarray(leaf) for leaf in leaves], many.count
        groups.setdefault((structure, *(array.shape[1:] for array in arrays)), []).append((total, count, arrays))
        total += count
    kind, place = np.zeros((2, total), np.int32)
    kinds = []
    for i, ((structure, *_), members) in enumerate(groups.items()):
        numbers = np.concatenate([np.arange(first, first + count) for first, count, _ in members])
        kind[numbers], place[numbers] = i, np.arange(len(numbers))
        columns = zip(*(arrays for _, _, arrays in members), strict=True)
        kinds.append(structure.unflatten([_of_precision(np.concatenate(column), dtype) for column in columns]))
    return Stack(tuple(kinds), jnp.asarray(kind), jnp.asarray(place))


def reordered(stack: Stack, orders: Sequence[np.ndarray | None]) -> Stack:
    """The same things, those of each kind in another order in its stack; None: as they are."""
    kinds, kind, place = list(stack.kinds), np.asarray(stack.kind), np.array(stack.place)
    for i, order in enumerate(orders):
        if order is not None:
            new_place = np.empty_like(order)
            new_place[order] = np.arange(len(order))
            kinds[i] = jax.tree.map(lambda a, order=order: jnp.asarray(np.asarray(a)[order]), kinds[i])
            place[kind == i] = new_place[place[kind == i]]
    return Stack(tuple(kinds), stack.kind, jnp.asarray(place))


def _of_precision(array: np.ndarray, dtype: Any) -> jax.Array:
    return jnp.asarray(array, dtype if np.issubdtype(array.dtype, np.floating) else array.dtype)
