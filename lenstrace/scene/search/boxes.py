"""Boxes along the axes of the scene around primitives."""

from __future__ import annotations

from typing import Any

import numpy as np

from lenstrace.optics.shapes.box import Box
from lenstrace.optics.shapes.rectangle import Rectangle
from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.scene.frame import Frame


def boxes(shape: Any, frame: Frame | None) -> tuple[np.ndarray, np.ndarray] | None:
    """Corners (K, 3) of the boxes around K stacked shapes of one kind where they stand, all the time that the shutter
    is open; None for shapes without bounds."""
    own = _own(shape)
    if own is None:
        return None
    low, high = own
    if frame is None:
        return low, high
    axes = np.stack([_rows(axis) for axis in (frame.x, frame.y, frame.z)], -1)
    middle = np.einsum("kij,kj->ki", axes, (low + high) / 2) + _rows(frame.origin)
    # what the turned box reaches along each axis of the scene, and the rounding of all this
    half = np.einsum("kij,kj->ki", np.abs(axes), (high - low) / 2)
    if frame.motion is not None:
        half = half + np.abs(_rows(frame.motion)) / 2
    half = half + 8 * _epsilon(frame.origin) * (half + np.abs(middle))
    return middle - half, middle + half


def _own(shape: Any) -> tuple[np.ndarray, np.ndarray] | None:
    """Corners in the frames of the shapes."""
    match shape:
        case Triangle():
            corners = np.stack([_rows(corner) for corner in (shape.a, shape.b, shape.c)])
            return corners.min(0), corners.max(0)
        case Box():
            half = _rows((shape.half_x, shape.half_y, shape.half_z))
        case Rectangle():
            half = _rows((shape.half_x, shape.half_y, np.zeros_like(shape.half_x)))
        case _:
            return None
    return -half, half


def _rows(vector: Any) -> np.ndarray:
    """Three arrays (K,) as one, (K, 3)."""
    return np.stack([np.asarray(each, float) for each in vector], -1)


def _epsilon(vector: Any) -> float:
    return float(np.finfo(np.asarray(vector[0]).dtype).eps)
