"""How the nearest primitive of a kind is found: all are asked, or a tree of boxes, or Embree."""

from __future__ import annotations

import enum
from typing import Any

import jax
import numpy as np

from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.scene.search.boxes import boxes
from lenstrace.scene.search.embree import Embree, available, embree
from lenstrace.scene.search.hierarchy import Hierarchy, hierarchy

# None: all primitives are asked.
Search = Hierarchy | Embree | None

# To this many primitives it is faster to ask them all.
FEW = 64


class Way(enum.Enum):
    """What is wanted."""

    AUTO = "auto"
    ALL = "all"
    HIERARCHY = "hierarchy"
    EMBREE = "embree"


def search(kind: Any, way: Way) -> tuple[Search, np.ndarray | None]:
    """How the primitives of a kind are searched, and the order in which they must be stacked for that, or None.

    kind: stacked `Primitive`s.    AUTO: Embree for many triangles where it can be asked, a hierarchy for many of
    anything else that has bounds.
    """
    count = kind.number.shape[0]
    if way is Way.ALL or count <= FEW:
        return None, None
    if way is not Way.HIERARCHY and isinstance(kind.shape, Triangle) and kind.frame is None and available():
        return embree(kind.shape), None
    bounds = boxes(kind.shape, kind.frame)
    if bounds is None:
        return None, None
    return hierarchy(*bounds, jax.tree.leaves(kind.shape)[0].dtype)


def has_callback(searches: tuple[Search, ...]) -> bool:
    """Whether a program with these searches calls back to Python, and so cannot run in blocks."""
    return any(isinstance(each, Embree) for each in searches)
