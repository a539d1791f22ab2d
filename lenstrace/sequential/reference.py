"""The judge: one ray through a lens in as many digits as wanted, by other algebra than the tracer's.

Crossings and normals as `reference_shapes` says; refraction is a sine and an arcsine. About a millisecond a surface:
for tests and tables of errors only.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.rays import RayStatus
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference_shapes import crossing_of, normal_of
from lenstrace.sequential.reference_surface import (
    TURNED,
    Number,
    ReferenceSurface,
    Vector,
    mp,
    surfaces_of,
    unit,
    vector,
)
from lenstrace.sequential.system import Placement

Finder = Callable[[ReferenceSurface, Vector, Vector, int], Number | None]

GUARD_DIGITS = 15  # carried beyond those asked for


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


class State(NamedTuple):
    """A ray: a point (mm), a unit direction, optical path from the launch (mm), and the sense of its light along z.

    sense: +1 or -1, what the cosine to the normal of a centred surface has for a sign.
    """

    point: Vector
    direction: Vector
    opl: Number
    sense: int


class Step(NamedTuple):
    """A surface crossed: the ray in the surface's own frame, the same where the next surface counts from, the distance
    it came, None where it met nothing, and what became of it here."""

    here: State
    onward: State
    distance: Number | None
    status: RayStatus


def reference_trace(
    lens: Lens, point: Sequence[Any], direction: Sequence[Any], wavelength_place: int | None = None, digits: int = 50
) -> list[ReferenceRow]:
    """A ray, given at the first vertex in mm, at surfaces 0 ... S + 1; see `ReferenceRow`.

    wavelength_place: place in lens.wavelengths.um, the primary one by default. Numbers are taken as they are, to
    the last bit; the direction is brought to unit length.
    """
    with mp.workdps(digits + GUARD_DIGITS):
        start = State(vector(*point), unit(vector(*direction)), mp.zero, 1)
        course = [
            Step(start, start, mp.zero, RayStatus.OK),
            *course_through(surfaces_of(lens, wavelength_place), start),
        ]
        rows, status = [], RayStatus.OK
        for number, step in enumerate(course):
            status = status or step.status
            (x, y, z), (l, m, n) = step.here.point, step.here.direction
            rows.append(ReferenceRow(number, x, y, z, l, m, n, step.here.opl, status))
        return rows


def course_through(surfaces: Sequence[ReferenceSurface], state: State) -> Iterator[Step]:
    """A ray through one surface after the other, until its course ends; in the working precision of mpmath."""
    for surface in surfaces:
        step = crossed(surface, state)
        yield step
        if step.status in (RayStatus.MISSED, RayStatus.TIR):
            return
        state = step.onward


def crossed(surface: ReferenceSurface, state: State, find: Finder = crossing_of) -> Step:
    """A ray through one surface. find: gives the distance to its crossing, from arguments as `crossing_of` has."""
    point, direction, turned = state.point - vector(0, 0, surface.gap), state.direction, 1
    turn = None if surface.placement is Placement.CENTRED else surface.turn
    shift = vector(*surface.decenter, 0)
    if turn is not None:
        point, direction = turn.T @ (point - shift), turn.T @ direction
        turned = -1 if turn[2, 2] < TURNED else 1
    distance = find(surface, point, direction, state.sense * turned)
    if distance is None:
        lost = State(point * mp.nan, direction, state.opl, state.sense)
        return Step(lost, lost, None, RayStatus.MISSED)
    point = point + direction * distance
    opl = state.opl + surface.before * distance
    status = RayStatus.OK if _open(surface, point) else RayStatus.CLIPPED
    if surface.bends:
        behind = _bent(direction, normal_of(surface, point), surface)
        if behind is None:
            lost = State(point, direction, opl, state.sense)
            return Step(lost, lost, distance, status or RayStatus.TIR)
        direction = behind
    sense = state.sense * (-1 if surface.mirror else 1)
    if surface.placement is Placement.BREAK:
        here = State(point, direction, opl, sense * turned)
        return Step(here, here, distance, status)
    here = State(point, direction, opl, sense)
    onward = here if turn is None else State(turn @ point + shift, turn @ direction, opl, sense)
    return Step(here, onward, distance, status)


def _bent(direction: Vector, normal: Vector, surface: ReferenceSurface) -> Vector | None:
    """Direction behind a surface, from the angles to its normal; None is total reflection."""
    before, behind = surface.before, surface.behind
    normal = normal * mp.sign(normal @ direction)
    cosine = normal @ direction
    tangent = direction - normal * cosine
    if surface.mirror:
        return tangent - normal * cosine
    sine = mp.sqrt(tangent @ tangent)
    if sine == 0:
        return direction
    if abs(before * sine) > abs(behind):
        return None
    angle = mp.asin(before * sine / behind)
    return tangent * (mp.sin(angle) / sine) + normal * mp.cos(angle)


def _open(surface: ReferenceSurface, point: Vector) -> bool:
    """True where the aperture lets light through, its rim included."""
    r, sizes = mp.hypot(point[0], point[1]), surface.aperture
    match surface.aperture_kind:
        case ApertureKind.CIRCLE:
            return r <= sizes[0]
        case ApertureKind.OBSCURATION:
            return r >= sizes[0]
        case ApertureKind.ANNULUS:
            return sizes[0] <= r <= sizes[1]
        case ApertureKind.RECTANGLE:
            return abs(point[0]) <= sizes[0] and abs(point[1]) <= sizes[1]
    return True
