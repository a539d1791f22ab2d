"""Spots to a tolerance: against integrals in closed form, and against many more rays."""

from __future__ import annotations

import jax
import numpy as np
import pytest

import lenstrace
from lenstrace import Lens
from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.pupil_rules import open_pupil, right_half, whole_pupil
from tests.benchmarks.honesty import figures, judged

DEFOCUS = 0.5


def ideal(**row: object) -> Lens:
    """Rays that miss a parabola's focus by DEFOCUS / f times their height: r = DEFOCUS * 8 h f / (4 f^2 - h^2) / 2."""
    rows = [
        {"thickness": 100.0, "stop": True, **row},
        {"radius": -200.0, "conic": -1.0, "thickness": -100.0 + DEFOCUS, "mirror": True},
    ]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 40.0}, [0.0], [0.55])


def cone(height: np.ndarray) -> np.ndarray:
    """Distance from the axis, mm, at DEFOCUS before the focus of the parabola f = 100: tan(2 atan(h / 2f)) times it."""
    return DEFOCUS * np.tan(2 * np.arctan(height / 200))


def integral(inner: float, outer: float) -> float:
    """RMS of `cone` over an annulus of these radii."""
    square = np.linspace(inner**2, outer**2, 200_001)
    return float(np.sqrt(np.trapezoid(cone(np.sqrt(square)) ** 2, square) / (outer**2 - inner**2)))


@pytest.mark.parametrize(
    ("aperture", "inner", "outer"),
    [(None, 0.0, 20.0), ({"annulus": [6.0, 15.0]}, 6.0, 15.0), ({"obscuration": 7.3}, 7.3, 20.0)],
)
def test_a_cone_of_light(aperture: object, inner: float, outer: float) -> None:
    lens = ideal() if aperture is None else ideal(aperture=aperture)
    found = lenstrace.spots(lens, tolerance=1e-8)
    assert found.error is not None
    truth = integral(inner, outer)
    assert abs(float(found.rms_centroid[0, 0]) / truth - 1) < 1e-8
    assert abs(float(found.rms_centroid[0, 0]) - truth) <= float(found.error.rms_centroid[0, 0]) + 1e-10 * truth
    assert float(found.error.open[0, 0]) == pytest.approx((outer**2 - inner**2) / 400, abs=1e-9)
    assert float(found.largest[0, 0]) == pytest.approx(float(cone(np.array(outer))), rel=1e-9)
    assert found.error.reached
    assert not np.asarray(found.lost).any()


def test_a_rectangle_cuts_the_pupil() -> None:
    found = lenstrace.spots(ideal(aperture={"rectangle": [8.0, 30.0]}), tolerance=1e-4)
    assert found.error is not None
    x = np.linspace(-8, 8, 4001)
    top = np.sqrt(400 - x * x)
    area = np.trapezoid(2 * top, x)
    assert float(found.error.open[0, 0]) == pytest.approx(area / (np.pi * 400), abs=1e-4)
    y = np.linspace(-1, 1, 2001)[:, None] * top
    square = np.trapezoid(np.trapezoid(cone(np.hypot(x, y)) ** 2, y, axis=0), x) / area
    assert abs(float(found.rms_centroid[0, 0]) - np.sqrt(square)) < float(found.error.rms_centroid[0, 0])


def test_rules_weigh_the_open_pupil() -> None:
    for rings in (2, 5):
        for pair in (whole_pupil(rings), right_half(whole_pupil(rings))):
            half = 1 if len(pair.x) == 8 * rings**2 + 1 else 2
            for weight in (pair.first, pair.second):
                assert half * weight.sum() == pytest.approx(1)
                assert half * weight @ (pair.x**2 + pair.y**2) == pytest.approx(0.5)
                assert half * weight @ pair.y**2 == pytest.approx(0.25)
    lens = ideal(aperture={"circle": 5.0}, decenter=[3.0, 4.0])
    system, front = with_pupil(lens)
    pair = open_pupil(front, system.light, system.fields, 12)
    for weight in (pair.first, pair.second):
        assert weight.sum() == pytest.approx(1 / 16, rel=1e-4)
        assert (weight * pair.x).sum() / weight.sum() == pytest.approx(3 / 20, rel=1e-3)
        assert (weight * pair.y).sum() / weight.sum() == pytest.approx(4 / 20, rel=1e-3)


def test_estimates_are_honest() -> None:
    found = judged(["phone_lens"], 8, 1e-4)
    within, ratio = figures(found)
    assert len(found.error) > 80
    assert within >= 0.99
    assert ratio <= 20
    assert found.reached.all()


def test_symmetry_changes_nothing(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    # a tilt of 0 about y keeps the lens as it is; one of 1e-300 degrees says that it is not its own mirror image
    whole = lens.replace(surface=1, tilt=(0.0, 1e-300, 0.0))
    one, other = (lenstrace.spots(each, tolerance=1e-6) for each in (lens, whole))
    for name in ("rms_centroid", "rms_chief", "centroid_y", "largest"):
        assert np.allclose(getattr(one, name), getattr(other, name), rtol=1e-9, atol=1e-12)
    assert one.error is not None
    assert other.error is not None
    assert one.error.rings == other.error.rings


def test_float32(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    single, double = (lenstrace.spots(each, tolerance=1e-3) for each in (lens.astype("float32"), lens))
    assert single.x.dtype == np.float32
    assert single.error is not None
    apart = np.abs(np.asarray(single.rms_centroid) - np.asarray(double.rms_centroid))
    assert (apart < np.asarray(single.error.rms_centroid)).all()


def test_a_precision_that_cannot_reach_the_tolerance_says_so(designs: dict[str, Lens]) -> None:
    lens = designs["hubble"]
    single, double = (lenstrace.spots(each, tolerance=1e-3) for each in (lens.astype("float32"), lens))
    assert single.error is not None
    assert double.error is not None
    assert double.error.reached
    assert not single.error.reached
    assert single.error.rounded
    estimate = np.asarray(single.error.rms_centroid)
    assert (estimate / single.rms_centroid > 1e-3).any()
    assert (np.abs(np.asarray(single.rms_centroid) - np.asarray(double.rms_centroid)) < estimate).all()


def test_several_openings_on_a_spoke_lose_no_rays() -> None:
    rows = [
        {"thickness": 50.0, "stop": True, "aperture": {"obscuration": 5.0}},
        {"thickness": 50.0, "aperture": {"obscuration": 3.0}, "decenter": [0.0, 12.0]},
        {"radius": -200.0, "conic": -1.0, "thickness": -100.0 + DEFOCUS, "mirror": True},
    ]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 40.0}, [0.0], [0.55])
    # the square of `cone` over the disk without the two circles
    parts = [(0.0, 0.0, 20.0, 1), (0.0, 0.0, 5.0, -1), (0.0, 12.0, 3.0, -1)]
    square = sum(sign * disk_integral(x, y, r) for x, y, r, sign in parts) / (np.pi * (400 - 34))
    centre = sum(sign * disk_integral(x, y, r, first=True) for x, y, r, sign in parts) / (np.pi * (400 - 34))
    truth = np.sqrt(square - centre**2)
    for tolerance, part in ((1e-2, 0.03), (1e-4, 1e-3)):
        found = lenstrace.spots(lens, tolerance=tolerance)
        assert found.error is not None
        assert not np.asarray(found.lost).any()
        assert float(found.error.open[0, 0]) == pytest.approx(1 - (5**2 + 3**2) / 400, abs=part)
        assert abs(float(found.rms_centroid[0, 0]) - truth) < float(found.error.rms_centroid[0, 0])


def test_a_thin_ring_that_is_not_centred() -> None:
    first = {"thickness": 50.0, "stop": True}
    ring = {"thickness": 50.0, "aperture": {"annulus": [9.4, 9.5]}, "decenter": [0.0, 2.0]}
    mirror = {"radius": -200.0, "conic": -1.0, "thickness": -100.0 + DEFOCUS, "mirror": True}
    lens = lenstrace.lens([first, ring, mirror], {"entrance_pupil_diameter": 40.0}, [0.0], [0.55])
    area = np.pi * (9.5**2 - 9.4**2)
    square, centre = (
        (disk_integral(0.0, 2.0, 9.5, first=about) - disk_integral(0.0, 2.0, 9.4, first=about)) / area
        for about in (False, True)
    )
    found = lenstrace.spots(lens, tolerance=1e-2)
    assert found.error is not None
    assert abs(float(found.rms_centroid[0, 0]) - np.sqrt(square - centre**2)) < float(found.error.rms_centroid[0, 0])
    assert found.error.reached
    assert float(found.error.open[0, 0]) == pytest.approx(area / (np.pi * 400), rel=1e-2)


def disk_integral(x: float, y: float, radius: float, *, first: bool = False) -> float:
    """Over a disk of the pupil, mm: of `cone` squared, or of its component along y."""
    r, weight = np.polynomial.legendre.leggauss(64)
    r = np.sqrt((1 + r) / 2)[:, None] * radius
    turn = 2 * np.pi * np.arange(256) / 256
    height = np.hypot(x + r * np.cos(turn), y + r * np.sin(turn))
    value = cone(height) * ((y + r * np.sin(turn)) / height if first else cone(height))
    return float(np.pi * radius**2 * (weight / 2) @ value.mean(1))


def test_what_cannot_be_asked(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    with pytest.raises(lenstrace.RayError, match="chooses the rays by itself"):
        lenstrace.spots(lens, tolerance=1e-3, rings=4)
    with pytest.raises(lenstrace.AccuracyError, match="positive number"):
        lenstrace.spots(lens, tolerance=0.0)
    with pytest.raises(lenstrace.AccuracyError, match="JAX is tracing"):
        jax.eval_shape(lambda c: lenstrace.spots(lens.replace(curvature=c), tolerance=1e-3), lens.curvature)
    closed = ideal(aperture={"obscuration": 30.0})
    with pytest.raises(lenstrace.LostRaysError, match="no opening of the pupil was found"):
        lenstrace.spots(closed, tolerance=1e-3)


def test_gaussian_rings_from_a_tolerance_can_be_differentiated(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    found = lenstrace.spots(lens, tolerance=1e-6)
    assert found.error is not None
    rings = found.error.rings
    same = lenstrace.spots(lens, pattern="gaussian", rings=rings)
    assert np.allclose(same.polychromatic.rms_centroid, found.polychromatic.rms_centroid, rtol=1e-6)
    squares = lenstrace.mean_square_spot(lens, pattern="gaussian", rings=rings)
    assert np.allclose(np.sqrt(squares), same.polychromatic.rms_centroid, rtol=1e-12)


@pytest.mark.parametrize(
    "screen",
    [
        {"grating": {"period": 0.05}},
        {"zernike": {"radius": 20.0, "terms": {8: 0.002, 5: 0.001}}},
        {"ideal_lens": 1000.0},
    ],
)
def test_a_phase_screen_with_sides_is_seen_whole(screen: dict[str, object]) -> None:
    """What sends light to +x is no mirror image of itself: half a pupil would put its centroid on the axis."""
    lens = ideal(screen=screen)
    fine, whole = lenstrace.spots(lens, tolerance=1e-6), lenstrace.spots(lens, pattern="gaussian", rings=12)
    for figure in ("centroid_x", "centroid_y", "rms_centroid"):
        assert np.allclose(getattr(fine, figure), getattr(whole, figure), rtol=2e-6, atol=1e-9), figure
