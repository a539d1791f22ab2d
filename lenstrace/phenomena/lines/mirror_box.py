"""Rays inside a box of perfect mirrors: to the nearest wall ahead and back from it, and so on.

The box reaches from the origin to its sides. A ray is a point and a displacement, the whole way that it is to go: it is
at point + t displacement for t = 0 ... 1, turned at each wall. Which wall of two is ahead is told by the sign of the
displacement, that of a zero too, and when it is met by the time since the one across: no ray meets the wall that it has
just left, however rounding places it, and one that starts on a wall and heads into it meets it at once. In an edge or a
corner a ray meets two or three walls, one after the other at no distance, and comes back the way it went.
"""

from __future__ import annotations

import numpy as np


def bounced(sides: np.ndarray, start: np.ndarray, displacement: np.ndarray, bounces: int) -> np.ndarray:
    """Points of paths that are reflected so many times: start, reflections, end; (bounces + 2, P, 3).

    sides: (3,), positive.        start, displacement: (P, 3) or (3,); the start is in the box.
    The end is where the displacement is used up, in the box only if no further wall was in the way. A displacement of
    length zero meets no walls but those that it starts on.

    >>> bounced(np.ones(3), np.array([0.5, 0.5, 0.5]), np.array([[1.0, 0.25, 0.0]]), 1)[:, 0].tolist()
    [[0.5, 0.5, 0.5], [1.0, 0.625, 0.5], [0.5, 0.75, 0.5]]
    """
    displacement = np.array(displacement, float)
    point = np.array(np.broadcast_to(start, displacement.shape), float)
    speed = abs(displacement)
    gap = abs(_ahead(sides, displacement) - point)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        meets = np.where(gap == 0, 0, gap / speed)
        across = sides / speed
    now, rays, points = np.zeros(len(point)), np.arange(len(point)), [point]
    for _ in range(bounces):
        axis = meets.argmin(1)
        then = meets[rays, axis]
        point = np.clip(point + (then - now)[:, None] * displacement, 0, sides)
        point[rays, axis] = _ahead(sides, displacement)[rays, axis]
        displacement[rays, axis] *= -1
        meets[rays, axis] += across[rays, axis]
        now = then
        points.append(point)
    return np.stack([*points, point + (1 - now)[:, None] * displacement])


def _ahead(sides: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """Where the walls are that rays head for, (P, 3)."""
    return np.where(np.signbit(displacement), 0.0, sides)
