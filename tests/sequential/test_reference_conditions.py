"""The judge's derivatives and condition numbers, against closed forms and differences of whole courses."""

from __future__ import annotations

import dataclasses
import itertools
from typing import Any

import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens, RayStatus
from lenstrace.sequential.reference import State, course_through, reference_trace
from lenstrace.sequential.reference_conditions import conditioned_trace
from lenstrace.sequential.reference_layout import input_numbers
from lenstrace.sequential.reference_surface import ReferenceSurface, surfaces_of, surfaces_of_system, unit, vector

mp: Any = mpmath.mp
STEP = mp.mpf(10) ** -20
ROWS = [
    {"radius": 60.0, "thickness": 5.0, "index": 1.6, "tilt": [5.0, -3.0, 20.0], "decenter": [0.5, -0.7], "stop": True},
    {"radius": -90.0, "thickness": 10.0, "tilt": [-10.0, 8.0, 70.0], "decenter": [-1.0, 2.0], "break": True},
    {"thickness": 5.0, "index": 1.5, "tilt": [20.0, 15.0, -33.0], "asphere": {4: 1e-5, 6: 1e-8}},
    {"radius": -40.0, "conic": -1.0, "thickness": 40.0},
    {"radius": -80.0, "mirror": True, "thickness": -40.0},
]
POINT, DIRECTION = (1.0, 2.0, -3.0), (0.05, -0.1, 0.9)


def made(rows: list[dict[str, Any]], **more: Any) -> Lens:
    """A lens of one wavelength whose first row is the stop."""
    rows[0] = {"stop": True, **rows[0]}
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 1.0}, [0.0], [0.55], **more)


def end(surfaces: list[ReferenceSurface], point: Any, direction: Any) -> np.ndarray:
    """Of a whole course, without any chain rule."""
    *_, last = course_through(surfaces, State(vector(*point), unit(vector(*direction)), mp.zero, 1))
    return np.array([*last.here.point, *last.here.direction, last.here.opl])


def moved(surfaces: list[ReferenceSurface], name: str, number: int, place: int | None) -> list[ReferenceSurface]:
    old = getattr(surfaces[number], name)
    new = old + STEP if place is None else tuple(a + STEP * (i == place) for i, a in enumerate(old))
    return [dataclasses.replace(s, **{name: new}) if i == number else s for i, s in enumerate(surfaces)]


def test_slopes_are_differences_of_the_whole_course() -> None:
    surfaces = surfaces_of_system(made(ROWS).system.at(0))
    last = conditioned_trace(surfaces, POINT, DIRECTION)[-1]
    count, width = len(surfaces), 2 + 2 + 6
    places = [("curvature", None), ("conic", None), ("coefficients", 0), ("coefficients", 1), ("gap", None)]
    places += [("decenter", i) for i in range(2)] + [("tilt", i) for i in range(3)]
    with mp.workdps(65):
        base = end(surfaces, POINT, DIRECTION)
        changed = {}
        for i in range(3):
            at = [mp.mpf(x) + STEP * (i == j) for j, x in enumerate(POINT)]
            along = [mp.mpf(x) + STEP * (i == j) for j, x in enumerate(DIRECTION)]
            changed[i], changed[3 + i] = end(surfaces, at, DIRECTION), end(surfaces, POINT, along)
        for number in range(4):  # the mirror's medium is the one before it
            indices = [s.before + STEP * (i == number) for i, s in enumerate(surfaces)]
            pairs = zip(surfaces, itertools.pairwise([*indices, indices[-1]]), strict=True)
            changed[6 + number] = end(
                [dataclasses.replace(s, before=a, behind=b) for s, (a, b) in pairs], POINT, DIRECTION
            )
        for number, (i, (name, place)) in itertools.product(range(count), enumerate(places)):
            surface = surfaces[number]
            posed = any(surface.decenter) or any(surface.tilt)
            if (name == "coefficients" and not surface.powers) or (name in ("decenter", "tilt") and not posed):
                continue
            changed[6 + count + number * width + i] = end(moved(surfaces, name, number, place), POINT, DIRECTION)
        expected = {column: ((value - base) / STEP).astype(float) for column, value in changed.items()}
    for column, slope in expected.items():
        assert_allclose(last.slopes[:, column], slope, rtol=1e-11, atol=1e-13, err_msg=str(column))
    numbers = np.abs(input_numbers(surfaces, POINT, DIRECTION))
    columns = list(expected)
    # the index behind the mirror is that before it, and counts with it
    assert_allclose(last.condition[:6], np.abs(last.slopes[:6]) @ numbers, rtol=1e-12)
    assert (np.abs(last.slopes[:, columns]) @ numbers[columns] <= last.condition * (1 + 1e-12)).all()


def test_a_plane_by_closed_form() -> None:
    # at height y under the angle a onto glass of index n: sin b = sin a / n, dm/dn = -sin a / n^2
    surfaces = surfaces_of_system(made([{"index": 1.5, "thickness": 2.0}]).system.at(0))
    row = conditioned_trace(surfaces, (0.0, 3.0, 0.0), (0.0, 0.6, 0.8))[1]
    assert_allclose(row.slopes[4, 7], -0.6 / 1.5**2, rtol=1e-14)  # m by the index behind
    assert_allclose(row.slopes[4, 6], 0.6 / 1.5, rtol=1e-14)  # and by that before
    assert_allclose(
        row.slopes[1, :3], [0.0, 1.0, -0.75], atol=1e-14
    )  # y: a point moved along z meets the plane elsewhere
    assert_allclose(row.condition[1], 3.0, rtol=1e-14)


def test_the_condition_grows_toward_a_rim() -> None:
    # parallel light at height R sqrt(1 - e^2): the sag's slope is sqrt(1 - e^2) / e
    surfaces = surfaces_of_system(made([{"radius": 8.0, "index": 1.5}]).system.at(0))
    for part in (0.1, 1e-6):
        with mp.workdps(60):
            height = 8 * mp.sqrt(1 - mp.mpf(part) ** 2)
        row = conditioned_trace(surfaces, (0, height, 0), (0, 0, 1))[1]
        assert_allclose(row.slopes[2, 1], np.sqrt(1 - part**2) / part, rtol=1e-9)


def test_a_system_and_its_rows_are_the_same_surfaces() -> None:
    lens = made(ROWS, image={"radius": -50.0})
    for given, stacked in zip(surfaces_of(lens, 0), surfaces_of_system(lens.system.at(0)), strict=True):
        for name in ("curvature", "conic", "gap", "before", "behind", "mirror", "placement", "bends"):
            assert getattr(given, name) == getattr(stacked, name)
        assert_allclose(np.array(stacked.tilt, float), np.array(given.tilt, float), rtol=3e-16)
        terms = dict(zip(given.powers, given.coefficients, strict=True))
        assert all(terms.get(p, 0) == a for p, a in zip(stacked.powers, stacked.coefficients, strict=True))


@pytest.mark.parametrize("height", [20.0, 9.0])
def test_rows_end_with_the_course(height: float) -> None:
    lens = made([{"radius": 10.0, "index": 1.9, "thickness": 1.0}, {"thickness": 5.0}])
    rows = conditioned_trace(surfaces_of(lens, 0), (0.0, height, 0.0), (0.0, 0.0, 1.0))
    expected = reference_trace(lens, (0.0, height, 0.0), (0.0, 0.0, 1.0))
    assert [row.status for row in rows] == [row.status for row in expected]
    assert (rows[-1].status is RayStatus.MISSED) == (height == 20.0)
    assert np.isinf(rows[-1].condition).all() == (rows[-1].status is not RayStatus.OK)
