"""Objects as primitives of a world, meshes triangle by triangle, and how the nearest of them is found."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np

from lenstrace.errors import SceneError
from lenstrace.optics.shapes.implicit import Implicit
from lenstrace.scene.frame import Three, frame_at
from lenstrace.scene.lights.area import AreaLight
from lenstrace.scene.materials.dielectric import Dielectric
from lenstrace.scene.materials.rough_dielectric import RoughDielectric
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.objects import Object
from lenstrace.scene.search.kind import Search, Way, search
from lenstrace.scene.stacks import Many, Stack, reordered
from lenstrace.scene.surfaces import check_implicit
from lenstrace.scene.world import Primitive


def check_object(item: Object) -> None:
    """SceneError where an object that is a mesh cannot be: one of a glass must be a solid, and none moves; and where
    the bounds of an implicit surface do not hold."""
    if isinstance(item.shape, Implicit):
        check_implicit(item.shape)
    if not isinstance(item.shape, Mesh):
        return
    if isinstance(item.material, Dielectric | RoughDielectric):
        item.shape.require_solid(f"a {type(item.material).__name__}")
    if item.motion is not None:
        raise SceneError(f"motion: a mesh cannot move while the shutter is open, got {item.motion}; leave it out")


def primitives_of(item: Object, first: int, dtype: Any) -> Many:
    """The primitives of an object, with numbers from `first` on; triangles stand in the axes of the scene."""
    if not isinstance(item.shape, Mesh):
        frame = frame_at(item.position, item.rotation, item.motion)
        one = Primitive(item.shape, frame, np.int32(first))
        return Many(jax.tree.map(lambda a: np.asarray(a)[None], one), 1)
    triangles = item.shape.triangles(item.position, item.rotation, np.dtype(dtype))
    count = len(np.asarray(triangles.a[0]))
    return Many(Primitive(triangles, None, np.arange(first, first + count, dtype=np.int32)), count)


def lights_of(primitives: Many, emission: Three) -> Many:
    """The lights that primitives are."""
    some = primitives.things
    radiance = tuple(np.full(primitives.count, each, float) for each in emission)
    return Many(AreaLight(some.shape, some.frame, radiance, some.number), primitives.count)


def searched(primitives: Stack, way: Way) -> tuple[Stack, tuple[Search, ...]]:
    """Stacked primitives in the order in which they are searched, and how each kind is."""
    searches, orders = zip(*(search(kind, way) for kind in primitives.kinds), strict=True)
    return reordered(primitives, orders), searches
