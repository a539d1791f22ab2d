"""The five reference lenses, against figures on which independent programs agree."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens

LENSES = json.loads((Path(__file__).parent.parent / "figures" / "reference_lenses.json").read_text())["lenses"]


@pytest.fixture(params=LENSES)
def case(request: pytest.FixtureRequest, designs: dict[str, Lens]) -> tuple[Lens, dict]:
    """A lens and its figures."""
    return designs[request.param], LENSES[request.param]


def test_focal_lengths(case: tuple[Lens, dict]) -> None:
    lens, figures = case
    points = lenstrace.first_order(lens)
    assert_allclose(points.focal_length, [row["focal_length"] for row in figures["first_order"]], rtol=1e-12)
    assert_allclose(points.back_focal_length, [row["back_focal_length"] for row in figures["first_order"]], rtol=1e-12)


def test_pupils(case: tuple[Lens, dict]) -> None:
    lens, figures = case
    found, expected = lenstrace.overview(lens), figures["pupils"]
    assert_allclose(found.entrance_pupil.position, expected["entrance_position"], rtol=1e-12, atol=1e-12)
    assert_allclose(found.entrance_pupil.diameter, expected["entrance_diameter"], rtol=1e-12)
    assert_allclose(found.exit_pupil.position, expected["exit_position"], rtol=1e-12)
    assert_allclose(found.exit_pupil.diameter, expected["exit_diameter"], rtol=1e-12)


def test_single_rays(case: tuple[Lens, dict]) -> None:
    lens, figures = case
    rows = figures["rays"]
    px, py = np.array([row["pupil"] for row in rows], float).T
    path = lenstrace.trace(lens, field=np.array([row["field"] for row in rows]), pupil=(px, py))
    launch, image = np.array([row["launch"] for row in rows]).T, np.array([row["image"] for row in rows]).T
    assert_allclose([path.x[0], path.y[0], path.z[0]], launch[:3], atol=1e-12)
    assert_allclose([path.l[0], path.m[0], path.n[0]], launch[3:], atol=1e-14)
    assert_allclose([path.x[-1], path.y[-1]], image[:2], atol=1e-12)
    assert_allclose([path.l[-1], path.m[-1], path.n[-1]], image[2:], atol=1e-13)
    assert_allclose(path.opl[-1], [row["opl"] for row in rows], atol=1e-12)


def test_spots(case: tuple[Lens, dict]) -> None:
    lens, figures = case
    found = lenstrace.spots(lens)
    for row in figures["spots"]:
        place = lens.fields.y.index(row["field"]), lens.wavelengths.um.index(row["um"])
        assert_allclose(found.centroid_y[place], row["centroid_y"], atol=1e-12)
        assert_allclose(found.chief_y[place], row["chief_y"], atol=1e-12)
        # the programs agree with each other to 11 digits where the spot is small
        for name in ("rms_centroid", "rms_chief", "largest"):
            assert_allclose(getattr(found, name)[place], row[name], rtol=2e-11)
    for row in figures["polychromatic"]:
        place = lens.fields.y.index(row["field"])
        assert_allclose(found.polychromatic.rms_centroid[place], row["rms_centroid"], rtol=2e-12)
        assert_allclose(found.polychromatic.rms_primary_chief[place], row["rms_primary_chief"], rtol=2e-12)
    assert not np.asarray(found.lost).any()


def test_newton_equation(case: tuple[Lens, dict]) -> None:
    lens, figures = case
    check = lenstrace.newton_check(lens)
    primary = figures["first_order"][lens.wavelengths.primary]["focal_length"]
    assert_allclose(check.expected, -(primary**2), rtol=1e-12)
    assert np.abs(check.residual).max() < 1e-12
    # real rays: the residual falls with the square of the height
    assert_allclose(check.slope, 2, atol=2e-3)
    assert np.abs(check.real_residual[-1]).max() < 1e-2
