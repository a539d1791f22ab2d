"""Demonstrations of graded media against published figures, with other options and at their limits."""

import math

import numpy as np
import pytest

from lenstrace import OptionError, phenomena


def measured(found, quantity: str) -> float:
    return next(row.measured for row in found.rows if quantity in row.quantity)


def test_luneburg_focuses_on_its_surface_to_1e_8_of_its_radius() -> None:
    found = phenomena.luneburg(radius=10.0, aperture=0.98, angle=-35.0)
    assert measured(found, "farthest ray from the focus") < 1e-8 * 10
    for which in ("shortest", "longest"):
        np.testing.assert_allclose(measured(found, f"{which} optical path"), 25.707963267948966, rtol=1e-9)
    np.testing.assert_allclose(found.focus, [10 * math.cos(math.radians(35)), -10 * math.sin(math.radians(35))])


@pytest.mark.parametrize(
    "options",
    [
        {"angle": 180.0, "rays": 2, "radius": 1e-3, "aperture": 0.999},
        {"angle": -100.0, "radius": 1e6, "aperture": 1e-9},
        {"tolerance": 1e-6},
        {"tolerance": 1e-13},
    ],
)
def test_luneburg_elsewhere(options: dict[str, float]) -> None:
    found = phenomena.luneburg(**options)
    assert found.agrees, found


def test_fish_eye_images_every_point_to_its_inverse() -> None:
    for source in (0.3, 1.0, 2.0):
        found = phenomena.fish_eye(source=source, radius=10.0, index=2.0, rays=3)
        assert found.agrees, found
        assert measured(found, "farthest ray from the image") < 1e-8 * 10
        np.testing.assert_allclose(measured(found, "distance of the image"), 10 / source, rtol=1e-9)
        np.testing.assert_allclose(measured(found, "longest optical path"), 31.41592653589793, rtol=1e-9)


@pytest.mark.parametrize(
    "options",
    [
        {"source": 0.2, "spread": 1e-9, "rays": 1},
        {"source": 5.0, "spread": 120.0, "rays": 1, "index": 10.0, "radius": 1e6},
        {"source": 1.0, "tolerance": 1e-6, "index": 0.1, "radius": 1e-3},
        {"source": 0.2, "spread": 120.0, "rays": 50, "index": 0.1},
    ],
)
def test_fish_eye_elsewhere(options: dict[str, float]) -> None:
    found = phenomena.fish_eye(**options)
    assert found.agrees, found


def test_errors_follow_the_tolerance() -> None:
    for found in (phenomena.luneburg(rays=3), phenomena.fish_eye(rays=2)):
        cost = found.cost()
        assert cost.errors[-1] < 1e-11
        assert cost.errors[0] > 1e-5
        assert cost.calls[-1] > 2 * cost.calls[0]


def test_a_mirage_is_upside_down() -> None:
    found = phenomena.mirage()
    assert 0 < found.inverted.argmin() < len(found.angles)
    assert found.inverted[0]
    assert not found.inverted[-1]
    np.testing.assert_allclose(found.heights, found.heights_theory, rtol=0, atol=1e-9)
    # a ray grazes the road under the square root of how much less n^2 is there: 0.3945 deg for 60 and 30 deg Celsius
    assert math.degrees(-found.angles[0]) == pytest.approx(0.3945, abs=1e-4)


@pytest.mark.parametrize(
    "options",
    [
        {"layer": 0.02, "eye": 10.0, "road": 200.0, "air": -50.0, "angles": (1e-3, 0.9), "distance": 1e4},
        {"layer": 0.02, "eye": 10.0, "angles": (1e-3,), "distance": 1e4, "tolerance": 1e-9},
        {"layer": 5.0, "eye": 0.1, "road": 30.1, "angles": (1e-3,), "distance": 1e4},
        {"tolerance": 1e-9},
    ],
)
def test_mirages_elsewhere(options: dict) -> None:
    found = phenomena.mirage(**options)
    assert found.agrees, found


@pytest.mark.parametrize(
    "options",
    [
        {"layer": 5.0, "angles": (0.1,), "distance": 1000.0},
        {"layer": 5.0, "eye": 5.0, "road": 200.0, "air": -50.0, "angles": (1e-3, 1.0), "distance": 600.0},
        {"layer": 0.5, "eye": 0.1, "angles": (0.05,), "distance": 200.0, "tolerance": 1e-9},
    ],
)
def test_in_a_linear_profile_nothing_is_seen_above_the_layer(options: dict) -> None:
    found = phenomena.mirage(profile="linear", **options)
    assert found.agrees, found
    assert (found.heights <= options["layer"]).all()
    assert (found.ray_y <= options["layer"]).all()
    # all parabolas are one, shifted: nothing is upside down
    assert not found.inverted.any()


@pytest.mark.parametrize(
    ("name", "tolerance", "size"), [("luneburg", 1e-6, 20.0), ("fish_eye", 1e-6, 45.0), ("mirage", 1e-9, 1e-3)]
)
def test_with_the_largest_tolerance_a_row_can_still_fail(name: str, tolerance: float, size: float) -> None:
    found = getattr(phenomena, name)(tolerance=tolerance)
    assert found.agrees, found
    for row in found.rows:
        assert row.within < 1e-3 * max(abs(row.theory), size), row.quantity


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"profile": "linear"}, r"the eye must be within the layer, got eye 1\.5 m and layer 0\.1 m; raise"),
        (
            {"profile": "linear", "layer": 0.5, "eye": 0.5, "angles": (0.05,), "distance": 2000.0},
            r"an object 2000 m away is seen only above the layer of 0\.5 m; put it nearer",
        ),
        ({"road": 20.0}, "the road must be warmer than the air, got 20 and 30"),
        ({"angles": (0.1, 0.5)}, r"the ray at 0\.5 deg ends on the road; keep all below 0\.3945"),
        ({"distance": 100.0}, "no ray is bent upward before the object 100 m away; put it farther than 238"),
    ],
)
def test_mirages_that_are_none_are_refused(options: dict, words: str) -> None:
    with pytest.raises(OptionError, match=words):
        phenomena.mirage(**options)
