"""A tree of numbers as one array: a call with it costs as much as a call with one number."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import numpy as np


class Packing(NamedTuple):
    """How a tree is packed; hashable, equal for trees of one structure."""

    structure: Any
    shapes: tuple[tuple[int, ...], ...]

    def unpacked(self, packed: Any) -> Any:
        """The tree, out of the array (N,), which JAX may trace."""
        leaves, start = [], 0
        for shape in self.shapes:
            size = int(np.prod(shape))
            leaves.append(packed[start : start + size].reshape(shape))
            start += size
        return jax.tree.unflatten(self.structure, leaves)


def packed(tree: Any) -> tuple[np.ndarray, Packing]:
    """All numbers of a tree as float64, (N,), and how they are packed."""
    leaves, structure = jax.tree.flatten(tree)
    arrays = [np.asarray(leaf, float) for leaf in leaves]
    flat = np.concatenate([a.ravel() for a in arrays]) if arrays else np.zeros(0)
    return flat, Packing(structure, tuple(a.shape for a in arrays))
