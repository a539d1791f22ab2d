"""Where a shape stands in the scene, and how far it moves while the shutter is open."""

from __future__ import annotations

import jax
import numpy as np

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector, dot

Three = tuple[float, float, float]


@pytree
class Frame:
    """Origin and axes of a local frame, in the scene's.

    origin: lengths of the scene.    x, y, z: its axes, orthonormal and right-handed.
    motion: how far it goes while the shutter is open, from its middle half of it back and half on; None: it stands.
    """

    origin: Vector
    x: Vector
    y: Vector
    z: Vector
    motion: Vector | None = None

    def local(self, point: Vector, direction: Vector, moment: jax.Array | None) -> tuple[Vector, Vector]:
        """A point and a direction of the scene seen from the frame. moment: -1/2 to 1/2 of the time of the shutter."""
        a, b, c = (p - o for p, o in zip(point, self._origin(moment), strict=True))
        axes = self.x, self.y, self.z
        return _triple(dot((a, b, c), axis) for axis in axes), _triple(dot(direction, axis) for axis in axes)

    def outer_point(self, point: Vector, moment: jax.Array | None) -> Vector:
        """A point of the frame, in the scene."""
        return _triple(p + o for p, o in zip(self.outer_direction(point), self._origin(moment), strict=True))

    def outer_direction(self, direction: Vector) -> Vector:
        """A direction of the frame, in the scene."""
        a, b, c = direction
        return _triple(a * x + b * y + c * z for x, y, z in zip(self.x, self.y, self.z, strict=True))

    def _origin(self, moment: jax.Array | None) -> Vector:
        if self.motion is None or moment is None:
            return self.origin
        return _triple(o + moment * m for o, m in zip(self.origin, self.motion, strict=True))


def frame_at(position: Three, rotation: Three, motion: Three | None) -> Frame:
    """A frame at a position, tilted by degrees about x, y and z: outer from local is Rx Ry Rz, as in a prescription."""
    sines, cosines = np.sin(np.radians(rotation)), np.cos(np.radians(rotation))
    (sx, sy, sz), (cx, cy, cz) = _exact(sines), _exact(cosines)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    x, y, z = (_triple(axis.tolist()) for axis in (about_x @ about_y @ about_z).T)
    return Frame(_triple(map(float, position)), x, y, z, None if motion is None else _triple(map(float, motion)))  # type: ignore[arg-type]


def _exact(values: np.ndarray) -> np.ndarray:
    """Sines and cosines with those of right angles not rounded: 90 degrees turn z to y, with nothing left of it."""
    nearest = np.round(values)
    return np.where(np.abs(values - nearest) < np.finfo(float).eps, nearest, values)


def _triple(values) -> Vector:  # type: ignore[no-untyped-def]
    a, b, c = values
    return a, b, c
