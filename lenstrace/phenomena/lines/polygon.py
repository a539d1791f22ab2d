"""Which points a polygon contains, by counting the edges that a ray from each point crosses; the answer is exact.

The ray runs toward +x. An edge from a to b crosses it upward where a_y <= y < b_y and the point is on the left of the
edge, downward where b_y <= y < a_y and it is on the right: a ray through a corner crosses one of two edges, or both, or
none, and is counted right. Upward minus downward crossings are the winding number, whose parity is that of their sum.
Sides are told apart by `orientation`, which is exact.
"""

from __future__ import annotations

import enum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lenstrace.errors import OptionError
from lenstrace.phenomena.lines.orientation import orientation

RULES = ("even-odd", "winding")
BLOCK = 1 << 20  # pairs of a point and an edge that are looked at together: a few MB each array


class Place(enum.IntEnum):
    """Where a point is, of a polygon."""

    OUTSIDE = -1
    BOUNDARY = 0
    INSIDE = 1


class Windings(NamedTuple):
    """How often a polygon runs around each point, counter-clockwise positive; without meaning on its boundary."""

    number: np.ndarray
    boundary: np.ndarray


def inside(polygon: ArrayLike, x: ArrayLike, y: ArrayLike, rule: str = "even-odd") -> np.ndarray:
    """Values of `Place` for points x, y, of the shape that they broadcast to.

    polygon:  (N, 2) corners in order, closed by itself; it may cross itself.
    rule:     what is inside: "even-odd", points from which a ray crosses an odd number of edges; "winding", points
              around which the polygon runs a number of times other than 0.
    A point exactly on an edge or a corner is on the boundary by either rule. OptionError for fewer than 3 corners, and
    for numbers that are not finite.

    >>> inside([(0, 0), (2, 0), (0, 2)], [0.5, 1.0, 1.5], [0.5, 1.0, 1.5]).tolist()
    [1, 0, -1]
    """
    if rule not in RULES:
        raise OptionError(f"rule must be one of {', '.join(RULES)}, got {rule!r}")
    number, boundary = winding_number(polygon, x, y)
    within = number % 2 != 0 if rule == "even-odd" else number != 0
    return np.where(boundary, Place.BOUNDARY, np.where(within, Place.INSIDE, Place.OUTSIDE))


def winding_number(polygon: ArrayLike, x: ArrayLike, y: ArrayLike) -> Windings:
    """The winding number of a polygon about points x, y, and which of them are on its boundary; see `inside`."""
    corners = _finite(polygon, "the corners of a polygon")
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3:
        raise OptionError(f"a polygon needs 3 corners or more, each x and y, got an array of shape {corners.shape}")
    px, py = np.broadcast_arrays(_finite(x, "points"), _finite(y, "points"))
    number, boundary = np.zeros(px.size, int), np.zeros(px.size, bool)
    step = max(BLOCK // len(corners), 1)
    for first in range(0, px.size, step):
        block = slice(first, first + step)
        number[block], boundary[block] = _of_block(corners, px.ravel()[block], py.ravel()[block])
    return Windings(number.reshape(px.shape), boundary.reshape(px.shape))


def _of_block(corners: np.ndarray, x: np.ndarray, y: np.ndarray) -> Windings:
    """Of points (P,)."""
    a, b = corners.T, np.roll(corners, -1, 0).T
    least, most = np.minimum(a, b), np.maximum(a, b)
    # edges at the height of a point that do not end on its left
    near = (least[1] <= y[:, None]) & (y[:, None] <= most[1]) & (x[:, None] <= most[0])
    point, edge = np.nonzero(near)
    x, y, (a_x, a_y), (b_x, b_y) = x[point], y[point], a[:, edge], b[:, edge]
    side = orientation((a_x, a_y), (b_x, b_y), (x, y))
    upward = (a_y <= y) & (y < b_y) & (side > 0)
    downward = (b_y <= y) & (y < a_y) & (side < 0)
    touches = (side == 0) & (least[0, edge] <= x)
    number = np.bincount(point, upward * 1.0 - downward, len(near)).astype(int)
    return Windings(number, np.bincount(point, touches, len(near)) > 0)


def _finite(values: ArrayLike, what: str) -> np.ndarray:
    try:
        numbers = np.asarray(values, float)
    except (TypeError, ValueError):
        raise OptionError(f"{what} must be numbers, got {values!r}") from None
    if not np.isfinite(numbers).all():
        raise OptionError(f"{what} must be finite numbers")
    return numbers
