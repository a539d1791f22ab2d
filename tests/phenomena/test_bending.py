"""Bending at a surface, prisms and rainbows against published figures; other options, limits, bad combinations."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lenstrace import OptionError, phenomena
from lenstrace.phenomena.demonstration import Demonstration
from lenstrace.phenomena.drop import spread


def measured(found: Demonstration, quantity: str) -> float:
    """What was measured of a quantity, given in full."""
    return next(row.measured for row in found.rows if row.quantity == quantity)


def test_snell_at_30_degrees_into_glass() -> None:
    found = phenomena.snell()
    parts = [measured(found, f"its direction: {where} the surface") for where in ("along", "across")]
    assert_allclose(parts, [1 / 3, -0.942809041582063], atol=1e-15)
    assert_allclose(measured(found, "its direction: length"), 1, atol=1e-15)


@pytest.mark.parametrize("angle", [0.0, 1e-6, 41.8103148957, 41.810314895778596, 60.0, 89.9])
@pytest.mark.parametrize(("before", "index"), [(1.5, 1.0), (1.0, 1.0), (10.0, -0.1), (0.1, 10.0)])
def test_snell_agrees_everywhere(angle: float, before: float, index: float) -> None:
    found = phenomena.snell(angle=angle, index=index, index_before=before)
    assert found.agrees, found
    assert (found.refracted is None) == ("reflected totally" in found.setting)


def test_snell_refuses_an_index_that_is_nearly_0() -> None:
    with pytest.raises(OptionError, match=r"from 0\.1 to 10 or from -10 to -0\.1, got 0\.01"):
        phenomena.snell(index=0.01)


def test_critical_angle_of_glass() -> None:
    assert_allclose(measured(phenomena.critical_angle(), "critical angle"), 41.8103148958, atol=5e-11)


@pytest.mark.parametrize(("index", "outside"), [(5.0, 1.0), (5.0, 4.95), (1.01, 1.0), (1.51, 1.33)])
def test_critical_angle_agrees_elsewhere(index: float, outside: float) -> None:
    found = phenomena.critical_angle(index=index, index_outside=outside)
    assert found.agrees, found


def test_light_in_the_thinner_medium_is_never_reflected_totally() -> None:
    for outside in (1.5, 2.0):
        with pytest.raises(OptionError, match=r"make index at least 1\.01 times index_outside, got 1\.5 and"):
            phenomena.critical_angle(index_outside=outside)


def test_brewster_of_glass() -> None:
    found = phenomena.brewster()
    assert_allclose(measured(found, "Brewster's angle"), 56.309932474, atol=5e-10)
    assert_allclose(measured(found, "at 45 deg: R_s"), 0.0920133630455, atol=5e-14)
    assert_allclose(measured(found, "at 45 deg: R_p"), 0.00846645897895, atol=5e-15)
    assert_allclose(measured(found, "light from all sides, outside: R"), 0.0917779593424, atol=5e-14)


@pytest.mark.parametrize(("index", "angle"), [(1.05, 0.0), (5.0, 89.9), (1.333, 53.1)])
def test_brewster_agrees_elsewhere(index: float, angle: float) -> None:
    found = phenomena.brewster(index=index, angle=angle)
    assert found.agrees, found


def test_prism_of_60_degrees() -> None:
    found = phenomena.prism()
    assert_allclose(measured(found, "least deviation"), 37.1807557815, atol=5e-11)
    assert_allclose(measured(found, "angle there inside, to the first normal"), 30, atol=1e-12)
    # SCHOTT's F2: n = 1.62004, 1.63208, 1.61503 at the lines d, F, C; D = 2 arcsin(n / 2) - 60
    assert_allclose(measured(found, "F2: least deviation of the d line"), 48.1956, atol=2e-3)
    # violet is bent more than red, and the ends of the spectrum are violet and red
    assert (np.diff(found.deviation[40, 1:]) < 0).all()
    red, green, blue = found.colours[[10, 25, 45]].argmax(1)
    assert (red, green, blue) == (2, 1, 0)


@pytest.mark.parametrize(
    "options",
    [
        {"apex": 1.0, "glass": "WATER"},
        {"apex": 23.5, "index": 4.9},
        {"apex": 66.0, "index": 1.05},
        {"apex": 70.0, "index": 1.743, "glass": "CAF2"},
        {"apex": 40.0, "glass": "DIAMOND"},
    ],
)
def test_prism_agrees_elsewhere(options: dict[str, Any]) -> None:
    found = phenomena.prism(**options)
    assert found.agrees, found


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"glass": "DIAMOND"}, r"no ray passes a prism of DIAMOND .* keep it below 48\.86"),
        ({"index": 2.1}, r"no ray passes a prism of the index 2\.1 .* keep it below 56\.87"),
        ({"apex": 75.5}, "some colours are reflected totally; make the apex angle smaller"),
    ],
)
def test_prism_that_passes_no_light_is_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(OptionError, match=message):
        phenomena.prism(**options)


def test_rainbow_of_water() -> None:
    found = phenomena.rainbow()
    assert_allclose(measured(found, "primary bow"), 42.0781, atol=5e-5)
    assert_allclose(measured(found, "secondary bow"), 50.8908, atol=5e-5)
    # Descartes, Les Meteores (1637), n = 250 / 187: 41 deg 30 min and 51 deg 54 min from the middle of the sun
    descartes = phenomena.rainbow(index=250 / 187)
    assert_allclose(measured(descartes, "primary bow"), 41 + 30 / 60, atol=0.02)
    assert_allclose(measured(descartes, "secondary bow"), 51 + 54 / 60, atol=0.02)


def test_the_sky_of_the_rainbow() -> None:
    found = phenomena.rainbow()
    angles, light = np.degrees(found.angles), found.luminance
    within, beyond = light[angles < 40].mean(), light[angles > 54].mean()
    dark = light[(angles > 43) & (angles < 49.5)]
    assert within > 3 * beyond > 6 * dark.max()
    # what the outside of a drop of n = 1.333 reflects at 67 degrees, half way between
    assert_allclose(dark.mean(), 0.0207, atol=5e-4)
    # red is outside in the primary, inside in the secondary
    for low in (42.2, 50.6):
        red, _, blue = found.colours[(angles > low) & (angles < low + 0.2)].mean(0)
        assert red > 3 * blue


def test_light_is_spread_over_the_sky_as_by_a_ball_that_mirrors() -> None:
    # evenly: ds/dO = 1 / 4 everywhere, however the rays are chosen
    inward = 0.6 * np.linspace(1, 0, 300) ** 2
    impacts = np.array([[*inward, *np.linspace(0.6, 1, 300)]] * 2)
    part = np.array([[1.0], [0.0]]) * np.ones_like(impacts)
    edges = np.radians(np.linspace(5, 150, 30))
    assert_allclose(spread(edges, 2 * np.arcsin(impacts), part, impacts), 1, atol=2e-3)


@pytest.mark.parametrize("options", [{"index": 1.25}, {"index": 1.9}, {"sun": 0.05}, {"sun": 5.0}])
def test_rainbow_agrees_elsewhere(options: dict[str, float]) -> None:
    found = phenomena.rainbow(**options)
    assert found.agrees, found
    assert np.isfinite(found.colours).all()
    assert len(found.angles) == len(found.luminance) == len(found.colours)
