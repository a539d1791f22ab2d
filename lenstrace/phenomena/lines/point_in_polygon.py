"""Which points are inside: a star that crosses itself, by two rules, and points that rounding puts on the wrong side.

The star {n/k} joins every k-th of n points of a circle of radius 1. It runs k times around each point nearer to its
centre than cos(pi k / n); the winding number of any point is also the turns that the direction to it makes along the
polygon, the sum of the angles under which it sees the edges, over 2 pi.

The points (0.5 + i u, 0.5 + j u), u = 2^-53, are left of the line through (12, 12) and (24, 24) where j > i, and on it
where j = i; computed in plain float64, thousands of them are not.
Source: L. Kettner, K. Mehlhorn, S. Pion, S. Schirra, C. Yap, Comput. Geom. 40, 61 (2008).
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from lenstrace.errors import OptionError
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.lines.orientation import ROUNDING, orientation
from lenstrace.phenomena.lines.polygon import Place, inside, winding_number
from lenstrace.phenomena.options import Option, demonstration

SEED = 5  # of the points about the star
LINE = ((12.0, 12.0), (24.0, 24.0))
# A triangle with the same line for an edge, about the points.
TRIANGLE = ((-12.0, -12.0), (24.0, 24.0), (-12.0, 24.0))
NEAR = 0.5  # x and y of the first of the points near the line
EXACT = 0.0  # difference of two counts that agree


@result
class PointInPolygon(Demonstration):
    """The star and the points about it, and what rounding makes of the points near the line.

    star:           (n + 1, 2), its corners, the first again at the end.
    x, y, winding:  (P,), points and how often the star runs around each.
    plain:          (N, N), sides of the points j, i by plain float64: +1 left of the line, 0 on it, -1 right.
    wrong:          how many of these are wrong.
    """

    star: np.ndarray
    x: np.ndarray
    y: np.ndarray
    winding: np.ndarray
    plain: np.ndarray
    wrong: int


@demonstration
def point_in_polygon(
    corners: Annotated[int, Option("corners of the star", least=3, most=15)] = 5,
    step: Annotated[int, Option("how many corners each edge of the star goes on by", least=1, most=7)] = 2,
    points: Annotated[int, Option("points about the star", least=1, most=100_000, slider=(100, 5000))] = 3000,
    grid: Annotated[int, Option("points near the line, in each direction", least=2, most=512)] = 256,
) -> PointInPolygon:
    """Points inside a polygon that crosses itself, and points too near a line for rounding.

    OptionError for a star whose edges go through its centre, or that is the same the other way around.
    """
    if 2 * step >= corners:
        raise OptionError(
            f"point-in-polygon: a star of {corners} corners needs a step below {corners / 2:g}, got {step}"
        )
    turns = 2 * np.pi * step * np.arange(corners) / corners
    star = np.stack([np.sin(turns), np.cos(turns)], -1)[::-1]
    x, y = np.random.default_rng(SEED).uniform(-1, 1, (2, points))
    winding = winding_number(star, x, y).number
    centre, radius = math.cos(math.pi * step / corners), np.hypot(x, y)
    by_rule = [int(inside(star, 0, 0, rule)) for rule in ("even-odd", "winding")]
    on_corners = inside(star, *star.T) == Place.BOUNDARY

    j, i = np.indices((grid, grid))
    near = NEAR + i * ROUNDING, NEAR + j * ROUNDING
    plain, exact = _plain(*near), np.sign(j - i)
    a, b = ((np.full((grid, grid), c_x), np.full((grid, grid), c_y)) for c_x, c_y in LINE)
    by_line = orientation(a, b, near)
    by_triangle = inside(TRIANGLE, *near)

    def wrong(found: np.ndarray, right: np.ndarray | int) -> int:
        return int(np.count_nonzero(found != right))

    return PointInPolygon(
        setting=f"a star of {corners} corners whose edges go on by {step}, and {points} points about it; "
        f"{grid} x {grid} points near the line through (12, 12) and (24, 24), 2^-53 apart",
        rows=(
            Comparison("winding number of the centre", "", int(winding_number(star, 0, 0).number), step, EXACT),
            Comparison("centre inside (1) or outside (-1), even-odd", "", by_rule[0], 1 if step % 2 else -1, EXACT),
            Comparison("centre inside (1) or outside (-1), winding", "", by_rule[1], 1, EXACT),
            Comparison("points with other turns of direction", "", wrong(winding, _turns(star, x, y)), 0, EXACT),
            Comparison("points of the core with another number", "", wrong(winding[radius < centre], step), 0, EXACT),
            Comparison("corners on the boundary", "", int(on_corners.sum()), corners, EXACT),
            Comparison("points near the line on a wrong side", "", wrong(by_line, exact), 0, EXACT),
            Comparison("points on the line", "", int((by_line == 0).sum()), grid, EXACT),
            Comparison("points on the wrong side of a triangle's edge", "", wrong(by_triangle, exact), 0, EXACT),
        ),
        star=np.concatenate([star, star[:1]]),
        x=x,
        y=y,
        winding=winding,
        plain=plain,
        wrong=wrong(plain, exact),
    )


def _turns(star: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The angles under which points see the edges of a polygon, added up, over 2 pi."""
    towards = (star[:, 0] - x[:, None]) + 1j * (star[:, 1] - y[:, None])
    return np.rint(np.angle(np.roll(towards, -1, 1) / towards).sum(1) / (2 * np.pi)).astype(int)


def _plain(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The sign of the determinant as rounding leaves it."""
    (a_x, a_y), (b_x, b_y) = LINE
    return np.sign((a_x - x) * (b_y - y) - (a_y - y) * (b_x - x)).astype(int)
