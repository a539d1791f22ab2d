"""A binary tree of boxes over many boxes, split where a ray will have least to do; numpy, one level of it at a time."""

from __future__ import annotations

import dataclasses

import numpy as np

# Slices of a node's centres along each axis; between two of them it may be split.
SLICES = 16


@dataclasses.dataclass(frozen=True)
class Binary:
    """A tree: node 0 is its root, a child comes after its parent.

    low, high:     corners of the box around each node, (N, 3).
    left:          number of the left child, the right one is the next; -1 for a leaf, (N,).
    first, count:  what a node holds: `count` numbers from `first` on in `order`, (N,) each.
    order:         numbers of the boxes in the order of the leaves, (K,).
    """

    low: np.ndarray
    high: np.ndarray
    left: np.ndarray
    first: np.ndarray
    count: np.ndarray
    order: np.ndarray


def split(low: np.ndarray, high: np.ndarray, leaf: int) -> Binary:
    """A tree over boxes whose leaves hold `leaf` of them at most. low, high: corners, (K, 3), K at least 1.

    A node is split between two of `SLICES` slices of the centres of its boxes, across the axis and at the place where

        area(left) count(left) + area(right) count(right)

    is least: what rays in all directions are expected to ask. Where all centres coincide it is halved.
    Source: I. Wald, IEEE Symposium on Interactive Ray Tracing 2007, 33 (binned surface area heuristic).
    """
    order = np.arange(len(low))
    centre = low + high
    first, count = np.array([0]), np.array([len(low)])
    levels: list[tuple[np.ndarray, ...]] = []
    nodes = 1
    while len(first):
        large = count > leaf
        left = np.where(large, nodes + 2 * (np.cumsum(large) - 1), -1)
        levels.append((*_around(low, high, order, first, count), left, first, count))
        nodes += 2 * int(large.sum())
        first, count = first[large], count[large]
        if len(first):
            first, count = _halves(low, high, centre, order, first, count)
    low, high, left, first, count = (np.concatenate(parts) for parts in zip(*levels, strict=True))
    return Binary(low, high, left, first, count, order)


def _around(
    low: np.ndarray, high: np.ndarray, order: np.ndarray, first: np.ndarray, count: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The box around what each node holds."""
    begin = np.cumsum(count) - count
    held = order[np.repeat(first - begin, count) + np.arange(count.sum())]
    return np.minimum.reduceat(low[held], begin), np.maximum.reduceat(high[held], begin)


def _halves(
    low: np.ndarray, high: np.ndarray, centre: np.ndarray, order: np.ndarray, first: np.ndarray, count: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Reorder what each node of a level holds, left before right; returns first and count of the halves in turn."""
    node = np.repeat(np.arange(len(first)), count)
    begin = np.cumsum(count) - count
    rank = np.arange(len(node)) - begin[node]
    where = first[node] + rank
    held = order[where]
    slices = _slices(centre[held], node, begin)
    axis, at = _best(low[held], high[held], slices, node, len(first))
    goes_left = np.where(at[node] > 0, slices[np.arange(len(node)), axis[node]] < at[node], rank < count[node] // 2)
    before = np.cumsum(goes_left) - goes_left
    before -= before[begin][node]
    lefts = np.add.reduceat(goes_left.astype(int), begin)
    order[np.where(goes_left, first[node] + before, first[node] + lefts[node] + rank - before)] = held
    return np.stack([first, first + lefts], -1).ravel(), np.stack([lefts, count - lefts], -1).ravel()


def _slices(centre: np.ndarray, node: np.ndarray, begin: np.ndarray) -> np.ndarray:
    """Number of the slice of each centre along each axis of its node, (n, 3)."""
    least, most = np.minimum.reduceat(centre, begin), np.maximum.reduceat(centre, begin)
    extent = most - least
    scale = np.divide(SLICES, extent, out=np.zeros_like(extent), where=extent > 0)
    return np.minimum((centre - least[node]) * scale[node], SLICES - 1).astype(np.int32)


def _best(
    low: np.ndarray, high: np.ndarray, slices: np.ndarray, node: np.ndarray, nodes: int
) -> tuple[np.ndarray, np.ndarray]:
    """For each node the axis to split across and the slice that the right half begins with, 0 where there is none."""
    costs = []
    for axis in range(3):
        key = node * SLICES + slices[:, axis]
        counts = np.bincount(key, minlength=nodes * SLICES).reshape(nodes, SLICES)
        below, above = np.full((2, 3, nodes * SLICES), np.inf)
        for i in range(3):
            np.minimum.at(below[i], key, low[:, i])
            np.minimum.at(above[i], key, -high[:, i])
        corners = np.concatenate([below, above]).reshape(6, nodes, SLICES)
        left = np.minimum.accumulate(corners, -1)[..., :-1]
        right = np.minimum.accumulate(corners[..., ::-1], -1)[..., ::-1][..., 1:]
        lefts = np.cumsum(counts, -1)[:, :-1]
        rights = counts.sum(-1, keepdims=True) - lefts
        with np.errstate(invalid="ignore", over="ignore"):
            cost = _area(left) * lefts + _area(right) * rights
        costs.append(np.where((lefts > 0) & (rights > 0), cost, np.inf))
    cost = np.concatenate(costs, -1)
    best = np.argmin(cost, -1)
    axis, at = np.divmod(best, SLICES - 1)
    return axis, np.where(np.isfinite(np.min(cost, -1)), at + 1, 0)


def _area(corners: np.ndarray) -> np.ndarray:
    """Half of the surface of boxes given by low corners and minus high ones, (6, ...)."""
    x, y, z = -corners[3:] - corners[:3]
    return x * y + y * z + z * x
