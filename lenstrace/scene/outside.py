"""Whether the eye stands where it can see: outside of all that is solid."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np

from lenstrace.errors import SceneError
from lenstrace.optics.shapes.box import Box
from lenstrace.optics.shapes.cylinder import Cylinder
from lenstrace.optics.shapes.implicit import Implicit
from lenstrace.optics.shapes.sphere import Sphere
from lenstrace.optics.shapes.torus import Torus
from lenstrace.scene.frame import frame_at
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.objects import Scene

SOLIDS = (Sphere, Box, Cylinder, Torus, Implicit)


def check_outside(position: Any, scene: Scene) -> None:
    """SceneError where a place lies inside a solid object."""
    here = tuple(jnp.asarray(float(each)) for each in position)
    for number, item in enumerate(scene.objects, 1):
        frame = frame_at(item.position, item.rotation, None)
        local, _ = frame.local(here, here, None)  # type: ignore[arg-type]
        if _holds(item.shape, local):
            name = f" ({item.name})" if item.name else ""
            raise SceneError(
                f"camera: stands inside object {number}{name}, a {type(item.shape).__name__}; move it out, or make "
                "a room of rectangles"
            )


def _holds(shape: Any, point: Any) -> bool:
    """Whether a point in the axes of a shape lies inside the solid that it is."""
    if isinstance(shape, Mesh):
        return shape.is_watertight and shape.winding(np.array(point, float)) > 0.5
    if isinstance(shape, Implicit) and max(abs(float(each)) for each in point) > float(shape.reach):
        return False
    return isinstance(shape, SOLIDS) and float(shape.value(point)) < 0
