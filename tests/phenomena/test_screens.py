"""The demonstrations of phase screens against published figures, at other options, and where they must refuse."""

import math

import numpy as np
import pytest

from lenstrace import OptionError, phenomena


def measured(found: object, quantity: str) -> float:
    """The first row whose quantity begins so."""
    return next(row.measured for row in found.rows if row.quantity.startswith(quantity))  # type: ignore[attr-defined]


def test_quadratic_lens_crosses_at_the_published_place() -> None:
    found = phenomena.ideal_lens(focal_length=100.0, height=10.0)
    crossing = measured(found, "ray at 10 mm: crosses it behind the quadratic")
    assert crossing == pytest.approx(99.498743710662, abs=5e-13)
    assert abs(measured(found, "ray at 10 mm: height in the focal plane")) <= 1e-12


@pytest.mark.parametrize("options", [{"focal_length": -50.0}, {"focal_length": 3.0, "height": 2.9}])
def test_lenses_of_either_sign_and_wide_ones(options: dict[str, float]) -> None:
    assert phenomena.ideal_lens(**options).agrees


def test_a_quadratic_lens_wider_than_its_focal_length_is_refused() -> None:
    with pytest.raises(OptionError, match="keep height below 5 mm"):
        phenomena.ideal_lens(focal_length=-5.0, height=5.0)


@pytest.mark.parametrize(
    "options", [{"angle": -70.0, "period": 1.0}, {"orders": 0}, {"index": 0.8}, {"wavelength": 10.0, "period": 12.0}]
)
def test_gratings(options: dict[str, float]) -> None:
    found = phenomena.grating(**options)
    assert found.agrees
    assert all(abs(row.difference) <= 1e-14 for row in found.rows)


def test_orders_that_do_not_exist_are_left_out() -> None:
    found = phenomena.grating(period=0.4, wavelength=0.55, angle=0.0, orders=3, index=1.5)
    names = [row.quantity for row in found.rows]
    assert names == [
        *(f"sine of the transmitted order {order}" for order in ("-1", "0", "+1")),
        "sine of the reflected order 0",
    ]
    assert np.isnan(found.reflected[[0, 1, 2, 4, 5, 6]]).all()


@pytest.mark.parametrize("term", [2, 66])
def test_zernike_terms(term: int) -> None:
    assert phenomena.zernike_screen(term=term, amount=-2.0, radius=3.0).agrees


def test_defocus_of_one_micrometre_turns_the_rim_as_its_derivative_says() -> None:
    """Noll's polynomial 4 is sqrt(3) (2 r^2 - 1): the RMS of its slope over the disk is sqrt(24)."""
    found = phenomena.zernike_screen(term=4, amount=1.0, radius=1.0)
    assert measured(found, "RMS of the angle") == pytest.approx(math.sqrt(24), rel=1e-12)


def test_sampling_converges_with_the_powers_of_a_cubic_spline() -> None:
    found = phenomena.sampled_screen(samples=24)
    steps = np.log(found.per_wave[-1] / found.per_wave[2])
    assert np.log(found.path_errors[2] / found.path_errors[-1]) / steps > 3.6
    assert np.log(found.slope_errors[2] / found.slope_errors[-1]) / steps > 2.7
    assert phenomena.sampled_screen(samples=4, x=-10.0, y=10.0).agrees


def test_a_finer_mirror_leaves_less() -> None:
    fine = phenomena.deformable_mirror(actuators=24)
    assert fine.agrees
    # 9 x 9 actuators leave 3e-3 - 1.5e-2 of the fourth order; the error goes with the fourth power of their distance
    assert (fine.left[fine.orders == 4] < 3e-4).all()
    assert (fine.left[fine.orders <= 3] < 1e-12).all()


def test_the_sun_turns_light_by_einsteins_angle() -> None:
    """1.75 arc seconds: Dyson, Eddington & Davidson, Phil. Trans. A 220, 291 (1920); 1.7512 with today's figures."""
    found = phenomena.point_mass(mass=5.0, offset=1.0)
    assert measured(found, "light at the rim of the Sun") == pytest.approx(1.7512, abs=5e-5)
    # at x = 1: 3 / sqrt 5, 0.32 magnitudes (Paczynski, ApJ 304, 1 (1986))
    assert measured(found, "light of both images") == pytest.approx(3 / math.sqrt(5), rel=1e-12)


@pytest.mark.parametrize("options", [{"offset": 0.01}, {"offset": 5.0, "mass": 1e12, "beyond": 1e5}, {"mass": 1e-6}])
def test_masses_and_distances_of_all_sizes(options: dict[str, float]) -> None:
    assert phenomena.point_mass(**options).agrees
