"""How far results of one ray are from the judge's, in units of eps, and whether its fate is the judge's.

    |computed - true| <= C eps (scale + sum over all numbers v of ray and lens of |d true / d v| |v|)

scale is 1 for direction cosines and, for lengths, the largest |coordinate| or |gap| that the ray has met so far.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from lenstrace.analysis.extremes.moves import DIGITS, moved
from lenstrace.optics.rays import RayStatus, split_failure
from lenstrace.sequential.reference import State, course_through
from lenstrace.sequential.reference_conditions import ConditionedRow, conditioned_trace
from lenstrace.sequential.reference_layout import layout_of
from lenstrace.sequential.reference_surface import ReferenceSurface, exact, mp, unit, vector

BACKWARD = -0.5  # a given ray with a smaller n runs against the light, see `lenstrace.trace`
BOUNDARY = 16.0  # within so many eps of a boundary either status is right
SMALLER, SOME = (1.0, 1 / 4, 1 / 16, 1 / 64), 8  # random moves by shares of the allowed one, and how many of each

Fate = tuple[int, RayStatus]


def course_of(surfaces: Sequence[ReferenceSurface], start: np.ndarray) -> list[ConditionedRow]:
    """The judge's course of a ray given by (6,), point and direction at the first vertex."""
    return conditioned_trace(surfaces, start[:3], start[3:], _sense(start), DIGITS)


def backward_error(row: ConditionedRow, computed: np.ndarray, eps: float) -> float:
    """C of a ray at a surface; computed: (7,), x, y, z, l, m, n, opl."""
    scale = np.array([*[row.length] * 3, 1.0, 1.0, 1.0, row.length])
    with mp.workdps(DIGITS):
        error = np.array([float(abs(true - exact(value))) for true, value in zip(row.values, computed, strict=True)])
    return worst_ratio(error, eps * (scale + row.condition))


def judged_fate(
    surfaces: Sequence[ReferenceSurface], start: np.ndarray, rows: Sequence[ConditionedRow], failure: int, eps: float
) -> tuple[bool, int]:
    """Whether a status is the judge's, or is so for numbers moved by BOUNDARY eps; and the last surface whose numbers
    mean the same for both. NOT_CONVERGED is right too where the judge finds nothing to be met. failure: see `Ray`."""
    true, computed = _fate([row.status for row in rows]), split_failure(failure)
    last = len(rows) - 1 - (rows[-1].status in (RayStatus.MISSED, RayStatus.TIR))
    none = (true[0], RayStatus.NOT_CONVERGED) if true[1] is RayStatus.MISSED else true
    if computed in (true, none):
        return True, last
    disputed = min(surface for surface, _ in (true, computed) if surface)
    # known no better than to the radius of the surface, or in direction than to a radian: either is possible
    unknown = BOUNDARY * eps * rows[disputed - 1].condition
    if (unknown[:3] * abs(float(surfaces[disputed - 1].curvature)) >= 1).any() or (unknown[3:6] >= 1).any():
        return True, min(last, disputed - 1)
    return computed in _fates_nearby(surfaces, start, disputed, BOUNDARY * eps), min(last, disputed - 1)


def worst_ratio(error: np.ndarray, allowed: np.ndarray) -> float:
    """The largest error in units of what is allowed; 0 of what is exact, also where nothing is allowed."""
    exact = error == 0
    with np.errstate(divide="ignore"):
        return float(np.max(np.where(exact, 0, error) / np.where(exact, 1, allowed)))


def _fate(statuses: Sequence[RayStatus]) -> Fate:
    """Number of the surface where a ray failed first, and why; statuses from surface 0 on."""
    return next(((surface, status) for surface, status in enumerate(statuses) if status), (0, RayStatus.OK))


def _fates_nearby(
    surfaces: Sequence[ReferenceSurface], start: np.ndarray, disputed: int, amount: float
) -> Iterator[Fate]:
    """What becomes of the ray where one of its numbers, or of the disputed surface's, is moved by such a part; or all
    numbers are, by random ones and smaller ones: the range within which a ray meets a surface may be small."""
    layout = layout_of(surfaces)
    places = [*range(layout.direction.stop), *layout.media(disputed - 1), *layout.places(disputed - 1)]
    parts = np.zeros((2 * len(places) + len(SMALLER) * SOME, layout.size))
    parts[range(2 * len(places)), [*places, *places]] = amount * np.repeat([1, -1], len(places))
    random = np.random.default_rng(0).uniform(-amount, amount, (len(SMALLER), SOME, parts.shape[1]))
    parts[2 * len(places) :] = (random * np.array(SMALLER)[:, None, None]).reshape(-1, parts.shape[1])
    for part in parts:
        nearby, there = moved(surfaces, start, part)
        with mp.workdps(DIGITS):
            state = State(vector(*there[:3]), unit(vector(*there[3:])), mp.zero, _sense(start))
            yield _fate([RayStatus.OK, *(step.status for step in course_through(nearby, state))])


def _sense(start: np.ndarray) -> int:
    return -1 if start[5] < BACKWARD else 1
