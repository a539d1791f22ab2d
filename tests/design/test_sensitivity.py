"""Sensitivities against lenses that really have the errors."""

from __future__ import annotations

import numpy as np
import pytest

import lenstrace
from lenstrace import Lens
from lenstrace.design import Sensitivities, Tolerances, sensitivity

SMALL = Tolerances(radius=1e-4, flatness=1e-9, thickness=2e-3, decenter=2e-3, tilt=2e-3, index=2e-5, abbe=1e-3)


@pytest.fixture(scope="module")
def lens(designs: dict[str, Lens]) -> Lens:
    """The triplet in catalogue glasses."""
    lens = designs["cooke_triplet"]
    for surface, glass in ((1, "HIKARI:SK16"), (3, "SCHOTT:F2"), (5, "HIKARI:SK16")):
        lens = lens.replace(surface=surface, glass=glass)
    return lens


@pytest.fixture(scope="module")
def found(lens: Lens) -> Sensitivities:
    return sensitivity(lens, SMALL, refocus=False)


def spots(lens: Lens) -> np.ndarray:
    return np.asarray(lenstrace.spots(lens).polychromatic.rms_centroid)


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("radius 4", lambda lens, sign: (4, {"radius": lens[4].radius * (1 + sign * 1e-4)})),
        ("thickness 3", lambda lens, sign: (3, {"thickness": lens[3].thickness + sign * 2e-3})),
        ("decenter y of 3", lambda _, sign: (3, {"decenter": (0.0, sign * 2e-3)})),
        ("tilt x of 5", lambda _, sign: (5, {"tilt": (sign * 2e-3, 0.0, 0.0)})),
    ],
)
def test_the_change_is_that_of_a_lens_with_the_error(
    lens: Lens, found: Sensitivities, name: str, changes: object
) -> None:
    worse, primary = [], lens.wavelengths.primary
    for sign in (1, -1):
        surface, change = changes(lens, sign)  # type: ignore[operator]
        wrong = lens.replace(surface=surface, **change)
        worse.append(spots(wrong) - spots(lens))
        if sign == 1:
            first, nominal = (float(lenstrace.first_order(each).focal_length[primary]) for each in (wrong, lens))
    row = next(row for row in found.rows if row.name == name)
    assert row.spots == pytest.approx(np.max(worse, 0), rel=2e-2, abs=1e-8)
    assert row.focal_length == pytest.approx(first - nominal, rel=2e-3, abs=1e-9)


def test_what_apertures_stop_does_not_count(designs: dict[str, Lens]) -> None:
    hubble = designs["hubble"]
    centred = Tolerances(decenter=0.0, tilt=0.0)
    assert sensitivity(hubble, centred, rings=3).spots == pytest.approx(
        np.asarray(lenstrace.spots(hubble, rings=3).polychromatic.rms_centroid), rel=1e-6
    )


def test_the_index_of_a_glass(lens: Lens, found: Sensitivities) -> None:
    """Against the derivative of a lens whose glass is given by its three indices, all larger by the error."""
    um = lens.wavelengths.um
    n = [float(lens[3].medium.index(each)) + 2e-5 for each in um]
    wrong = lens.replace(surface=3, index={"um": list(um), "n": n})
    primary = lens.wavelengths.primary
    change = float(
        lenstrace.first_order(wrong).focal_length[primary] - lenstrace.first_order(lens).focal_length[primary]
    )
    row = next(row for row in found.rows if row.name == "index 3")
    assert row.focal_length == pytest.approx(change, rel=1e-3)
    abbe = next(row for row in found.rows if row.name == "Abbe number 3")
    assert abbe.focal_length == pytest.approx(0.0, abs=1e-9)
    assert abbe.worst > 0


def test_all_together_and_the_nominal_lens(lens: Lens, found: Sensitivities) -> None:
    assert found.spots == pytest.approx(spots(lens), rel=1e-9)
    assert np.all(found.expected_spots >= found.spots)
    root = np.sqrt(sum(row.focal_length**2 for row in found.rows))
    assert found.expected_focal_length == pytest.approx(root, rel=1e-12)
    assert [row.worst for row in found.rows] == sorted((row.worst for row in found.rows), reverse=True)


def test_the_image_surface_is_refocused(lens: Lens, found: Sensitivities) -> None:
    """An error of the last gap but one moves the image; refocused, most of what it does is gone."""
    again = sensitivity(lens, SMALL)
    shift, refocused = (next(row for row in each.rows if row.name == "thickness 4") for each in (found, again))
    assert refocused.worst < 0.2 * shift.worst
    assert np.all(again.expected_spots <= found.expected_spots + 1e-15)
