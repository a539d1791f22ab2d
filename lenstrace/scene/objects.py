"""What a person puts into a scene: shapes of a material where they stand, lights, and what is all around."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

Three = tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Object:
    """A shape of a material.

    position: of the shape's origin, lengths of the scene.      rotation: degrees about x, y, z; Rx Ry Rz.
    emission: linear RGB radiance that it sends out on the side of its normal, or None.
    motion:   how far it goes while the shutter is open.        name: for messages.
    """

    shape: Any
    material: Any
    position: Three = (0.0, 0.0, 0.0)
    rotation: Three = (0.0, 0.0, 0.0)
    emission: Three | None = None
    motion: Three | None = None
    name: str = ""


@dataclasses.dataclass(frozen=True)
class Scene:
    """Objects, lights without a shape, and the radiance from all around: one colour, or a map (H, W, 3).

    See `Environment` for the map's directions; None is black.
    """

    objects: tuple[Object, ...] | list[Object]
    lights: tuple[Any, ...] | list[Any] = ()
    environment: Three | np.ndarray | None = None
    name: str = ""
