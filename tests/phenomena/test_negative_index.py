"""Slabs, prisms and lenses of negative index against published closed forms, and figures computed elsewhere."""

import numpy as np
import pytest

from lenstrace import OptionError, phenomena


def test_slab_of_another_index_has_the_crossings_of_the_closed_form() -> None:
    found = phenomena.slab(index=-1.1, source=1.0, thickness=2.0, angles=(0.0, 30.0, 60.0, 80.0))
    crossings = [row.measured for row in found.rows if "crosses the axis behind" in row.quantity]
    published = [0.818181818182, 0.767766952966, 0.474419561549, -0.291311159665]
    np.testing.assert_allclose(crossings[:4], published, rtol=0, atol=6e-13)


@pytest.mark.parametrize(
    ("options", "image"),
    [
        ({"index": -1.6, "surroundings": 1.5}, "a real image"),
        ({"source": 2.0}, "its image on the back face"),
        ({"source": 5.0}, "no real image"),
        ({"index": -0.1, "surroundings": 10.0, "aperture": 0.0099, "angles": (0.0,)}, "a real image"),
        ({"index": -10.0, "surroundings": 0.1, "angles": (0.0,)}, "no real image"),
    ],
)
def test_slab_agrees_with_theory_elsewhere(options: dict[str, float], image: str) -> None:
    found = phenomena.slab(**options)
    assert found.agrees, found
    assert image in found.setting


def test_spot_of_a_perfect_slab() -> None:
    found = phenomena.slab(source=0.7, thickness=2.0, aperture=0.98)
    assert abs(found.rows[-1].measured) <= 1e-14 * 2.0
    np.testing.assert_allclose(found.spots[:, 4:], found.spots_theory[:, 4:], rtol=1e-6)


def test_total_reflection_is_refused() -> None:
    with pytest.raises(OptionError, match=r"reflected totally at the index -0\.5; keep all rays below 30 deg"):
        phenomena.slab(index=-0.5)


def test_the_wedge_of_the_first_experiment() -> None:
    """Shelby, Smith & Schultz, Science 292, 77 (2001): from a wedge of 18.43 deg light leaves at -61 deg."""
    found = phenomena.negative_prism(incidence=0.0)
    leaving = next(row.measured for row in found.rows if row.quantity == "n = -2.7: behind, from the normal")
    assert leaving == pytest.approx(-61, abs=4)
    assert phenomena.negative_prism(index=-1.0, apex=30.0, incidence=10.0).agrees


@pytest.mark.parametrize(
    "options",
    [
        {"index": -10.0, "surroundings": 0.1, "apex": 0.01, "incidence": -60.0},
        {"index": -10.0, "surroundings": 0.1, "apex": 1e-9, "incidence": 30.0},
        {"index": -0.1, "surroundings": 0.1, "apex": 89.0, "incidence": 60.0},
    ],
)
def test_prism_agrees_at_the_ends_of_its_options(options: dict[str, float]) -> None:
    found = phenomena.negative_prism(**options)
    assert found.agrees, found


def test_a_prism_that_only_a_negative_index_passes_is_drawn_alone() -> None:
    found = phenomena.negative_prism(incidence=20.0)
    assert found.agrees
    assert found.ray_z.shape == (4, 1)
    assert "does not let through" in found.setting


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"incidence": -20.0}, "the back face reflects it totally"),
        ({"index": -0.5, "incidence": 30.0}, "the front face reflects it totally at 30 deg"),
        ({"index": -1.0, "incidence": -30.0, "apex": 80.0}, "runs away from the back face"),
    ],
)
def test_prisms_that_let_no_light_through_are_refused(options: dict[str, float], why: str) -> None:
    with pytest.raises(OptionError, match=f"^negative-prism: no light passes at the index .*{why}"):
        phenomena.negative_prism(**options)


@pytest.mark.parametrize(
    "options", [{}, {"index": -1.7, "surroundings": 1.33, "height": 0.6}, {"positive": 1.2}, {"height": 0.99}]
)
def test_a_hollow_lens_of_negative_index_focuses(options: dict[str, float]) -> None:
    found = phenomena.negative_lens(radius=100.0, **options)
    assert found.agrees, found
    assert found.focal_length > 0
    assert found.rows[0].measured == pytest.approx(found.focal_length, rel=1e-12)


def test_focal_length_of_minus_one_is_half_the_radius() -> None:
    found = phenomena.negative_lens(index=-1.0, radius=30.0)
    assert found.rows[0].measured == pytest.approx(15.0, rel=1e-14)
    inner, outer = (abs(found.crossings[place, -1] - 15.0) for place in (0, 1))
    assert inner < outer / 5


def test_lenses_that_cannot_be_are_refused() -> None:
    with pytest.raises(OptionError, match=r"rays beyond 0\.5 of the radius are reflected totally"):
        phenomena.negative_lens(index=-2.0, height=0.6)
    with pytest.raises(OptionError, match="has no power"):
        phenomena.negative_lens(positive=1.0)


@pytest.mark.parametrize(
    "options", [{"angle": 0.0}, {"index": -1.0, "angle": 80.0}, {"index": 1.5}, {"index": -0.9, "surroundings": 1.5}]
)
def test_phase_goes_back_where_the_index_is_negative(options: dict[str, float]) -> None:
    found = phenomena.negative_waves(**options)
    assert found.agrees, found
    forward = found.ray_z[2, 0] > found.ray_z[1, 0]
    assert forward
    assert (found.back[0] < 0) == (options.get("index", -1.5) < 0)


def test_wavefronts_are_a_wavelength_apart_and_do_not_break_at_the_surface() -> None:
    found = phenomena.negative_waves(index=-2.0, angle=40.0)
    before, inside = found.front_z[0], found.front_z[1]
    z, y = found.front_z[1], found.front_y[1]
    seen = np.isfinite(z).all(1)
    step = np.diff(np.stack([z[seen], y[seen]]), axis=1)
    assert np.abs(np.einsum("cwn,c->wn", step, found.back)).max() == pytest.approx(0.5, rel=1e-12)
    assert np.isfinite(before).any()
    assert np.isfinite(inside).any()


def test_waves_that_are_reflected_totally_are_refused() -> None:
    with pytest.raises(OptionError, match="keep angle below 30 deg"):
        phenomena.negative_waves(index=-0.5, angle=45.0)
