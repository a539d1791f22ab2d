"""Rays for the extremes: arrays (N, 6) of points, mm, and directions at the first vertex."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np


def rays_of(points: Any, directions: Any) -> np.ndarray:
    """(N, 6) out of points, and directions of any length."""
    points, directions = np.broadcast_arrays(np.array(points, float), np.array(directions, float))
    return np.concatenate([points, directions / np.linalg.norm(directions, axis=-1, keepdims=True)], -1)


def bundle(radius: float) -> np.ndarray:
    """Eight rays over a disc in the plane of the first vertex, up to 12 degrees askew."""
    r, around = radius * np.sqrt(np.arange(1, 9) / 8), 2.4 * np.arange(8)
    slope = 0.2 * np.cos(np.arange(8))
    points = np.stack([r * np.cos(around), r * np.sin(around), 0 * r], -1)
    return rays_of(points, np.stack([slope * np.sin(around), slope, 1 + 0 * r], -1))


def at_heights(radius: float, below: Sequence[float], slope: float = 0.0) -> np.ndarray:
    """Rays at heights below a rim by these parts of it, from 1 mm before the vertex."""
    y = radius * (1 - np.array(below))
    return rays_of(np.stack([0 * y, y, 0 * y - 1.0], -1), [[0.0, -slope, 1.0]])


def bent_to_the_rim(radius: float) -> np.ndarray:
    """Rays of a few slopes toward the rim of a hemisphere, from inside and outside it, and past the vertex."""
    y = radius * np.array([0.98, 1.02, 0.9, 0.6, 1.3, 1.0, 0.2, 1.5])
    slopes = np.array([0.02, -0.02, 0.1, 0.3, -0.3, 1.0, 3.0, -1.0])
    return rays_of(np.stack([0 * y, y, 0 * y - 1.0], -1), np.stack([0 * y, slopes, 1 + 0 * y], -1))


def tangents(radius: float, steps: Sequence[float]) -> np.ndarray:
    """Rays that pass a sphere's centre at the radius less these parts of it, half a radian steep."""
    sine, cosine = math.sin(0.5), math.cos(0.5)
    apart = radius * (1 - np.array(steps))[:, None]
    nearest = np.array([0.0, 0.0, radius]) + apart * np.array([0.0, cosine, -sine])
    direction = np.array([0.0, sine, cosine])
    return rays_of(nearest - radius * direction, direction[None])


def nearly_axial(radius: float) -> np.ndarray:
    """Rays parallel to the axis, exactly and nearly."""
    slopes = np.array([0.0, 0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 0.0])
    y = radius * np.linspace(-1, 1, 8)
    return rays_of(np.stack([0.3 * y, y, 0 * y - 2.0], -1), np.stack([0 * y, slopes, 1 + 0 * y], -1))


def fan(z: float, angles: np.ndarray) -> np.ndarray:
    """Rays upward from a point of the axis, at angles to the vertex plane (radians)."""
    return rays_of([[0.0, 0.0, z]], np.stack([0 * angles, np.cos(angles), np.sin(angles)], -1))


def nearly_flat() -> np.ndarray:
    """Rays nearly parallel to the vertex plane."""
    n = np.array([1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 1e-6])
    points = np.stack([0 * n, 0.3 + 0 * n, -n * np.array([0, 0, 0, 1, 1, 1, 1, 5])], -1)
    return rays_of(points, np.stack([np.sqrt(1 - n * n), 0 * n, n], -1))


def turned(rays: np.ndarray) -> np.ndarray:
    """The same rays, run the other way along z."""
    return rays * np.array([1, 1, 1, 1, 1, -1])


def incident(angle: float, steps: Sequence[float]) -> np.ndarray:
    """Rays that meet the vertex at angles (radians) near a given one."""
    angles = angle + np.array(steps)
    return rays_of([[0.0, 0.0, 0.0]], np.stack([0 * angles, np.sin(angles), np.cos(angles)], -1))


def meeting_inside(radius: float, angle: float, steps: Sequence[float]) -> np.ndarray:
    """Rays parallel to the axis that meet a sphere at angles near a given one."""
    y = radius * np.sin(angle + np.array(steps))
    return rays_of(np.stack([0 * y, y, 0 * y - 12.0], -1), [[0.0, 0.0, 1.0]])


def from_far(rays: np.ndarray) -> np.ndarray:
    """The same rays, from places far before the lens."""
    away = np.array([1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e9])[:, None]
    return np.concatenate([rays[:, :3] - away * rays[:, 3:], rays[:, 3:]], -1)


def over_pupil(fields: Sequence[float]) -> np.ndarray:
    """(N, 4): the rim, the centre and a point between, of each field in y."""
    points = [(0.0, 1.0), (0.0, -1.0), (0.7, 0.2), (0.0, 0.0)]
    return np.array([(0.0, field, *point) for field in fields for point in points])
