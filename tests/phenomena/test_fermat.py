"""Fermat's principle on single surfaces with known second derivatives, past foci, and on published lenses."""

from pathlib import Path

import numpy as np
import pytest

import lenstrace
from lenstrace import Lens, OptionError, phenomena

DESIGNS = Path(__file__).parents[2] / "designs"


def lens_of(*rows: dict, distance: float = float("inf")) -> Lens:
    """Its first row is the stop."""
    return lenstrace.lens(
        [{**rows[0], "stop": True}, *rows[1:]], {"entrance_pupil_diameter": 2.0}, [0.0], [0.5], object_distance=distance
    )


def measured(found, quantity: str) -> list[float]:
    return [row.measured for row in found.rows if quantity in row.quantity]


def test_a_mirror_between_two_points_of_its_axis() -> None:
    """The path is longer than its neighbours where the points lie beyond the centre of curvature: 2/s - 2/R < 0."""
    for distance, negative in ((30.0, 0), (80.0, 2)):
        mirror = lens_of({"radius": -50.0, "thickness": -distance, "mirror": True}, distance=distance)
        found = phenomena.fermat(mirror, field=0.0, pupil=0.0, end=1.0)
        assert found.agrees, found
        np.testing.assert_allclose(measured(found, "second derivative"), [2 / distance - 2 / 50] * 2, rtol=1e-13)
        assert measured(found, "maximum") == [negative]
        assert ("a maximum" if negative else "a minimum") in found.setting


def test_a_plane_between_two_media() -> None:
    plane = lens_of({"thickness": 30.0, "index": 1.5}, distance=20.0)
    found = phenomena.fermat(plane, field=0.0, pupil=0.0, end=1.0)
    np.testing.assert_allclose(measured(found, "second derivative"), [1 / 20 + 1.5 / 30] * 2, rtol=1e-14)


def test_a_path_is_a_minimum_up_to_its_focus() -> None:
    before, behind = phenomena.fermat(end=0.7), phenomena.fermat(end=1.5)
    assert before.agrees
    assert behind.agrees
    assert measured(before, "maximum") == [0]
    assert measured(behind, "maximum") == [2]
    assert (before.waves >= 0).all()
    assert (behind.waves[-1, [0, -1]] < 0).all()
    np.testing.assert_allclose(before.waves, before.waves_theory, rtol=0, atol=2e-2 * before.waves.max())


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("double_gauss", {"pupil": -0.9}),
        ("fold_mirror", {"end": 1.5}),
        ("phone_lens", {}),
        ("hubble", {"field": 0.5}),
        ("negative_index_slab", {"end": 1.7}),
    ],
)
def test_published_lenses(name: str, options: dict[str, float]) -> None:
    found = phenomena.fermat(lenstrace.load(DESIGNS / f"{name}.toml"), **options)
    assert found.agrees, found
    assert abs(measured(found, "largest derivative")[0]) < 1e-12


@pytest.mark.parametrize(
    ("lens", "options", "words"),
    [
        (lens_of({"thickness": 10.0}), {}, "no surface of this lens bends light"),
        (lens_of({"radius": 50, "thickness": 5, "index": 1.5, "tilt": [0, 5, 0]}), {}, "leaves the y-z plane"),
        (lens_of({"radius": 9, "thickness": 5, "index": 1.5, "aperture": {"circle": 0.5}}), {}, "clipped"),
        (lens_of({"thickness": 0.0, "index": 1.5}, {"radius": 9.0, "thickness": 9.0}), {"pupil": 0.0}, "touch"),
        (
            lens_of({"radius": -50.0, "thickness": -50.0, "mirror": True}, distance=50.0),
            {"end": 1.0, "pupil": 0.0},
            "on a focus; choose another end",
        ),
    ],
)
def test_paths_that_are_none_are_refused(lens: Lens, options: dict[str, float], words: str) -> None:
    with pytest.raises(OptionError, match=words):
        phenomena.fermat(lens, **options)
