"""What a lens is: published figures of lenses, balls and perfect surfaces, and options that cannot work."""

import math

import numpy as np
import pytest

from lenstrace import OptionError, lens, load, phenomena
from lenstrace.phenomena.lenses.cartesian_oval import oval_series
from lenstrace.plotting.demonstration import demonstration_figure


@pytest.mark.parametrize(
    "options",
    [
        {"radius_1": math.inf, "radius_2": 30.0, "thickness": 5.0},
        {"radius_1": 20.0, "radius_2": 30.0, "thickness": 8.0, "behind": 1.0},
        {"radius_1": 40.0, "radius_2": 40.0, "thickness": 60.0, "index": 2.4, "behind": 1.0},
    ],
)
def test_principal_planes_of_other_lenses(options: dict[str, float]) -> None:
    found = phenomena.principal_planes(**options)
    assert found.agrees, found
    demonstration_figure(found).canvas.draw()


def test_principal_planes_of_a_design_are_the_published_ones() -> None:
    lens = load("designs/thick_meniscus.toml")
    found = phenomena.principal_planes(lens)
    assert found.agrees
    assert len([row for row in found.rows if "Newton" in row.quantity]) == 10
    n, radius, thickness = 1.5168000345005885, 25.0, 12.0
    assert found.rows[0].measured == pytest.approx(n * radius**2 / ((n - 1) ** 2 * thickness), rel=1e-12)


@pytest.mark.parametrize(
    ("design", "why"),
    [("afocal_expander", "afocal"), ("fold_mirror", "axis is folded"), ("negative_index_slab", "afocal")],
)
def test_principal_planes_need_power_and_an_axis(design: str, why: str) -> None:
    with pytest.raises(OptionError, match=why):
        phenomena.principal_planes(load(f"designs/{design}.toml"))


def test_principal_planes_of_a_screen_that_turns_the_axis_are_refused() -> None:
    # the ideal lens turns the ray back along the axis, beside which it then runs
    rows = [
        {"thickness": 50.0, "stop": True, "screen": {"zernike": {"radius": 6.0, "terms": {7: 1e-3}}}},
        {"thickness": 50.0, "screen": {"ideal_lens": 50.0}},
    ]
    coma = lens(rows, {"entrance_pupil_diameter": 10.0}, [0.0], [0.55])
    with pytest.raises(OptionError, match="turns the axis"):
        phenomena.principal_planes(coma)


def test_principal_planes_of_a_window_are_refused() -> None:
    with pytest.raises(OptionError, match="no power"):
        phenomena.principal_planes(radius_1=math.inf, radius_2=math.inf)


def test_lensmaker_of_a_published_lens() -> None:
    # R = 50 and -50 mm, d = 10 mm, n = 1.5, by hand: 1/f = 0.5 (0.04 - 0.5 * 10 / (1.5 * 2500))
    found = phenomena.lensmaker(radius_1=50.0, radius_2=-50.0, thickness=10.0, index=1.5)
    assert found.rows[0].measured == pytest.approx(1 / (0.5 * (0.04 - 5 / 3750)), rel=1e-13)


@pytest.mark.parametrize(
    "options",
    [
        {"radius_1": math.inf},
        {"radius_1": -30.0, "radius_2": 30.0, "thickness": 1.0},
        {"radius_1": 25.0, "radius_2": 25.0, "thickness": 12.0, "surroundings": 1.333},
        {"index": 1.0, "surroundings": 1.5},
        {"radius_1": 100.0, "radius_2": 100.00001, "thickness": 1e-3},
        {"radius_1": 1.0, "radius_2": -1.0, "thickness": 500.0},
    ],
)
def test_lensmaker_agrees_elsewhere(options: dict[str, float]) -> None:
    found = phenomena.lensmaker(**options)
    assert found.agrees, found
    demonstration_figure(found).canvas.draw()


@pytest.mark.parametrize("options", [{"radius_1": math.inf, "radius_2": math.inf}, {"index": 1.0}])
def test_lensmaker_needs_power(options: dict[str, float]) -> None:
    with pytest.raises(OptionError, match="no power"):
        phenomena.lensmaker(**options)


def test_ball_of_a_published_design() -> None:
    # designs/ball_lens.toml: sapphire, 6 mm
    found = phenomena.ball_lens(index=1.7681699810656385, radius=3.0)
    assert found.rows[0].measured == pytest.approx(3.4526928114518812, rel=1e-13)
    assert found.rows[1].measured == pytest.approx(0.45269281145188116, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "where"),
    [
        ({"index": 2.0}, "behind it"),
        ({"index": 2.4, "heights": (0.999,), "aperture": 0.999}, "inside"),
        ({"index": 1.0, "surroundings": 1.333, "heights": (0.5,), "aperture": 0.5}, "in front"),
        ({"index": 1.000002, "heights": (1e-6, 0.99)}, "behind it"),
    ],
)
def test_ball_agrees_elsewhere(options: dict[str, float], where: str) -> None:
    found = phenomena.ball_lens(**options)
    assert found.agrees, found
    assert where in found.setting
    np.testing.assert_allclose(found.crossings, found.crossings_theory, rtol=1e-9)
    demonstration_figure(found).canvas.draw()


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"index": 1.5, "surroundings": 1.5}, "no power"),
        ({"index": 0.7}, "reflected totally"),
        ({"index": 0.7, "heights": (0.5,), "aperture": 0.69}, "front half"),
    ],
)
def test_ball_refuses(options: dict[str, float], why: str) -> None:
    with pytest.raises(OptionError, match=why):
        phenomena.ball_lens(**options)


def test_aplanatic_points_of_a_hemispherical_objective() -> None:
    # Born & Wolf, section 4.2.3: distances r / n and n r, magnification n^2; n = 1.5, r = 10 mm
    found = phenomena.aplanatic_points(index=1.5, radius=10.0, angles=(1e-3, 25.0, 56.0))
    assert found.agrees, found
    measured = {row.quantity: row.measured for row in found.rows}
    for angle in ("0.001", "25", "56"):
        assert measured[f"ray at {angle} deg: its image from the centre"] == pytest.approx(-15.0, rel=1e-12)
        assert measured[f"ray at {angle} deg: magnification across it"] == pytest.approx(2.25, rel=1e-12)


@pytest.mark.parametrize(
    "options",
    [
        {"index": 1.2, "surroundings": 1.5, "angles": (38.0,)},
        {"index": 1.0},
        {"index": 10.0, "angles": (84.0,), "moved": 1.0},
        {"moved": 1e-3},
    ],
)
def test_aplanatic_points_agree_elsewhere(options: dict[str, float]) -> None:
    found = phenomena.aplanatic_points(**{"angles": (10.0, 40.0), **options})
    assert found.agrees, found
    np.testing.assert_allclose(found.aberrations, found.aberrations_theory, atol=1e-8)
    demonstration_figure(found).canvas.draw()


def test_aplanatic_points_refuse_what_leaves_the_hemisphere() -> None:
    with pytest.raises(OptionError, match=r"keep all rays below 56\.31 deg"):
        phenomena.aplanatic_points(index=1.5, angles=(57.0,))


def test_cartesian_oval_is_the_one_of_the_design() -> None:
    # designs/cartesian_oval.toml, its series solved in 120 digits
    series = oval_series(100.0, 150.0, 1.5, 10)
    published = [0.02, -1.0277777777777778e-6, 7.325617283950617e-10, -2.2907771776406036e-13, 1.1774711481672001e-16]
    np.testing.assert_allclose(series[1:6], published, rtol=1e-13)
    assert series[10] == pytest.approx(-4.312555369564453e-33, rel=1e-12)
    found = phenomena.cartesian_oval(aperture=0.1)
    assert found.agrees
    assert np.nanmax(abs(found.misses)) < 1e-13 * 250


@pytest.mark.parametrize(
    "options",
    [
        {"index": 2.5, "source": 20.0, "image": 60.0, "aperture": 0.25},
        {"index": 1.1, "aperture": 0.01},
        {"index": 5.0, "source": 1.0, "image": 1e4},
        {"aperture": 1e-3},
    ],
)
def test_cartesian_oval_agrees_elsewhere(options: dict[str, float]) -> None:
    found = phenomena.cartesian_oval(**options)
    assert found.agrees, found
    demonstration_figure(found).canvas.draw()


@pytest.mark.parametrize(
    "options", [{"aperture": 0.3}, {"aperture": 0.99}, {"index": 1.1, "source": 1e4, "image": 50.0}]
)
def test_cartesian_oval_has_an_end(options: dict[str, float]) -> None:
    with pytest.raises(OptionError, match="lower aperture"):
        phenomena.cartesian_oval(**options)


def test_mirrors_have_the_crossings_of_the_closed_form() -> None:
    # R = 200 mm, i = 30 deg: R - R / (2 cos 30) = 84.5299461621 mm from the vertex
    found = phenomena.parabola_mirror(focal_length=100.0, heights=(1.0,))
    assert found.rows[0].measured == pytest.approx(100.0, rel=1e-14)
    assert found.rows[1].measured == pytest.approx(84.5299461621, rel=1e-12)
    slopes = np.diff(np.log(found.largest[1])) / np.diff(np.log(found.apertures))
    assert slopes[0] == pytest.approx(3.0, abs=1e-3)
    assert (found.largest[0] < 1e-13).all()


@pytest.mark.parametrize("aperture", [1e-3, 0.05, 1.3])
@pytest.mark.parametrize("focal_length", [1e-3, 1e6])
def test_mirrors_agree_elsewhere(focal_length: float, aperture: float) -> None:
    found = phenomena.parabola_mirror(focal_length=focal_length, aperture=aperture, heights=(1e-3, aperture))
    assert found.agrees, found


def test_achromat_of_the_catalogue() -> None:
    # SCHOTT's data sheets: N-BK7 has vd = 64.17, F2 has vd = 36.37
    found = phenomena.achromat(focal_length=100.0, crown="SCHOTT:N-BK7", flint="SCHOTT:F2")
    measured = {row.quantity: row.measured for row in found.rows}
    power = measured["singlet: difference of the powers at F and C, by that at d"]
    assert 1 / power == pytest.approx(64.17, abs=5e-3)
    assert "(V = 36.37)" in found.setting
    # about f / 2000, whatever the ordinary glasses (Kingslake)
    assert measured["doublet: secondary spectrum, f_F - f_d, to first order"] == pytest.approx(0.05, rel=0.02)


@pytest.mark.parametrize(
    ("focal_length", "crown", "flint"),
    [(-500.0, "CAF2", "N-KZFS4"), (100.0, "F2", "N-BK7"), (1e-3, "PMMA", "polycarbonate")],
)
def test_achromat_agrees_elsewhere(focal_length: float, crown: str, flint: str) -> None:
    found = phenomena.achromat(focal_length=focal_length, crown=crown, flint=flint)
    assert found.agrees, found
    np.testing.assert_allclose(found.shifts, found.shifts_theory, atol=1e-12 * abs(focal_length))


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"flint": "N-BK7"}, r"Abbe number 64\.17"),
        ({"crown": "nonsense"}, "crown must be a glass.*in no catalogue"),
        ({"flint": "air"}, "disperses light"),
        ({"flint": "germanium"}, "outside its range"),
    ],
)
def test_achromat_needs_two_glasses(options: dict[str, str], why: str) -> None:
    with pytest.raises(OptionError, match=why):
        phenomena.achromat(**options)
