"""How a ray depends on every number of itself and of the lens: derivatives of the judge, and condition numbers.

The condition number of a result times the input is the sum over all numbers v that go in of |d result / d v| |v|: what
an error of one eps in each of them makes of it, in eps. One surface is differentiated by differences in many digits,
the chain of surfaces by the chain rule in float64: the cost grows with the number of surfaces, not its square.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from lenstrace.optics.rays import RayStatus
from lenstrace.sequential.reference import GUARD_DIGITS, Finder, State, Step, crossed
from lenstrace.sequential.reference_layout import POSE, Layout, input_numbers, layout_of
from lenstrace.sequential.reference_shapes import height_over, normal_of
from lenstrace.sequential.reference_surface import Number, ReferenceSurface, Vector, mp, unit, vector
from lenstrace.sequential.system import Placement

RESULTS = 7  # x, y, z, l, m, n, opl
NEWTON_STEPS = 1  # from the crossing of a ray to that of one so close that a step squares its error


class ConditionedRow(NamedTuple):
    """A ray at a surface as the judge has it, and how it depends on what went in.

    values:     x, y, z, l, m, n, opl, as in `ReferenceRow`.
    status:     what became of the ray here.
    slopes:     (7, I), derivatives of the values by all numbers, in the order of `Layout`; nan from where
                one is not finite.
    sizes:      (7, I), of the last row alone: the largest that rounding of the slopes at one surface, to their size
                there, makes of those here; all components of a point, and of a direction, count as the largest.
    condition:  (7,), sum of |slope| |number|; inf there.
    length:     mm, the largest |coordinate| or |gap| that the ray has met so far.
    """

    values: tuple[Number, ...]
    status: RayStatus
    slopes: np.ndarray
    sizes: np.ndarray | None
    condition: np.ndarray
    length: float


def conditioned_trace(
    surfaces: Sequence[ReferenceSurface],
    point: Sequence[Any] | np.ndarray,
    direction: Sequence[Any] | np.ndarray,
    sense: int = 1,
    digits: int = 50,
) -> list[ConditionedRow]:
    """A ray, as for `reference_trace`, at surfaces 0 ... K; the rows end with its course. sense: see `State`."""
    with mp.workdps(digits + GUARD_DIGITS):
        given = vector(*direction)
        state = State(vector(*point), unit(given), mp.zero, sense)
        layout, numbers = layout_of(surfaces), np.abs(input_numbers(surfaces, point, direction))
        slopes = np.zeros((RESULTS, numbers.size))
        slopes[:3, layout.point] = np.eye(3)
        along = state.direction.astype(float)
        slopes[3:6, layout.direction] = (np.eye(3) - np.outer(along, along)) / float(mp.sqrt(given @ given))
        length = max(map(abs, state.point.astype(float)))
        chain = [(np.eye(RESULTS), _evened(np.abs(slopes)))]
        rows = [_row(state, RayStatus.OK, slopes, numbers, length)]
        for i, surface in enumerate(surfaces):
            step = crossed(surface, state)
            if step.distance is None or step.status is RayStatus.TIR:
                rows.append(_row(step.here, step.status, np.full_like(slopes, np.nan), numbers, length))
                return rows
            here, onward = _slopes_of(surface, state, step)
            length = max(length, abs(float(surface.gap)), *map(abs, step.here.point.astype(float)))
            places = _places(i, surface, layout)
            rows.append(_row(step.here, step.status, _chained(here, slopes, places), numbers, length))
            last = here if i == len(surfaces) - 1 else onward
            chain.append((last[:, :RESULTS], _evened(_chained(np.abs(last), np.abs(slopes), places))))
            slopes, state = _chained(onward, slopes, places), step.onward
        rows[-1] = rows[-1]._replace(sizes=_rounded(chain))
        return rows


def _row(state: State, status: RayStatus, slopes: np.ndarray, numbers: np.ndarray, length: float) -> ConditionedRow:
    with np.errstate(over="ignore", invalid="ignore"):
        condition = np.abs(slopes) @ numbers
    return ConditionedRow(
        (*state.point, *state.direction, state.opl),
        status,
        slopes,
        None,
        np.where(np.isnan(condition), np.inf, condition),
        length,
    )


def _places(i: int, surface: ReferenceSurface, layout: Layout) -> list[int]:
    """Among all numbers, those that the i-th surface depends on, in the order of `_slopes_of`."""
    own = layout.places(i)
    return [
        *layout.media(i),
        own[layout.curvature],
        own[layout.conic],
        *own[layout.coefficients][: len(surface.coefficients)],
        own[layout.gap],
        *own[layout.decenter],
        *own[layout.tilt],
    ]


def _chained(step: np.ndarray, slopes: np.ndarray, places: list[int]) -> np.ndarray:
    """Slopes behind a surface, from its own (7, 7 + its numbers) and those before it."""
    with np.errstate(over="ignore", invalid="ignore"):
        chained = step[:, :RESULTS] @ slopes
        # one after the other: two of the places may be the same number
        for place, column in zip(places, step[:, RESULTS:].T, strict=True):
            chained[:, place] += column
    return chained


def _evened(sizes: np.ndarray) -> np.ndarray:
    """(7, I): each component as large as the largest of its point or direction."""
    vectors = sizes[:6].reshape(2, 3, -1)
    return np.concatenate([np.broadcast_to(vectors.max(1, keepdims=True), vectors.shape).reshape(6, -1), sizes[6:]])


def _rounded(chain: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """(7, I), the largest at the end of all sizes (7, I) that arise along a chain of slopes (7, 7)."""
    behind, sizes = np.eye(RESULTS), np.zeros_like(chain[0][1])
    with np.errstate(over="ignore", invalid="ignore"):
        for slopes, here in reversed(chain):
            sizes = np.maximum(sizes, np.abs(behind) @ here)
            behind = behind @ slopes
    return sizes


def _slopes_of(surface: ReferenceSurface, state: State, step: Step) -> tuple[np.ndarray, np.ndarray]:
    """Of the ray here and onward, each (7, 7 + numbers): by the state before, then by the indices before and behind,
    curvature, conic, coefficients, gap, decentre and tilt; nan where a derivative does not exist."""
    try:
        columns = _columns(surface, state, step)
    except ZeroDivisionError:
        columns = np.full((2 * RESULTS, RESULTS + 2 + 2 + len(surface.coefficients) + 1 + POSE), np.nan)
    return columns[:RESULTS], columns[RESULTS:]


def _columns(surface: ReferenceSurface, state: State, step: Step) -> np.ndarray:
    assert step.distance is not None
    near = _finder_near(surface, state, step.distance)
    base = _numbers(step)
    tiny = mp.mpf(10) ** -(mp.dps // 3)
    length = max([abs(x) for x in state.point] + [abs(surface.gap)]) or mp.one

    def slope(changed: ReferenceSurface, start: State, change: Number) -> Vector:
        moved = crossed(changed, start, near)
        if moved.distance is None or moved.status is RayStatus.TIR:
            raise ZeroDivisionError
        return (_numbers(moved) - base) / change

    def by_point(axis: int) -> Vector:
        return slope(surface, state._replace(point=state.point + _along(axis, tiny * length)), tiny * length)

    def by_direction(axis: int) -> Vector:
        return slope(surface, state._replace(direction=unit(state.direction + _along(axis, tiny))), tiny)

    def by_number(name: str, size: Number, place: int | None = None) -> Vector:
        old = getattr(surface, name)
        value = old if place is None else old[place]
        change = tiny * (abs(value) or size)
        new = value + change if place is None else (*old[:place], value + change, *old[place + 1 :])
        return slope(dataclasses.replace(surface, **{name: new}), state, change)

    nothing = base * 0
    points, directions = _three(by_point, state.direction, nothing), _three(by_direction, state.direction, nothing)
    path = nothing.copy()
    path[[RESULTS - 1, -1]] = mp.one
    # a point moved along the ray meets the surface at the same place, on a path shorter by as much
    points[_largest(state.direction)] = points[_largest(state.direction)] - path * (
        surface.before / state.direction[_largest(state.direction)]
    )
    curved = surface.curvature != 0
    bent = nothing
    if surface.bends and not surface.mirror:
        bent = by_number("before", mp.one)
        bent = bent - path * bent[RESULTS - 1]
    poses = [nothing] * POSE
    if surface.placement is not Placement.CENTRED:
        poses = [by_number("decenter", length, place) for place in range(2)]
        poses += [by_number("tilt", mp.one, place) for place in range(3)]
    columns = [
        *points,
        *directions,
        path,
        bent + path * step.distance,
        bent * (-surface.before / surface.behind),  # the law of refraction knows their ratio alone
        by_number("curvature", 1 / length),
        by_number("conic", mp.one) if curved else nothing,
        *(by_number("coefficients", length ** (1 - p), i) for i, p in enumerate(surface.powers)),
        -points[2],
        *poses,
    ]
    return np.array([[float(number) for number in column] for column in columns]).T


def _three(by: Any, direction: Vector, nothing: Vector) -> list[Vector]:
    """Slopes by x, y, z (or l, m, n), as if a change along the direction made none: two are found, the one along its
    largest component follows."""
    third = _largest(direction)
    columns = [nothing if axis == third else by(axis) for axis in range(3)]
    others = [axis for axis in range(3) if axis != third]
    columns[third] = -sum((columns[axis] * (direction[axis] / direction[third]) for axis in others), nothing)
    return columns


def _largest(direction: Vector) -> int:
    return max(range(3), key=lambda axis: abs(direction[axis]))


def _finder_near(surface: ReferenceSurface, state: State, distance: Number) -> Finder:
    """Finds the crossing of a surface and a ray that are moved next to nothing, from the one that is known."""
    rates: list[Number] = []

    def rate(_: ReferenceSurface, point: Vector, direction: Vector, __: int) -> Number:
        normal = normal_of(surface, point + direction * distance)
        rates.append(normal @ direction / normal[2])
        return distance

    crossed(surface, state, rate)

    def near(moved: ReferenceSurface, point: Vector, direction: Vector, _: int) -> Number:
        t = distance
        for _ in range(NEWTON_STEPS):
            t -= height_over(moved, point + direction * t) / rates[0]
        return t

    return near


def _along(axis: int, change: Number) -> Vector:
    return vector(*(change if i == axis else 0 for i in range(3)))


def _numbers(step: Step) -> Vector:
    """Of the ray here, then onward."""
    both = (step.here, step.onward)
    return np.array([x for state in both for x in (*state.point, *state.direction, state.opl)], object)
