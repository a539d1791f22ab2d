"""On which side of a line a point lies: the sign of a determinant, never wrong.

    (a_x - p_x) (b_y - p_y) - (a_y - p_y) (b_x - p_x)

is positive where p is on the left of the line from a to b. In float64 its rounding error is at most (3 + 16 u) u times
the sum of the two products' sizes, u = 2^-53; what is no larger is computed again in whole numbers, which do not round.
Source: J. R. Shewchuk, Discrete Comput. Geom. 18, 305 (1997), ORIENT2D.
"""

from __future__ import annotations

import numpy as np

ROUNDING = 2.0**-53  # u
BOUND = (3 + 16 * ROUNDING) * ROUNDING
# What both products can lose where they are smaller than normal numbers.
UNDERFLOW = 4 * 2.0**-1074

Points = tuple[np.ndarray, np.ndarray]


def orientation(a: Points, b: Points, p: Points) -> np.ndarray:
    """+1 where p is on the left of the line from a to b, -1 on the right, 0 exactly on it (or where a is b).

    a, b, p: x and y, finite float64 of one shape. A point that needs whole numbers takes about 3 us.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        left, right = (a[0] - p[0]) * (b[1] - p[1]), (a[1] - p[1]) * (b[0] - p[0])
        value = left - right
        sure = np.isfinite(value) & (abs(value) > BOUND * (abs(left) + abs(right)) + UNDERFLOW)
    sign = np.sign(value, where=sure, out=np.zeros(np.shape(value)))
    unsure = np.nonzero(~sure)
    numbers = [np.broadcast_to(each, sign.shape)[unsure].tolist() for each in (*a, *b, *p)]
    sign[unsure] = [_exact(*each) for each in zip(*numbers, strict=True)]
    return sign.astype(int)


def _exact(*numbers: float) -> int:
    """The sign in whole numbers: every float is one, divided by a power of two."""
    ratios = [number.as_integer_ratio() for number in numbers]
    scale = max(below for _, below in ratios)
    a_x, a_y, b_x, b_y, x, y = (above * (scale // below) for above, below in ratios)
    value = (a_x - x) * (b_y - y) - (a_y - y) * (b_x - x)
    return (value > 0) - (value < 0)
