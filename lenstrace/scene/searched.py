"""Meshes as primitives of a world, and how its primitives are searched."""

from __future__ import annotations

import numpy as np

from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.scene.lights.area import AreaLight
from lenstrace.scene.objects import Object
from lenstrace.scene.search.kind import Search, Way, search
from lenstrace.scene.stacks import Many, Stack, reordered
from lenstrace.scene.world import Primitive


def mesh_primitives(item: Object, triangles: Triangle, first: int) -> tuple[Many, Many | None]:
    """The triangles of an object with numbers from `first` on, and the lights that they are, if it shines."""
    count = len(np.asarray(triangles.a[0]))
    numbers = np.arange(first, first + count, dtype=np.int32)
    primitives = Many(Primitive(triangles, None, numbers), count)
    if item.emission is None:
        return primitives, None
    radiance = tuple(np.full(count, each, float) for each in item.emission)
    return primitives, Many(AreaLight(triangles, None, radiance, numbers), count)


def searched(primitives: Stack, way: Way) -> tuple[Stack, tuple[Search, ...]]:
    """Stacked primitives in the order in which they are searched, and how each kind is."""
    searches, orders = zip(*(search(kind, way) for kind in primitives.kinds), strict=True)
    return reordered(primitives, orders), searches
