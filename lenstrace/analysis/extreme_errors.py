"""How far results and derivatives of one ray are from the judge's, in units of eps.

    |computed - true| <= C eps (scale + sum over all numbers v of ray and lens of |d true / d v| |v|)

scale is 1 for direction cosines and, for lengths, the largest |coordinate| or |gap| that the ray has met so far.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

import jax
import numpy as np

from lenstrace.optics.rays import RayStatus, split_failure
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference import State, course_through
from lenstrace.sequential.reference_conditions import ConditionedRow, conditioned_trace
from lenstrace.sequential.reference_launch import reference_launch
from lenstrace.sequential.reference_surface import ReferenceSurface, exact, mp, unit, vector

DIGITS = 50
BACKWARD = -0.5  # a given ray with a smaller n runs against the light, see `lenstrace.trace`
BOUNDARY = 16.0  # within so many eps of a boundary either status is right
LAUNCH_STEP = 2.0**-20  # relative, of the numbers that a launch depends on
CHAIN = 2.0**-52  # what the judge's chain of derivatives, of numbers of about 1, is rounded to
SMALLER, SOME = (1.0, 1 / 4, 1 / 16, 1 / 64), 8  # random moves by shares of the allowed one, and how many of each
NOTHING = 1e-14  # derivatives below this are its rounding of 0

Fate = tuple[int, RayStatus]


def course_of(surfaces: Sequence[ReferenceSurface], start: np.ndarray) -> list[ConditionedRow]:
    """The judge's course of a ray given by (6,), point and direction at the first vertex."""
    return conditioned_trace(surfaces, start[:3], start[3:], _sense(start), DIGITS)


def backward_error(row: ConditionedRow, computed: np.ndarray, eps: float) -> float:
    """C of a ray at a surface; computed: (7,), x, y, z, l, m, n, opl."""
    scale = np.array([*[row.length] * 3, 1.0, 1.0, 1.0, row.length])
    with mp.workdps(DIGITS):
        error = np.array([float(abs(true - exact(value))) for true, value in zip(row.values, computed, strict=True)])
    return _worst_ratio(error, eps * (scale + row.condition))


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


def gradient_error(
    surfaces: Sequence[ReferenceSurface], start: np.ndarray, row: ConditionedRow, computed: np.ndarray, eps: float
) -> float:
    """Error of derivatives (7, I) of a ray at its last surface.

    Worst over groups of like numbers (all curvatures, all gaps, ...), as a multiple of what the derivatives by the
    group change where all numbers move by an eps, and of eps times the largest of them.
    """
    count = len(surfaces)
    width = (row.slopes.shape[1] - 6 - count) // count
    length = row.length or 1.0
    terms = max((s.powers for s in surfaces), key=len)
    sizes = [1 / length, 1.0, *(length ** (1 - p) for p in terms), length, length, length, 1.0, 1.0, 1.0]
    groups = (
        [0] * 3
        + [1] * 3
        + [2] * count
        + [3 + i for i in [*range(width - 5), *[width - 5] * 2, *[width - 4] * 3]] * count
    )
    weights = np.array([length] * 3 + [1.0] * 3 + [1.0] * count + sizes * count)
    scale = np.array([*[length] * 3, 1.0, 1.0, 1.0, length])[:, None]
    signs = np.random.default_rng(0).choice([-1.0, 1.0], weights.size)
    moved = course_of(*_moved(surfaces, start, eps * signs))
    if len(moved) != count + 1:
        return 0.0

    def without_units(slopes: np.ndarray) -> np.ndarray:
        bare = slopes * weights / scale
        return np.where(np.abs(bare) < NOTHING, 0, bare)

    # before the first surface there is no gap
    gap = 6 + count + width - 6
    weights[gap] = 0
    true, other, found = map(without_units, (row.slopes, moved[-1].slopes, _across(computed, start)))
    worst = 0.0
    for group in range(max(groups) + 1):
        these = np.array(groups) == group
        # where all are 0 their own size says nothing: then that of a number of about 1
        largest = np.abs(true[:, these]).max() or 1.0
        allowed = eps * largest + np.abs(other - true)[:, these].max() + CHAIN
        worst = max(worst, np.abs(found - true)[:, these].max() / allowed)
    return float(worst)


def launch_error(lens: Lens, launched: np.ndarray, start: np.ndarray, precision: str) -> float:
    """C of a launched ray (6,) in front of the lens; launched: (4,), field and pupil as the tracer was given them."""
    eps = float(np.finfo(precision).eps)
    # the document with the numbers that the compiled system has
    lens = jax.tree.map(lambda value: float(np.asarray(value).astype(precision)), lens)
    scale = lens.fields.scale
    field = [exact(float((value * scale).astype(precision))) / exact(scale) for value in launched[:2].astype(float)]
    numbers, tree = jax.tree.flatten((lens, [float(value) for value in launched[2:]]))

    def ray(moved: list[float], shares: Sequence[Any] = (1, 1)) -> np.ndarray:
        document, pupil = tree.unflatten(moved)
        ends = reference_launch(document, [f * share for f, share in zip(field, shares, strict=True)], pupil, DIGITS)
        return np.concatenate(ends)

    with mp.workdps(DIGITS):
        true = ray(numbers)
        changes = [
            ray([*numbers[:i], number * (1 + LAUNCH_STEP), *numbers[i + 1 :]]) - true
            for i, number in enumerate(numbers)
            if number and np.isfinite(number)
        ]
        changes += [ray(numbers, shares) - true for shares in ((1 + LAUNCH_STEP, 1), (1, 1 + LAUNCH_STEP))]
        condition = np.sum([np.abs(change).astype(float) for change in changes], 0) / LAUNCH_STEP
        error = np.array([float(abs(a - exact(b))) for a, b in zip(true, start, strict=True)])
    length = max(np.abs(start[:3]).max(), float(lens.object_distance or 0))
    return _worst_ratio(error, eps * (np.array([length] * 3 + [1.0] * 3) + condition))


def _fate(statuses: Sequence[RayStatus]) -> Fate:
    """Number of the surface where a ray failed first, and why; statuses from surface 0 on."""
    return next(((surface, status) for surface, status in enumerate(statuses) if status), (0, RayStatus.OK))


def _fates_nearby(
    surfaces: Sequence[ReferenceSurface], start: np.ndarray, disputed: int, amount: float
) -> Iterator[Fate]:
    """What becomes of the ray where one of its numbers, or of the disputed surface's, is moved by such a part; or all
    numbers are, by random ones and smaller ones: the range within which a ray meets a surface may be small."""
    count = len(surfaces)
    width = 2 + max(len(s.coefficients) for s in surfaces) + 6
    first = 6 + count + (disputed - 1) * width
    places = [*range(6), 6 + disputed - 1, min(6 + disputed, 5 + count), *range(first, first + width)]
    parts = np.zeros((2 * len(places) + len(SMALLER) * SOME, 6 + count + count * width))
    parts[range(2 * len(places)), [*places, *places]] = amount * np.repeat([1, -1], len(places))
    random = np.random.default_rng(0).uniform(-amount, amount, (len(SMALLER), SOME, parts.shape[1]))
    parts[2 * len(places) :] = (random * np.array(SMALLER)[:, None, None]).reshape(-1, parts.shape[1])
    for part in parts:
        moved, there = _moved(surfaces, start, part)
        with mp.workdps(DIGITS):
            state = State(vector(*there[:3]), unit(vector(*there[3:])), mp.zero, _sense(start))
            yield _fate([RayStatus.OK, *(step.status for step in course_through(moved, state))])


def _moved(
    surfaces: Sequence[ReferenceSurface], start: np.ndarray, parts: np.ndarray
) -> tuple[list[ReferenceSurface], Any]:
    """All numbers moved by these parts of themselves, a ray's by parts of its largest one; the order is that of
    `input_numbers`."""
    count = len(surfaces)
    width = 2 + max(len(s.coefficients) for s in surfaces) + 6
    with mp.workdps(DIGITS):
        part = [exact(p) for p in parts]
        there = [exact(x) + part[i] * exact(np.abs(start[:3]).max()) for i, x in enumerate(start[:3])]
        there += [exact(x) + part[3 + i] for i, x in enumerate(start[3:])]
        moved = []
        for i, surface in enumerate(surfaces):
            own = part[6 + count + i * width :][:width]
            moved.append(
                dataclasses.replace(
                    surface,
                    before=surface.before * (1 + part[6 + i]),
                    behind=surface.behind * (1 + part[6 + min(i + 1, count - 1)]),
                    curvature=surface.curvature * (1 + own[0]),
                    conic=surface.conic * (1 + own[1]),
                    coefficients=tuple(a * (1 + p) for a, p in zip(surface.coefficients, own[2:], strict=False)),
                    gap=surface.gap * (1 + own[-6]),
                    decenter=tuple(a * (1 + p) for a, p in zip(surface.decenter, own[-5:-3], strict=True)),
                    tilt=tuple(a * (1 + p) for a, p in zip(surface.tilt, own[-3:], strict=True)),
                )
            )
    return moved, np.array(there, object)


def _worst_ratio(error: np.ndarray, allowed: np.ndarray) -> float:
    """0 of what is exact, also where nothing is allowed."""
    exact = error == 0
    with np.errstate(divide="ignore"):
        return float(np.max(np.where(exact, 0, error) / np.where(exact, 1, allowed)))


def _across(slopes: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Derivatives by the direction, of changes that leave it a unit vector."""
    along = start[3:] / np.linalg.norm(start[3:])
    across = slopes.copy()
    across[:, 3:6] -= np.outer(slopes[:, 3:6] @ along, along)
    return across


def _sense(start: np.ndarray) -> int:
    return -1 if start[5] < BACKWARD else 1
