"""The judgement at the extremes sees what is wrong: results, statuses, launches, derivatives."""

from __future__ import annotations

import numpy as np
import pytest

import lenstrace
from lenstrace import RayStatus
from lenstrace.analysis.extremes.cases import cases
from lenstrace.analysis.extremes.errors import backward_error, course_of, judged_fate
from lenstrace.analysis.extremes.gradients import gradient_error
from lenstrace.analysis.extremes.launch import judged_launch, launch_error
from lenstrace.analysis.extremes.lenses import Trial, made
from lenstrace.analysis.extremes.slopes import slopes_by_launch, slopes_by_numbers
from lenstrace.sequential.reference_layout import layout_of
from lenstrace.sequential.reference_surface import surfaces_of_system

PRECISIONS = ("float32", "float64")
LAUNCHED, GRADIENT = 4.0, 64.0  # what right ones keep to, derivatives for each surface crossed
CASES = {case.name: case for case in cases()}


def test_the_judgement_sees_an_error() -> None:
    """A result that is off by 1e-12 of its size is hundreds of units wrong, and a wrong status is not forgiven."""
    lens = made([{"curvature": 0.02, "thickness": 5.0, "index": 1.5}, {"curvature": -0.01, "thickness": 30.0}])
    start = np.array([1.0, 3.0, 0.0, 0.0, 0.1, np.sqrt(0.99)])
    surfaces = surfaces_of_system(lens.system.at(0))
    rows = course_of(surfaces, start)
    values = np.array([float(value) for value in rows[-1].values])
    eps = float(np.finfo(float).eps)
    assert backward_error(rows[-1], values, eps) < 1
    for number in range(7):
        wrong = values + (np.arange(7) == number) * 1e-12 * (1 if 3 <= number < 6 else rows[-1].length)
        assert backward_error(rows[-1], wrong, eps) > 100
    for status in (RayStatus.MISSED, RayStatus.TIR):
        assert not judged_fate(surfaces, start, rows, int(2 * 8 + status), eps)[0]
    assert judged_fate(surfaces, start, rows, 0, eps) == (True, 3)


FAR_AND_NEAR = ("object 1e6 ... 1e12 mm away", "object 1e-6 mm away", "telecentric: pupils at infinity")


def launched_trials() -> list[Trial]:
    return [trial for name in FAR_AND_NEAR for trial in CASES[name].trials]


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("trial", launched_trials())
def test_the_judgement_sees_a_doubled_height(trial: Trial, precision: str) -> None:
    """At any distance of the object, and with the pupil at infinity: of the point where the ray starts high enough
    above the axis, of the direction else."""
    assert trial.launched is not None
    lens, eps = trial.lens.astype(precision), float(np.finfo(precision).eps)
    marginal = trial.launched[:1]
    path = lenstrace.trace(lens, field=(marginal[:, 0], marginal[:, 1]), pupil=(marginal[:, 2], marginal[:, 3]))
    start = np.array([np.asarray(a)[0, 0] for a in (path.x, path.y, path.z, path.l, path.m, path.n)], float)
    judge = judged_launch(trial.lens, marginal[0], precision)
    assert launch_error(judge, start, eps) <= LAUNCHED
    for place in (1, 4):
        wrong = start.copy()
        wrong[place] *= 2
        assert launch_error(judge, wrong, eps) > 1000 * LAUNCHED or abs(start[place]) < 1e-4


@pytest.mark.parametrize("name", ["index 4", "telecentric: pupils at infinity"])
@pytest.mark.parametrize("precision", PRECISIONS)
def test_the_judgement_sees_a_wrong_derivative(name: str, precision: str) -> None:
    """Each result's derivative by each group of numbers, however small against those of other results; and those by
    field and pupil."""
    trial = CASES[name].trials[0]
    lens, eps = trial.lens.astype(precision), float(np.finfo(precision).eps)
    system = lens.system.at(lens.system.primary)
    surfaces = surfaces_of_system(system)
    launch, by_launch = None, None
    if trial.launched is None:
        starts = np.asarray(trial.rays).astype(precision)
    else:
        x, y, pupil_x, pupil_y = trial.launched.T
        path = lenstrace.trace(lens, field=(x, y), pupil=(pupil_x, pupil_y))
        starts = np.stack([np.asarray(a)[0] for a in (path.x, path.y, path.z, path.l, path.m, path.n)], -1)
        launch = judged_launch(trial.lens, trial.launched[0], precision)
        by_launch = slopes_by_launch(lens, trial.launched)[0]
    slopes, start = slopes_by_numbers(system, starts)[0], starts[0].astype(float)
    row = course_of(surfaces, start)[-1]
    assert row.sizes is not None

    def error(slopes: np.ndarray, by_launch: np.ndarray | None = by_launch) -> float:
        found = gradient_error(surfaces, start, row, slopes, eps, launch, by_launch)
        assert found is not None
        return found

    limit, layout = GRADIENT * len(surfaces), layout_of(surfaces)
    assert error(slopes) <= limit
    places = [layout.places(0)[layout.curvature], 0, 1, *layout.media(0), layout.places(1)[layout.gap]]
    long = len(surfaces) > 20  # the judge takes seconds
    for result in (1,) if long else (0, 1, 3, 4, 5, 6):
        for place in places[:1] if long else places:
            if abs(row.slopes[result, place]) > 1e-2 * row.sizes[result, place]:
                wrong = slopes.copy()
                wrong[result, place] *= 1.2
                assert error(wrong) > limit
    if by_launch is not None:
        for place in range(4):
            wrong = by_launch.copy()
            wrong[:, place] *= 1.2
            assert error(slopes, wrong) > limit
