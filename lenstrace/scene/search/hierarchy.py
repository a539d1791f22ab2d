"""A tree of boxes for rays to walk: eight children to a node, so that one instruction of a processor asks them all."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree, static
from lenstrace.scene.search.splitting import Binary, split

WIDE = 8  # children of a node, and primitives of a leaf at most


@pytree
class Hierarchy:
    """A tree over primitives that stand in the order of its leaves; node 0 is the root.

    boxes:  (N, 6, WIDE), low x, y, z and high x, y, z of the children of each node; a missing one is never met.
    child:  (N, WIDE), number of a node, or for a leaf -1 - (WIDE first + count - 1): its primitives are `count` from
            number `first` on.
    depth:  nodes on the longest way down.
    """

    boxes: jax.Array
    child: jax.Array
    depth: int = static()


def hierarchy(low: np.ndarray, high: np.ndarray, dtype: np.dtype) -> tuple[Hierarchy, np.ndarray]:
    """The tree over boxes with corners (K, 3), K more than WIDE, and the order (K,) that what is in them must have."""
    tree = split(low, high, WIDE)
    node, nodes, levels = np.array([0]), 1, []
    while len(node):
        children = _opened(tree, node)
        there = children >= 0
        inner = there & (tree.left[children] >= 0)
        number = -1 - (WIDE * tree.first[children] + tree.count[children] - 1)
        number[inner] = nodes + np.arange(inner.sum())
        below, above = (np.moveaxis(each[children], -1, 1) for each in (tree.low, tree.high))
        below, above = np.where(there[:, None], below, np.inf), np.where(there[:, None], above, -np.inf)
        levels.append((np.concatenate([below, above], 1), number))
        nodes += int(inner.sum())
        node = children[inner]
    boxes, child = (np.concatenate(parts) for parts in zip(*levels, strict=True))
    return Hierarchy(_outward(boxes, dtype), jnp.asarray(child, jnp.int32), len(levels)), tree.order


def _opened(tree: Binary, node: np.ndarray) -> np.ndarray:
    """WIDE descendants of each node, -1 for none: again and again the largest of them gives way to its two children."""
    children = np.full((len(node), WIDE), -1)
    children[:, 0], children[:, 1] = tree.left[node], tree.left[node] + 1
    x, y, z = (tree.high - tree.low).T
    size = np.where(tree.left >= 0, x * y + y * z + z * x, -1)
    row = np.arange(len(node))
    for slot in range(2, WIDE):
        sizes = np.where(children >= 0, size[children], -1)
        largest = sizes.argmax(1)
        rows = row[sizes[row, largest] >= 0]
        left = tree.left[children[rows, largest[rows]]]
        children[rows, largest[rows]], children[rows, slot] = left, left + 1
    return children


def _outward(boxes: np.ndarray, dtype: np.dtype) -> jax.Array:
    """Rounded so that no box is smaller than it was."""
    rounded = boxes.astype(dtype)
    inward = np.concatenate([rounded[:, :3] > boxes[:, :3], rounded[:, 3:] < boxes[:, 3:]], 1)
    away = np.array([-np.inf] * 3 + [np.inf] * 3, dtype)[:, None]
    return jnp.asarray(np.where(inward, np.nextafter(rounded, away), rounded))
