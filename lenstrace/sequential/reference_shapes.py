"""The judge's shapes: sag, normal by numerical differences, the crossing of a ray by other algebra than the tracer's.

A conic is met by the textbook's quadratic in six times the digits, checked against the sag; an asphere by scanning for
changes of sign and closing in. Vectors are numpy arrays of three mpmath numbers; in a product with a number they stand
first (mpmath would print them before it gives up).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator

import numpy as np

from lenstrace.sequential.reference_surface import Number, ReferenceSurface, Vector, mp, unit, vector

DIFFERENCE_GUARD = 10  # digits that a difference is carried beyond what it needs
EXTRA = 6  # times as many digits where a textbook formula cancels
BISECTIONS = 40  # before secant steps are tried
SCAN = 4000  # points on either side where an asphere's crossings are looked for
SCAN_RANGE = (1e-10, 1e4)  # from the nearest to the farthest of them, in units of the scale


def crossing_of(surface: ReferenceSurface, point: Vector, direction: Vector, sense: int) -> Number | None:
    """Distance to where the ray passes the sheet along its normal (sense 1) or against it (-1), of several the one
    nearest to the vertex; None if there is none."""
    roots = _scanned if any(surface.coefficients) else _conic_roots
    found = []
    for t in roots(surface, point, direction):
        at = point + direction * t
        if sense * (normal_of(surface, at) @ direction) > 0:
            found.append((at @ at, t))
    return min(found, default=(0, None))[1]


def normal_of(surface: ReferenceSurface, point: Vector) -> Vector:
    """Of unit length, toward +z at the vertex."""
    r = mp.hypot(point[0], point[1])
    slope = _slope(surface, r) / r if r else mp.zero
    return unit(np.array([-slope * point[0], -slope * point[1], mp.one], object))


def height_over(surface: ReferenceSurface, point: Vector) -> Number:
    """Height of a point over the sheet."""
    return point[2] - _sag(surface, mp.hypot(point[0], point[1]))


def _sag(surface: ReferenceSurface, r: Number) -> Number:
    """Of the sheet through the vertex at the distance r from the axis, as if flat beyond the conic's rim."""
    c, k = surface.curvature, surface.conic
    conic = c * r * r / (1 + mp.sqrt(max(0, 1 - (1 + k) * (c * r) ** 2)))
    return conic + sum(a * r**power for power, a in zip(surface.powers, surface.coefficients, strict=True))


def _slope(surface: ReferenceSurface, r: Number) -> Number:
    """Of the sag at r, a central difference in twice the digits; its error is the square of its step."""
    digits = mp.dps
    with mp.workdps(2 * digits + DIFFERENCE_GUARD):
        step = r * mp.mpf(10) ** -(digits // 2 + DIFFERENCE_GUARD)
        return (_sag(surface, r + step) - _sag(surface, r - step)) / (2 * step)


def _conic_roots(surface: ReferenceSurface, point: Vector, direction: Vector) -> list[Number]:
    """Where c (x^2 + y^2 + (1 + k) z^2) = 2 z, that is a t^2 + 2 b t + d = 0, and z is the sag."""
    tolerance = mp.mpf(10) ** -mp.dps
    flat = tolerance**3  # below this a, in 1/mm, the other root lies beyond all measure
    with mp.workdps(EXTRA * mp.dps):
        c, k = surface.curvature, surface.conic
        stretched = vector(1, 1, 1 + k) * point * c
        a = c * (direction @ direction + k * direction[2] ** 2)
        b, d = stretched @ direction - direction[2], stretched @ point - 2 * point[2]
        if abs(a) < flat:
            roots = [-d / (2 * b)] if b else []
        else:
            roots = [(-b + sign * mp.sqrt(b * b - a * d)) / a for sign in (1, -1) if b * b >= a * d]
        return [t for t in roots if abs(height_over(surface, point + direction * t)) < tolerance]


def _scanned(surface: ReferenceSurface, point: Vector, direction: Vector) -> Iterator[Number]:
    """Where the ray's height over an asphere changes sign, looked for in float64 around its point nearest to the
    vertex and then closed in on."""
    middle = -(point @ direction)
    start, along = (point + direction * middle).astype(float), direction.astype(float)
    c, k = float(surface.curvature), float(surface.conic)
    scale = min(1 / abs(c) if c else math.inf, 1 + math.hypot(*start))
    steps = scale * np.geomspace(*SCAN_RANGE, SCAN)
    steps = np.concatenate([-steps[::-1], [0.0], steps])
    x, y, z = (start + steps[:, None] * along).T
    with np.errstate(over="ignore", invalid="ignore"):
        r = np.hypot(x, y)
        above = z - c * r * r / (1 + np.sqrt(1 - (1 + k) * (c * r) ** 2))
        above -= sum(float(a) * r**power for power, a in zip(surface.powers, surface.coefficients, strict=True))
        changes = np.flatnonzero(np.sign(above[:-1]) * np.sign(above[1:]) <= 0)

    def height(t: Number) -> Number:
        return height_over(surface, point + direction * t)

    for low, high in ((middle + mp.mpf(steps[i]), middle + mp.mpf(steps[i + 1])) for i in changes):
        if (height(low) > 0) != (height(high) > 0):
            yield _zero(height, low, high)


def _zero(f: Callable[[Number], Number], low: Number, high: Number) -> Number:
    """A zero of f between two points where its signs differ: bisection, then secant steps that stay between them."""
    rises, last, estimate, f_last = f(high) > 0, low, high, f(low)
    for count in itertools.count():
        value = f(estimate)
        if value == 0:
            break
        low, high = (low, estimate) if (value > 0) == rises else (estimate, high)
        following = (low + high) / 2
        if count > BISECTIONS and value != f_last:
            secant = estimate - value * (estimate - last) / (value - f_last)
            following = secant if low <= secant <= high else following
        last, estimate, f_last = estimate, following, value
        if abs(estimate - last) <= mp.mpf(10) ** (5 - mp.dps) * (1 + abs(estimate)):
            break
    return estimate
