"""The judge: one ray through a lens in as many digits as wanted, by other algebra than the tracer's.

A conic is met by the textbook's quadratic in six times the digits, checked against the sag; an asphere by scanning
for changes of sign and closing in. Normals are numerical differences of the sag; refraction is a sine and an arcsine.
About 2 ms a surface: for tests only. Vectors are numpy arrays of three mpmath numbers.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import mpmath
import numpy as np

from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.rays import RayStatus
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rows import Row

# mpmath makes its functions and its numbers' class at run time: no type of them can be named.
mp: Any = mpmath.mp
Number = Any
Vector = Any

GUARD_DIGITS = 15  # carried beyond those asked for
EXTRA = 6  # times as many digits where a textbook formula cancels
BISECTIONS = 40  # before secant steps are tried
SCAN = 4000  # points on either side where an asphere's crossings are looked for
SCAN_RANGE = (1e-10, 1e4)  # from the nearest to the farthest of them, in units of the scale
TURNED = -1e-9  # below this cosine a tilt has turned the axis round; a right angle itself has not


@dataclasses.dataclass(frozen=True)
class ReferenceRow:
    """A ray at a surface: point (mm) and direction behind it in that surface's own frame, path from the launch (mm).

    After the first failure the status stays. The rows end where the ray's course ends: the last one then has
    the point nan (MISSED) or the direction of arrival (TIR).
    """

    surface: int
    x: Number
    y: Number
    z: Number
    l: Number
    m: Number
    n: Number
    opl: Number
    status: RayStatus


def reference_trace(
    lens: Lens, point: Sequence[Any], direction: Sequence[Any], wavelength_place: int | None = None, digits: int = 50
) -> list[ReferenceRow]:
    """A ray, given at the first vertex in mm, at surfaces 0 ... S + 1; see `ReferenceRow`.

    wavelength_place: place in lens.wavelengths.um, the primary one by default. Numbers are taken as they are, to
    the last bit; the direction is brought to unit length.
    """
    with mp.workdps(digits + GUARD_DIGITS):
        return list(_course(lens, vector(*point), unit(vector(*direction)), wavelength_place))


def _course(lens: Lens, point: Vector, direction: Vector, wavelength_place: int | None) -> Iterator[ReferenceRow]:
    opl, status, sense = mp.zero, RayStatus.OK, 1
    n = indices_of(lens, wavelength_place)
    yield _row(0, point, direction, opl, status)
    for number, row in enumerate((*lens.rows, lens.image), 1):
        turn, shift = _turn(row), vector(*(row.decenter or (0, 0)), 0)
        point, direction = turn.T @ (point - shift), turn.T @ direction
        turned = -1 if turn[2, 2] < TURNED else 1
        distance = _crossing(row, point, direction, sense * turned)
        if distance is None:
            yield _row(number, point * mp.nan, direction, opl, status or RayStatus.MISSED)
            return
        point = point + distance * direction
        opl += n[number - 1] * distance
        if number <= len(lens.rows) and not _open(*lens.opening(row), point):
            status = status or RayStatus.CLIPPED
        if number <= len(lens.rows):
            behind = _bent(direction, _normal(row, point), row.mirror, n[number - 1], n[number])
            if behind is None:
                yield _row(number, point, direction, opl, status or RayStatus.TIR)
                return
            direction = behind
        yield _row(number, point, direction, opl, status)
        sense *= -1 if row.mirror else 1
        if row.is_break:
            sense *= turned
        else:
            point, direction = turn @ point + shift, turn @ direction
        point = point - vector(0, 0, row.thickness)


def _row(surface: int, point: Vector, direction: Vector, opl: Number, status: RayStatus) -> ReferenceRow:
    (x, y, z), (l, m, n) = point, direction
    return ReferenceRow(surface, x, y, z, l, m, n, opl, status)


def indices_of(lens: Lens, wavelength_place: int | None) -> list[Number]:
    """Of the object space and behind each surface; a mirror keeps what is before it."""
    um = lens.wavelengths.um[lens.wavelengths.primary if wavelength_place is None else wavelength_place]
    indices = [mp.mpf(float(lens.object_medium.index(um)))]
    for row in lens.rows:
        indices.append(indices[-1] if row.mirror else mp.mpf(float(row.medium.index(um))))
    return indices


def _turn(row: Row) -> Any:
    """Rotation about z, then y, then x, each right-handed: turns a vector with the surface."""
    (cx, sx), (cy, sy), (cz, sz) = (
        (mp.cos(angle), mp.sin(angle))
        for angle in (mp.radians(mp.mpf(float(degrees))) for degrees in row.tilt or (0, 0, 0))
    )
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]], object)
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]], object)
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]], object)
    return about_x @ about_y @ about_z


def _bent(direction: Vector, normal: Vector, mirror: bool, before: Number, behind: Number) -> Vector | None:
    """Direction behind a surface, from the angles to its normal; None is total reflection."""
    normal = normal * mp.sign(normal @ direction)
    cosine = normal @ direction
    tangent = direction - cosine * normal
    if mirror:
        return tangent - cosine * normal
    sine = mp.sqrt(tangent @ tangent)
    if sine == 0:
        return direction
    if abs(before * sine) > abs(behind):
        return None
    angle = mp.asin(before * sine / behind)
    return mp.sin(angle) / sine * tangent + mp.cos(angle) * normal


def _open(kind: ApertureKind, sizes: Sequence[Any], point: Vector) -> bool:
    """True where the aperture lets light through, its rim included."""
    r = mp.hypot(point[0], point[1])
    match kind:
        case ApertureKind.CIRCLE:
            return r <= sizes[0]
        case ApertureKind.OBSCURATION:
            return r >= sizes[0]
        case ApertureKind.ANNULUS:
            return sizes[0] <= r <= sizes[1]
        case ApertureKind.RECTANGLE:
            return abs(point[0]) <= sizes[0] and abs(point[1]) <= sizes[1]
    return True


def _sag(row: Row, r: Number) -> Number:
    """Of the sheet through the vertex at the distance r from the axis, as if flat beyond the conic's rim."""
    c, k = mp.mpf(float(row.curvature)), mp.mpf(float(row.conic))
    conic = c * r * r / (1 + mp.sqrt(max(0, 1 - (1 + k) * (c * r) ** 2)))
    return conic + sum(mp.mpf(float(a)) * r**power for power, a in row.asphere.items())


def _above(row: Row, point: Vector) -> Number:
    """Height of a point over the sheet."""
    return point[2] - _sag(row, mp.hypot(point[0], point[1]))


def _normal(row: Row, point: Vector) -> Vector:
    """Of unit length, toward +z at the vertex."""
    r = mp.hypot(point[0], point[1])
    slope = mp.diff(lambda at: _sag(row, at), r) / r if r else 0
    return unit(vector(-slope * point[0], -slope * point[1], 1))


def _crossing(row: Row, point: Vector, direction: Vector, sense: int) -> Number | None:
    """Distance to where the ray passes the sheet along its normal (sense 1) or against it (-1), of several the one
    nearest to the vertex; None if there is none."""
    found = []
    for t in _scanned(row, point, direction) if any(row.asphere.values()) else _conic_roots(row, point, direction):
        at = point + t * direction
        if sense * (_normal(row, at) @ direction) > 0:
            found.append((at @ at, t))
    return min(found, default=(0, None))[1]


def _conic_roots(row: Row, point: Vector, direction: Vector) -> list[Number]:
    """Where c (x^2 + y^2 + (1 + k) z^2) = 2 z, that is a t^2 + 2 b t + d = 0, and z is the sag."""
    tolerance = mp.mpf(10) ** -mp.dps
    flat = tolerance**3  # below this a, in 1/mm, the other root lies beyond all measure
    with mp.workdps(EXTRA * mp.dps):
        c = mp.mpf(float(row.curvature))
        stretched = c * vector(1, 1, 1 + mp.mpf(float(row.conic))) * point
        a = c * (direction @ direction + mp.mpf(float(row.conic)) * direction[2] ** 2)
        b, d = stretched @ direction - direction[2], stretched @ point - 2 * point[2]
        if abs(a) < flat:
            roots = [-d / (2 * b)] if b else []
        else:
            roots = [(-b + sign * mp.sqrt(b * b - a * d)) / a for sign in (1, -1) if b * b >= a * d]
        return [t for t in roots if abs(_above(row, point + t * direction)) < tolerance]


def _scanned(row: Row, point: Vector, direction: Vector) -> Iterator[Number]:
    """Where the ray's height over an asphere changes sign, looked for in float64 around its point nearest to the
    vertex and then closed in on."""
    middle = -(point @ direction)
    start, along = (point + middle * direction).astype(float), direction.astype(float)
    c, k = float(row.curvature), float(row.conic)
    scale = min(1 / abs(c) if c else math.inf, 1 + math.hypot(*start))
    steps = scale * np.geomspace(*SCAN_RANGE, SCAN)
    steps = np.concatenate([-steps[::-1], [0.0], steps])
    x, y, z = (start + steps[:, None] * along).T
    with np.errstate(over="ignore", invalid="ignore"):
        r = np.hypot(x, y)
        above = z - c * r * r / (1 + np.sqrt(1 - (1 + k) * (c * r) ** 2))
        above -= sum(float(a) * r**power for power, a in row.asphere.items())
        changes = np.flatnonzero(np.sign(above[:-1]) * np.sign(above[1:]) <= 0)

    def height(t: Number) -> Number:
        return _above(row, point + t * direction)

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


def vector(*numbers: Any) -> Vector:
    """A vector of mpmath numbers."""
    return np.array([x if isinstance(x, mp.mpf) else mp.mpf(float(x)) for x in numbers], object)


def unit(v: Vector) -> Vector:
    """The unit vector along v."""
    return v / mp.sqrt(v @ v)
