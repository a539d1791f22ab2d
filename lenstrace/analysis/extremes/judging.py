"""The tracer at the extremes: its error in units of eps, a backward error, against the judge.

In float32 the judge gets the float32 numbers. C and its scale: see `errors`, `launch` and `gradients`; the bound to
hold is 16 for each surface crossed.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import jax
import numpy as np

from lenstrace.analysis.cardinal import first_order
from lenstrace.analysis.extremes.cases import cases
from lenstrace.analysis.extremes.errors import backward_error, course_of, judged_fate
from lenstrace.analysis.extremes.gradients import gradient_error
from lenstrace.analysis.extremes.launch import JudgedLaunch, judged_launch, launch_error
from lenstrace.analysis.extremes.lenses import Case, Trial
from lenstrace.analysis.extremes.slopes import slopes_by_launch, slopes_by_numbers
from lenstrace.analysis.rays import ray, trace
from lenstrace.optics.rays import Ray
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference_surface import surfaces_of_system

PRECISIONS = ("float32", "float64")

Progress = Callable[[int, int, str], None]


@dataclasses.dataclass(frozen=True)
class Errors:
    """Of one extreme in one precision, in units of its eps.

    course, surface:   worst C at any surface, and the worst of C / number of surfaces crossed.
    launch:            worst C of rays where they are launched; 0 where they are given.
    statuses:          every status is the judge's, or is so for numbers moved by 16 eps.
    finite:            all results are finite, those of lost rays included.
    gradients_finite:  so are the derivatives of the results by every number of ray and lens.
    gradient:          worst error of the derivatives of a ray that arrives, by all numbers of ray and lens, and by
                       field and pupil if it is launched: see `gradients`; None where none is judged.
    gradients:         of how many rays the derivatives are judged: of all that arrive, and still do where numbers are
                       moved by an eps.
    """

    course: float
    surface: float
    launch: float
    statuses: bool
    finite: bool
    gradients_finite: bool
    gradient: float | None
    gradients: int


@dataclasses.dataclass(frozen=True)
class Extreme:
    """What was found at one extreme.

    surfaces, rays:  of its longest lens, the image included; of all its lenses.
    exact:           what must be exact is so: results of scaled lenses to the last bit, power 0 and infinite focal
                     lengths of afocal ones; None where nothing must.
    """

    name: str
    surfaces: int
    rays: int
    float32: Errors
    float64: Errors
    exact: bool | None


def extremes(progress: Progress | None = None) -> tuple[Extreme, ...]:
    """The tracer at every extreme. progress: called with how many are done, of how many, and the next name."""
    every, found = cases(), []
    for case in every:
        if progress is not None:
            progress(len(found), len(every), case.name)
        found.append(judged(case))
    if progress is not None:
        progress(len(every), len(every), "")
    return tuple(found)


def judged(case: Case) -> Extreme:
    """One extreme."""
    single, double = (
        _worst([_errors(trial, precision) for trial in case.trials if trial.precision in (None, precision)])
        for precision in PRECISIONS
    )
    exact = None
    if case.scales:
        exact = all(_scales(case, precision) for precision in PRECISIONS)
    elif case.afocal:
        exact = all(_is_afocal(trial.lens.astype(precision)) for trial in case.trials for precision in PRECISIONS)
    surfaces = max(len(trial.lens) for trial in case.trials) + 1
    return Extreme(case.name, surfaces, sum(trial.count for trial in case.trials), single, double, exact)


def _worst(errors: list[Errors]) -> Errors:
    """The worst of each figure: the largest number, or False; and how many gradients were judged in all."""
    judged = [each.gradient for each in errors if each.gradient is not None]
    return Errors(
        course=max(each.course for each in errors),
        surface=max(each.surface for each in errors),
        launch=max(each.launch for each in errors),
        statuses=all(each.statuses for each in errors),
        finite=all(each.finite for each in errors),
        gradients_finite=all(each.gradients_finite for each in errors),
        gradient=max(judged, default=None),
        gradients=sum(each.gradients for each in errors),
    )


def _errors(trial: Trial, precision: str) -> Errors:
    lens = trial.lens.astype(precision)
    system = lens.system.at(lens.system.primary)
    eps = float(np.finfo(precision).eps)
    path = _traced(lens, trial)
    values = np.stack([np.asarray(a) for a in (path.x, path.y, path.z, path.l, path.m, path.n, path.opl)], -1)
    starts, failures = values[0, :, :6], np.asarray(path.failure)[-1]
    slopes = slopes_by_numbers(system, starts)
    launches: list[JudgedLaunch | None] = [None] * trial.count
    by_launch = np.zeros((trial.count, 7, 0))
    if trial.launched is not None:
        launches = [judged_launch(trial.lens, launched, precision) for launched in trial.launched]
        by_launch = slopes_by_launch(lens, trial.launched)
    starts = starts.astype(float)
    surfaces = surfaces_of_system(system)
    found = []
    for i, (start, launch) in enumerate(zip(starts, launches, strict=True)):
        rows = course_of(surfaces, start)
        agrees, last = judged_fate(surfaces, start, rows, int(failures[i]), eps)
        each = [backward_error(rows[s], values[s, i], eps) for s in range(1, last + 1)]
        gradient = None
        if last == len(surfaces) and np.isfinite(rows[-1].condition).all():
            gradient = gradient_error(surfaces, start, rows[-1], slopes[i], eps, launch, by_launch[i])
        found.append(
            Errors(
                course=max(each, default=0.0),
                surface=max((error / s for s, error in enumerate(each, 1)), default=0.0),
                launch=0.0 if launch is None else launch_error(launch, start, eps),
                statuses=agrees,
                finite=bool(np.isfinite(values[:, i]).all()),
                gradients_finite=bool(np.isfinite(slopes[i]).all() and np.isfinite(by_launch[i]).all()),
                gradient=gradient,
                gradients=int(gradient is not None),
            )
        )
    return _worst(found)


def _traced(lens: Lens, trial: Trial) -> Ray:
    """The rays of a trial at all surfaces, as any caller would trace them."""
    if trial.launched is not None:
        x, y, pupil_x, pupil_y = trial.launched.T
        return trace(lens, field=(x, y), pupil=(pupil_x, pupil_y))
    assert trial.rays is not None
    x, y, z, l, m, n = trial.rays.T
    return trace(lens, ray((x, y, z), (l, m, n)))


def _scales(case: Case, precision: str) -> bool:
    """True where the lengths of the other trials are those of the first, scaled, and all else is the same."""
    first, *others = (_traced(trial.lens.astype(precision), trial) for trial in case.trials)
    for other, scale in zip(others, case.scales, strict=True):
        for name in ("x", "y", "z", "l", "m", "n", "opl"):
            factor = np.asarray(1.0 if name in "lmn" else scale, precision)
            if not np.array_equal(np.asarray(getattr(first, name)) * factor, np.asarray(getattr(other, name))):
                return False
    return True


def _is_afocal(lens: Lens) -> bool:
    """True where power is 0, what lies at infinity is inf, and nothing is nan."""
    found = first_order(lens)
    numbers = [np.asarray(value) for value in jax.tree.leaves(found)]
    infinite = np.isinf(found.focal_length).all() and np.isinf(found.rear_principal_plane).all()
    return bool(np.all(found.power == 0)) and bool(infinite) and not any(np.isnan(value).any() for value in numbers)
