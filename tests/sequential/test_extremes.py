"""The tracer at its extremes: backward errors against the judge, of the named cases and of lenses that are searched."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import lenstrace
from lenstrace import Lens, RayStatus
from lenstrace.analysis.extreme_cases import cases
from lenstrace.analysis.extreme_errors import backward_error, course_of, judged_fate
from lenstrace.analysis.extremes import Errors, extremes, judged
from lenstrace.sequential.reference_surface import surfaces_of_system

MOST = 16.0  # C for each surface crossed; and for a whole lens of up to 20 surfaces
SHORT = 20
LAUNCHED = 4.0
# Of derivatives: by conics of nearly flat surfaces, and at total reflection, terms cancel that are not small.
GRADIENT, CANCELLED = 64.0, 1000.0
CANCELLING = ("critical", "index ratio")
CASES = {case.name: case for case in cases()}


@pytest.mark.parametrize("name", CASES)
def test_the_named_extremes(name: str) -> None:
    found = judged(CASES[name])
    for errors in (found.float32, found.float64):
        assert errors.finite
        assert errors.gradients_finite
        assert errors.statuses
        assert errors.surface <= MOST
        assert errors.course <= MOST or found.surfaces > SHORT
        assert errors.launch <= LAUNCHED
        assert errors.gradient <= (CANCELLED if any(word in name for word in CANCELLING) else GRADIENT)
    assert found.exact is not False
    assert (found.exact is None) == (not CASES[name].scales and not CASES[name].afocal)


def test_every_extreme_is_run_and_progress_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    fine = Errors(1.0, 1.0, 0.0, True, True, True, 1.0)
    monkeypatch.setattr("lenstrace.analysis.extremes._errors", lambda *_: fine)
    monkeypatch.setattr("lenstrace.analysis.extremes._scales", lambda *_: True)
    told: list[tuple[int, int, str]] = []
    found = extremes(lambda *progress: told.append(progress))
    assert [extreme.name for extreme in found] == list(CASES)
    assert told == [*((i, len(CASES), name) for i, name in enumerate(CASES)), (len(CASES), len(CASES), "")]


def test_the_judgement_sees_an_error() -> None:
    """A result that is off by 1e-12 of its size is hundreds of units wrong, and a wrong status is not forgiven."""
    lens = searched([{"curvature": 0.02, "thickness": 5.0, "index": 1.5}, {"curvature": -0.01, "thickness": 30.0}])
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


NEARLY_FLAT = st.sampled_from([0.0, 1e-9, -1e-9, 1e-30])
CURVATURES = st.floats(1e-4, 0.2) | st.floats(-0.2, -1e-4) | NEARLY_FLAT
CONICS = st.sampled_from([0.0, -1.0, -1 + 1e-9, -3.0, 5.0]) | st.floats(-4.0, 2.0)
RATIOS = st.sampled_from([1.5, 1 + 1e-9, 1 + 1e-14]) | st.floats(1.2, 2.2)
# of the first radius, up to the rim of a hemisphere
HEIGHTS = st.floats(0.0, 1.0) | st.floats(1.0, 15.0).map(lambda digits: 1 - 10**-digits)
ANGLES = st.floats(-20.0, 20.0) | st.floats(-89.0, 89.0) | st.floats(-12.0, 0.0).map(lambda digits: 10**digits)
MILD_ANGLES = st.floats(-20.0, 20.0)  # flatter rays meet an asphere of large terms where Newton does not find it
DISTANCES = st.sampled_from([0.0, 5.0, 100.0, 1e4, 1e9])
TILTS = st.floats(0.01, 30.0)
TERMS = st.floats(-1.0, 1.0)  # sag of an asphere's term, mm, at the radius where the rays end
RAYS = 4


def searched(rows: list[dict[str, Any]]) -> Lens:
    """A lens whose first row is the stop."""
    rows[0]["stop"] = True
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 1.0}, [0.0], [0.55])


@st.composite
def lenses(draw: st.DrawFn, kind: str = "conics") -> tuple[Lens, np.ndarray]:
    """Four conics, two glasses, and rays (N, 6); tilted: curvatures are moderate and three surfaces stand askew;
    aspheric: the first and the third have terms up to r^16."""
    rows: list[dict[str, Any]] = [
        {
            "curvature": draw(CURVATURES if kind == "conics" else st.floats(0.001, 0.1)),
            "conic": draw(CONICS),
            "thickness": draw(st.floats(0.1, 20.0)),
        }
        for _ in range(4)
    ]
    rows[0]["index"], rows[2]["index"] = draw(RATIOS), draw(RATIOS)
    radius = min(20.0, 1 / max(abs(rows[0]["curvature"]), 0.01))
    if kind == "tilted":
        for number in (0, 2, 3):
            rows[number] |= {"tilt": [draw(TILTS) for _ in range(3)], "decenter": [draw(TILTS) / 10, 0.5]}
        rows[2]["break"] = True
    if kind == "aspheric":
        for number in (0, 2):
            rows[number]["asphere"] = {power: draw(TERMS) / radius**power for power in (4, 5, 16)}
    rays = []
    for _ in range(RAYS):
        h, around, distance = radius * draw(HEIGHTS), draw(st.floats(0.0, 6.28)), draw(DISTANCES)
        angle = draw(MILD_ANGLES if kind == "aspheric" else ANGLES)
        across, along = np.sin(np.radians([draw(st.floats(-20.0, 20.0)), angle]))
        direction = np.array([across, np.sqrt(1 - across**2) * along, np.sqrt((1 - across**2) * (1 - along**2))])
        point = np.array([h * np.cos(around), h * np.sin(around), 0.0]) - distance * direction
        rays.append([*point, *(direction / np.linalg.norm(direction))])
    return searched(rows), np.array(rays)


def check(lens: Lens, rays: np.ndarray, precision: str) -> None:
    """The tracer errs no more than MOST eps a surface in the backward sense; statuses are the judge's."""
    lens, eps = lens.astype(precision), float(jnp.finfo(precision).eps)
    x, y, z, l, m, n = rays.T
    path = lenstrace.trace(lens, lenstrace.ray((x, y, z), (l, m, n)))
    values = np.stack([np.asarray(a) for a in (path.x, path.y, path.z, path.l, path.m, path.n, path.opl)], -1)
    assert np.isfinite(values).all()
    surfaces = surfaces_of_system(lens.system.at(0))
    for i, ray in enumerate(rays.astype(precision).astype(float)):
        failure = int(np.asarray(path.failure)[-1, i])
        if failure % 8 == RayStatus.NOT_CONVERGED:
            continue  # says that it knows no answer: right, if not wished for, of an asphere that is no lens
        rows = course_of(surfaces, ray)
        agrees, last = judged_fate(surfaces, ray, rows, failure, eps)
        assert agrees
        for surface in range(1, last + 1):
            assert backward_error(rows[surface], values[surface, i], eps) <= MOST * surface


SEARCH = settings(
    max_examples=12,
    phases=(Phase.explicit, Phase.generate),  # to make a failing example smaller takes minutes
    report_multiple_bugs=False,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@SEARCH
@given(case=lenses())
def test_conics(case: tuple[Lens, np.ndarray], precision: str) -> None:
    check(*case, precision)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@SEARCH
@given(case=lenses(kind="tilted"))
def test_tilted_conics(case: tuple[Lens, np.ndarray], precision: str) -> None:
    check(*case, precision)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@SEARCH
@given(case=lenses(kind="aspheric"))
def test_aspheres(case: tuple[Lens, np.ndarray], precision: str) -> None:
    check(*case, precision)
