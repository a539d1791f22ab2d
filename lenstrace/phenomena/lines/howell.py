"""View factors in closed form: of the light that leaves shape 1 evenly to all sides, the part that falls on shape 2.

Written so that nothing cancels, however near, far, or narrow the shapes are. Lengths are in any unit, all positive.
Source: J. R. Howell, A Catalog of Radiation Configuration Factors, thermalradiation.net, by the numbers given there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np


def parallel_rectangles(width: float, depth: float, distance: float) -> float:
    """Two equal rectangles that face each other (C-11). With X = width / distance, Y = depth / distance:

    pi X Y F / 2 = ln sqrt((1 + X^2)(1 + Y^2) / (1 + X^2 + Y^2))
                   + X sqrt(1 + Y^2) atan(X / sqrt(1 + Y^2)) - X atan X
                   + Y sqrt(1 + X^2) atan(Y / sqrt(1 + X^2)) - Y atan Y

    >>> round(parallel_rectangles(1, 1, 1), 12)
    0.199824895698
    """
    x, y = width / distance, depth / distance

    def excess(a: float, b: float) -> float:
        """a (s atan(a / s) - atan a) with s = sqrt(1 + b^2)."""
        s = math.hypot(1, b)
        more = b * b / (1 + s)  # s - 1
        return a * (more * math.atan(a / s) - math.atan(a * more / (s + a * a)))

    total = math.log1p((x * y) ** 2 / (1 + x * x + y * y)) / 2 + excess(x, y) + excess(y, x)
    return 2 * total / (math.pi * x * y)


def perpendicular_rectangles(width: float, height: float, length: float) -> float:
    """From a rectangle, length by width, to one that stands on its edge of that length, upright and so high (C-14).

    With W = width / length, H = height / length, r^2 = W^2 + H^2:

    pi W F = W atan(1 / W) + H atan(1 / H) - r atan(1 / r) + 1/4 ln((1 + W^2)(1 + H^2) / (1 + r^2))
             + W^2/4 ln(W^2 (1 + r^2) / ((1 + W^2) r^2)) + H^2/4 ln(H^2 (1 + r^2) / ((1 + H^2) r^2))

    >>> round(perpendicular_rectangles(1, 1, 1), 12)
    0.200043776075
    """
    w, h = width / length, height / length
    r = math.hypot(w, h)
    small, large = min(w, h), max(w, h)
    more = small * small / (r + large)  # r - large
    angles = small * math.atan(1 / small)
    angles += large * math.atan(more / (1 + r * large)) - more * math.atan(1 / r)

    def logarithm(a: float, b: float) -> float:
        """ln(a^2 (1 + r^2) / ((1 + a^2) r^2)), from what the fraction lacks to 1 where that is little."""
        lacks = (b / r) ** 2 / (1 + a * a)
        return math.log1p(-lacks) if lacks < 0.5 else math.log((a / r) ** 2 * (1 + r * r) / (1 + a * a))

    logarithms = math.log1p((w * h) ** 2 / (1 + r * r)) + w * w * logarithm(w, h) + h * h * logarithm(h, w)
    return (angles + logarithms / 4) / (math.pi * w)


def coaxial_disks(radius: float, other: float, distance: float) -> float:
    """From a disk to another that faces it on the same axis (C-41). With q = other / radius:

    F = (X - sqrt(X^2 - 4 q^2)) / 2,   X = 1 + q^2 + (distance / radius)^2

    >>> round(coaxial_disks(1, 1, 1), 12)
    0.38196601125
    """
    q, square = other / radius, (distance / radius) ** 2
    x = 1 + q * q + square
    return 2 * q * q / (x + math.sqrt(((1 - q) ** 2 + square) * (x + 2 * q)))


def closed_box(sides: Sequence[float]) -> np.ndarray:
    """Between the walls of a box, (6, 6), from the row to the column: those across x, those across y, those across z.

    >>> closed_box((1, 1, 1)).sum(1).round(12).tolist()
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    """
    factors = np.zeros((3, 2, 3, 2))
    for axis in range(3):
        first, second = (sides[other] for other in range(3) if other != axis)
        opposite = parallel_rectangles(first, second, sides[axis])
        factors[axis, 0, axis, 1] = factors[axis, 1, axis, 0] = opposite
        for other in {0, 1, 2} - {axis}:
            # walls across `axis` reach along `other` to the walls across that, which are as high as `axis` is long
            factors[axis, :, other, :] = perpendicular_rectangles(sides[other], sides[axis], sides[3 - axis - other])
    return factors.reshape(6, 6)
