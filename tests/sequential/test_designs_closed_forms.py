"""What each prescription in designs/ is there to show, beyond first order: real rays against closed forms, and against
single rays of other programs."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens, Ray

PUPIL = np.array([0.0, 0.0, 1.0, -0.5, 0.3]), np.array([0.0, 1.0, 0.0, 0.5, -0.6])
UP = 0.0, 1.0


def crossing(path: Ray, surface: int) -> float:
    """Where a meridional ray crosses the axis behind a surface, mm from its vertex."""
    return float(path.z[surface] - path.y[surface] * path.n[surface] / path.m[surface])


def from_object(lens: Lens, path: Ray) -> np.ndarray:
    """Optical path from the axial object point to the image."""
    z = np.asarray(path.z[0]) + lens.object_distance
    index = float(lens.system.index[lens.wavelengths.primary, 0])
    return np.asarray(path.opl[-1]) + index * np.sqrt(path.x[0] ** 2 + path.y[0] ** 2 + z**2)


def test_plane_first_crosses_where_one_refraction_sends_it(designs: dict[str, Lens]) -> None:
    lens = designs["plano_convex_plane_first"]
    n, radius, h = lenstrace.glass("N-BK7").index(0.633), 51.5, 9.0
    inside, outside = np.arcsin(h / radius), np.arcsin(n * h / radius)
    expected = radius * np.sin(outside) / np.sin(outside - inside) - radius
    assert_allclose(crossing(lenstrace.trace(lens, pupil=(0.0, h / 10)), 2), expected, rtol=1e-14)


def test_spherical_aberration_of_the_two_ways_round(designs: dict[str, Lens]) -> None:
    # Jenkins & White, Fundamentals of optics, chapter 9: a thin lens, shape factor q, the object at infinity
    n = lenstrace.glass("N-BK7").index(0.633)
    expected = [(n + 2) / (n - 1) - q * 4 * (n + 1) + (3 * n + 2) * (n - 1) + n**3 / (n - 1) for q in (1, -1)]
    aberration = []
    for name in ("plano_convex_curved_first", "plano_convex_plane_first"):
        thin = designs[name].replace(surface=1, thickness=1e-6)
        path = lenstrace.trace(thin, pupil=(0.0, 0.05))
        aberration.append(crossing(path, 2) - lenstrace.first_order(thin).back_focal_length[1])
    assert_allclose(aberration[0] / aberration[1], expected[0] / expected[1], rtol=5e-4)


def test_ball_bends_a_ray_twice_by_the_same_angle(designs: dict[str, Lens]) -> None:
    lens = designs["ball_lens"]
    for um in lens.wavelengths.um:
        n = lenstrace.glass("SAPPHIRE").index(um)
        deviation = 2 * (np.arcsin(1 / 3) - np.arcsin(1 / (3 * n)))
        # the ray is as far from the centre behind the ball as before it
        path = lenstrace.trace(lens, pupil=UP, wavelength=um)
        assert_allclose(crossing(path, 3) + 3, 1 / np.sin(deviation), rtol=1e-14)
    chief = lenstrace.trace(lens, field=40.0)
    assert_allclose(chief.m, np.sin(np.radians(40)), rtol=1e-14)
    assert_allclose(chief.y[-1], 3.4526928114518812 * np.sin(np.radians(40)), rtol=1e-14)


def test_meniscus_of_equal_radii(designs: dict[str, Lens]) -> None:
    lens = designs["thick_meniscus"]
    points = lenstrace.first_order(lens)
    assert_allclose(points.rear_principal_plane, points.front_principal_plane, rtol=1e-13)
    # a ray parallel to the axis inside meets both surfaces at one height, and leaves in the direction it came in
    height, n = 8.0, lenstrace.glass("N-BK7").index(0.5875618)
    slope = np.arcsin(height / 25)
    angle = np.arcsin(n * np.sin(slope)) - slope
    sag = 25 - np.sqrt(25**2 - height**2)
    start = (0.0, height - (sag + 10) * np.tan(angle), -10.0)
    path = lenstrace.trace(lens, lenstrace.ray(start, (0.0, np.sin(angle), np.cos(angle))))
    assert_allclose(path.m[1:3], [0, np.sin(angle)], atol=1e-15)
    assert_allclose(path.y[1:3], height, rtol=1e-14)


def test_hyperboloid_and_oval_are_stigmatic(designs: dict[str, Lens]) -> None:
    singlet, oval = designs["hyperbolic_singlet"], designs["cartesian_oval"]
    path = lenstrace.trace(singlet, pupil=PUPIL)
    assert_allclose([path.x[-1], path.y[-1]], 0, atol=1e-13)
    assert_allclose(path.opl[-1], 15 * 1.5 + 100, rtol=1e-15)
    path = lenstrace.trace(oval, pupil=PUPIL)
    assert_allclose([path.x[-1], path.y[-1]], 0, atol=5e-12)
    assert_allclose(from_object(oval, path), 100 + 1.5 * 150, rtol=2e-15)
    # the first term left out of the series, r^22, sets the rest of the spot; the light ends inside the glass
    r = float(lenstrace.trace(oval, pupil=UP).y[1])
    left_out = 2.4035237253722607e-36 * 22 * r**21 * 150 / 3
    assert_allclose(lenstrace.trace(oval, pupil=UP).y[-1], left_out, rtol=0.12)
    assert float(oval.system.index[0, -1]) == 1.5


@pytest.mark.parametrize("field", [0.0, 2.0])
def test_fold_changes_nothing_at_the_image(field: float, designs: dict[str, Lens]) -> None:
    folded, straight = (
        lenstrace.trace(designs[name], field=field, pupil=PUPIL) for name in ("fold_mirror", "cemented_doublet")
    )
    assert_allclose(folded.x[-1], straight.x[-1], atol=2e-14)
    assert_allclose(folded.y[-1], straight.y[-1], atol=2e-14)
    assert_allclose(folded.opl[-1], straight.opl[-1], rtol=1e-14)
    assert_allclose([folded.l[-1], folded.m[-1]], [straight.l[-1], straight.m[-1]], atol=1e-14)
    assert_allclose(folded.n[-1], -straight.n[-1], rtol=1e-14)


def test_infrared_triplet_over_its_band(designs: dict[str, Lens]) -> None:
    lens = designs["infrared_germanium_silicon"]
    # y-nu in 50 digits with the formulas of Salzberg & Villa and of Icenogle et al., inches
    expected = [4.0000291524659711, 4.0000799519740731, 4.0002079228744244]
    assert_allclose(lenstrace.first_order(lens).focal_length / 25.4, expected, rtol=1e-14)
    # Optiland 0.6.3 with these indices
    path = lenstrace.trace(lens, field=3.5, pupil=(0.6, 0.8))
    assert_allclose([path.x[-1] / 25.4, path.y[-1] / 25.4], [0.0001391999843148, 0.2443045505316768], atol=1e-14)
    assert_allclose(path.m[-1], -0.07769429938758393, rtol=1e-13)


def test_phone_lens_against_rayoptics(designs: dict[str, Lens]) -> None:
    lens = designs["phone_lens"]
    # from its documentation: a ray parallel to the axis, 1 mm above it, at the surfaces 2 ... 11 and the image
    path = lenstrace.trace(lens, lenstrace.ray((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    heights = [1.0, 0.84711, 0.61108, 0.59188, 0.56295, 0.45281, 0.42089, 0.27126, 0.14394, 0.09476, -0.02573]
    assert_allclose(path.y[2:], heights, atol=5.1e-6)
    # rayoptics 0.9.8: a skew ray through the stop, 25 degrees up
    direction = (0.0, np.sin(np.radians(25)), np.cos(np.radians(25)))
    path = lenstrace.trace(lens, lenstrace.ray((0.3, -0.2, 0.0), direction))
    assert_allclose([path.x[-1], path.y[-1]], [0.005338845222848533, 2.6878999479973507], atol=1e-12)
    assert_allclose([path.l[-1], path.m[-1]], [-0.04624647615079891, 0.4644408252940048], atol=1e-12)


def test_expander_turns_plane_waves_into_plane_waves(designs: dict[str, Lens]) -> None:
    lens = designs["afocal_expander"]
    path = lenstrace.trace(lens, pupil=PUPIL)
    assert_allclose([path.l[-1], path.m[-1]], 0, atol=1e-15)
    assert_allclose([path.x[-1], path.y[-1]], -20 * np.array(PUPIL), atol=1e-12)
    assert_allclose(path.opl[-1], 1.5 * 12 + 250 + 60, rtol=1e-14)
    chief = lenstrace.trace(lens, field=0.001)
    assert_allclose(chief.m[-1] / chief.n[-1], -np.tan(np.radians(0.001)) / 4, rtol=1e-8)


def test_relay_turned_round_is_itself(designs: dict[str, Lens]) -> None:
    lens = designs["relay_one_to_one"]
    for um in lens.wavelengths.um:
        for height in (2.5, 5.0):
            assert_allclose(lenstrace.trace(lens, field=height, wavelength=um).y[-1], -height, rtol=1e-11)
        # sent back from where it arrives through the same point of the stop, a ray comes to where it started
        there = lenstrace.trace(lens, field=5.0, pupil=(0.5, -0.8), wavelength=um)
        back = lenstrace.trace(lens, field=(there.x[-1], there.y[-1]), pupil=(0.5, -0.8), wavelength=um)
        assert abs(float(there.y[-1]) + 5) > 0.01
        assert_allclose([back.x[-1], back.y[-1]], [0, 5], atol=1e-9)


def test_three_mirrors_against_batoid(designs: dict[str, Lens]) -> None:
    # batoid 0.9.0, which looks the other way along z: two rays of 1.2 degrees from a plane 10 m above M1, in metres
    u = np.radians(1.2)
    start = (np.array([1500.0, -2000.0]), np.array([-3000.0, 3400.0]), -10000.0)
    path = lenstrace.trace(designs["three_mirror_telescope"], lenstrace.ray(start, (0.0, np.sin(u), np.cos(u))))
    assert_allclose(path.x[-1] / 1000, [-6.490644726478423e-07, 1.5863823297507934e-06], atol=1e-13)
    assert_allclose(path.y[-1] / 1000, [0.21605429313605454, 0.21604596227041697], atol=1e-13)
    assert_allclose(path.l[-1], [-0.1453974987446048, 0.1938668950561988], atol=1e-13)
    assert_allclose(path.m[-1], [0.1910287588903867, -0.4285675066085788], atol=1e-13)
    assert_allclose(path.opl[-1] / 1000, [27.34847281608781, 27.214443896182512], rtol=1e-14)


def test_fisheye_fills_its_stop_and_maps_angles_evenly(designs: dict[str, Lens]) -> None:
    lens = designs["fisheye"]
    fields = np.array([0.0, 30.0, 60.0, 90.0, 110.0])
    path = lenstrace.trace(lens, field=fields[:, None], pupil=PUPIL)
    assert np.asarray(path.ok).all()
    # the chief ray meets the centre of the stop, the others their places
    x, y = np.asarray(path.x[lens.stop]), np.asarray(path.y[lens.stop])
    assert_allclose(x, y[0, 1] * np.tile(PUPIL[0], (5, 1)), atol=1e-9)
    assert_allclose(y, y[0, 1] * np.tile(PUPIL[1], (5, 1)), atol=1e-9)
    assert_allclose(path.y[-1][:, 0], 6.2998855 * np.radians(fields), rtol=0.04)


def test_aplanats_carry_every_ray_through_one_point(designs: dict[str, Lens]) -> None:
    lens = designs["immersion_objective"]
    path = lenstrace.trace(lens, pupil=(0.0, np.array([1.0, 0.7, 0.2])))
    sine = path.m[0]
    assert_allclose(sine[0], 1.2 / 1.5, rtol=1e-14)
    # the virtual images: n R in front of the centre of 2, and of 4; sines fall by n^2 / n and by n
    for surface, image, magnification in ((2, -7.5, 2.25), (4, -15.0, 3.375)):
        there = path.y[surface] + (image - path.z[surface]) * path.m[surface] / path.n[surface]
        assert_allclose(there, 0, atol=3e-13)  # the rim of 2 is all but upright
        assert_allclose(path.m[surface], 1.5 * sine / magnification, rtol=5e-14)
    opl = from_object(lens, path)
    assert_allclose(opl, opl[0], rtol=1e-15)
