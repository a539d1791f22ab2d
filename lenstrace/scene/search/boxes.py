"""Boxes along the axes of the scene around primitives."""

from __future__ import annotations

from typing import Any

import numpy as np

from lenstrace.scene.frame import Frame
from lenstrace.scene.stacks import own_first


def boxes(shape: Any, frame: Frame | None) -> tuple[np.ndarray, np.ndarray] | None:
    """Corners (K, 3) of the boxes around K stacked shapes of one kind where they stand, all the time that the shutter
    is open; None where one of them has no bounds."""
    low, high = (_rows(corner) for corner in own_first(shape).bounds())
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return None
    if frame is None:
        return low, high
    axes = np.stack([_rows(axis) for axis in (frame.x, frame.y, frame.z)], -1)
    middle = np.einsum("kij,kj->ki", axes, (low + high) / 2) + _rows(frame.origin)
    # what the turned box reaches along each axis of the scene
    half = np.einsum("kij,kj->ki", np.abs(axes), (high - low) / 2)
    if frame.motion is not None:
        half = half + np.abs(_rows(frame.motion)) / 2
    # and the rounding of all this
    half = half + 8 * np.finfo(np.asarray(frame.origin[0]).dtype).eps * (half + np.abs(middle))
    return middle - half, middle + half


def _rows(vector: Any) -> np.ndarray:
    """Three arrays (K,) as one, (K, 3)."""
    return np.stack(np.broadcast_arrays(*(np.asarray(each, float) for each in vector)), -1)
