"""Launching: field and pupil conventions, and rays aimed at the stop."""

import dataclasses
import math

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens
from lenstrace.sequential.document import Aperture, Fields

# A made-up lens that sees more than a half space: the strong menisci bend 100 degrees into the stop.
FISHEYE_ROWS = [
    {"radius": 45.0, "thickness": 2.5, "index": 1.62},
    {"radius": 16.5, "thickness": 10.6},
    {"radius": 190.0, "thickness": 1.5, "index": 1.52},
    {"radius": 14.2, "thickness": 11.0},
    {"radius": 32.0, "thickness": 5.5, "index": 1.75},
    {"radius": -100.0, "thickness": 6.0},
    {"thickness": 4.0, "stop": True},
    {"radius": 60.0, "thickness": 4.0, "index": 1.6},
    {"radius": -10.0, "thickness": 1.0, "index": 1.8},
    {"radius": -22.0, "thickness": 19.0},
]


@pytest.fixture(scope="module")
def fisheye() -> Lens:
    """Rays aimed at a stop of radius 1.2 mm."""
    return lenstrace.lens(FISHEYE_ROWS, {"stop_semi_diameter": 1.2}, [0.0], [0.5876], ray_aiming=True)


def plate(fields: object, **more: object) -> Lens:
    """A stop in front of nothing: launching alone."""
    rows = [{"thickness": 30.0}, {"thickness": 70.0, "stop": True}]
    aperture = more.pop("aperture", {"entrance_pupil_diameter": 8.0})
    return lenstrace.lens(rows, aperture, fields, [0.55], **more)  # type: ignore[arg-type]


def test_angles_go_up_and_rays_pass_the_pupil() -> None:
    ray = lenstrace.trace(plate([0.0, 20.0]), field=20.0, pupil=(0.5, -1.0))
    a = math.radians(20)
    assert_allclose([ray.l[0], ray.m[0], ray.n[0]], [0, math.sin(a), math.cos(a)], atol=1e-16)
    assert float(ray.z[0]) == 0
    # the entrance pupil is the stop itself, 30 mm behind the first vertex
    assert_allclose([ray.x[2], ray.y[2]], [2, -4], atol=1e-14)


def test_a_field_in_x_and_y_runs_along_the_tangents() -> None:
    ray = lenstrace.trace(plate([0.0]), field=(10.0, -25.0))
    expected = np.array([math.tan(math.radians(10)), math.tan(math.radians(-25)), 1])
    assert_allclose([ray.l[0], ray.m[0], ray.n[0]], expected / np.linalg.norm(expected), atol=1e-15)


def test_finite_object_angle_is_the_chief_ray() -> None:
    # object y = -(object_distance + entrance pupil position) tan(a)
    lens = plate([0.0, 5.0], object_distance=100.0)
    ray = lenstrace.trace(lens, field=5.0)
    assert_allclose(ray.m[0] / ray.n[0], math.tan(math.radians(5)), rtol=1e-14)
    assert_allclose(ray.y[0], -30 * math.tan(math.radians(5)), rtol=1e-14)


def test_object_height_is_the_object_point() -> None:
    lens = plate({"kind": "object_height", "y": [0.0, 3.0]}, object_distance=100.0)
    ray = lenstrace.trace(lens, field=3.0, pupil=(0.0, 1.0))
    # the line from (0, 3, -100) to (0, 4, 30)
    assert_allclose([ray.y[0], ray.m[0] / ray.n[0]], [3 + 100 / 130, 1 / 130], rtol=1e-14)


def test_image_height_is_paraxial(designs: dict[str, Lens]) -> None:
    triplet = designs["cooke_triplet"]
    by_height = triplet.replace(fields=Fields((0.0,), (18.0,), "image_height"))
    ray = lenstrace.trace(by_height, field=18.0)
    focal_length = lenstrace.first_order(triplet).focal_length[1]
    assert_allclose(ray.m[0] / ray.n[0], 18 / focal_length, rtol=1e-13)
    # finite: h' = m y
    finite = dataclasses.replace(by_height, object_distance=200.0)
    height = 18.0 / lenstrace.overview(finite).magnification
    object_y = lenstrace.trace(finite, field=18.0)
    slope = object_y.m[0] / object_y.n[0]
    assert_allclose(object_y.y[0] - 200 * slope, height, rtol=1e-12)


def test_a_far_object_launches_like_one_at_infinity(designs: dict[str, Lens]) -> None:
    far = dataclasses.replace(designs["double_gauss"], object_distance=1e12)
    at_infinity = lenstrace.trace(designs["double_gauss"], field=10.0, pupil=(0.3, 0.9))
    at_distance = lenstrace.trace(far, field=10.0, pupil=(0.3, 0.9))
    # the pupil seen from 1e12 mm: directions differ by 1e-11 rad
    assert_allclose(at_distance.y[-1], at_infinity.y[-1], atol=5e-9)
    assert_allclose(at_distance.x[0], at_infinity.x[0], atol=1e-9)


def test_a_pupil_behind_the_object_still_launches_forward() -> None:
    # the stop stands behind a lens, further than its focus: the entrance pupil is 200 mm in front of the first
    # vertex, behind an object at 150 mm
    rows = [{"radius": 50.0, "thickness": 0.0, "index": 1.5}, {"thickness": 200.0}, {"thickness": 100.0, "stop": True}]
    fields = {"kind": "object_height", "y": [0.0, 1.0]}
    lens = lenstrace.lens(rows, {"stop_semi_diameter": 5.0}, fields, [0.55], object_distance=150.0)
    assert_allclose(lenstrace.overview(lens).entrance_pupil.position, -200, rtol=1e-13)
    ray = lenstrace.trace(lens, field=1.0, pupil=(0.0, 1.0))
    assert float(ray.n[0]) > 0
    assert_allclose(ray.y[0] - 150 * ray.m[0] / ray.n[0], 1.0, rtol=1e-12)


def test_telecentric_objects_need_an_aperture_in_the_object_space() -> None:
    rows = [{"radius": 50.0, "thickness": 0.0, "index": 1.5}, {"thickness": 100.0}, {"thickness": 50.0, "stop": True}]
    fields = {"kind": "object_height", "y": [0.0, 2.0]}
    lens = lenstrace.lens(rows, {"object_na": 0.05}, fields, [0.55], object_distance=120.0)
    assert np.isinf(lenstrace.overview(lens).entrance_pupil.position)
    chief = lenstrace.trace(lens, field=2.0)
    assert_allclose([chief.y[0], chief.m[0]], [2, 0], atol=1e-14)
    rim = lenstrace.trace(lens, field=0.0, pupil=(0.0, 1.0))
    assert_allclose(rim.m[0], 0.05, rtol=1e-13)
    with pytest.raises(lenstrace.PrescriptionError, match="entrance pupil is at infinity"):
        lenstrace.spots(lens.replace(aperture=Aperture(3.0, "stop_semi_diameter")))


@pytest.mark.parametrize("field", [0.0, 45.0, 80.0, 85.0, 89.0, 90.0, 95.0, 100.0])
def test_a_fisheye_fills_its_stop(fisheye: Lens, field: float) -> None:
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    px, py = np.append(np.cos(angle), [0, 0.3]), np.append(np.sin(angle), [0, -0.6])
    path = lenstrace.trace(fisheye, field=field, pupil=(px, py))
    assert np.asarray(path.ok).all()
    assert_allclose(path.x[fisheye.stop], 1.2 * px, atol=1.2e-10)
    assert_allclose(path.y[fisheye.stop], 1.2 * py, atol=1.2e-10)
    # the direction is that of the field: a plane wave
    a = math.radians(field)
    assert_allclose(path.m[0], math.sin(a), atol=1e-15)
    assert_allclose(path.n[0], math.cos(a), atol=1e-15)


def test_aimed_radius_is_that_of_the_real_axial_ray(designs: dict[str, Lens]) -> None:
    gauss = designs["double_gauss"]
    aimed = dataclasses.replace(gauss, ray_aiming=True)
    radius = lenstrace.trace(gauss, pupil=(0.0, 1.0)).y[gauss.stop]
    path = lenstrace.trace(aimed, field=14.0, pupil=(0.6, -0.8), wavelength=0.4861)
    assert_allclose([path.x[gauss.stop], path.y[gauss.stop]], [0.6 * radius, -0.8 * radius], rtol=1e-10)


def test_a_decentred_stop_is_filled_about_its_own_centre() -> None:
    rows = [
        {"thickness": 200.0, "stop": True, "decenter": [0, 60]},
        {"radius": -600.0, "thickness": -300, "mirror": True},
    ]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 40.0}, [0.0], [0.55], ray_aiming=True)
    path = lenstrace.trace(lens, pupil=(np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, -1.0])))
    assert_allclose(path.y[1], [20, 0, -20], atol=1e-9)
    assert_allclose(path.x[1], [0, 20, 0], atol=1e-9)


def test_questions_may_be_traced_while_the_lens_is_known(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]

    def height(field: jax.Array, y: jax.Array) -> jax.Array:
        return lenstrace.trace(lens, field=field, pupil=(0.0, y), path=False).y

    assert_allclose(jax.jit(height)(14.0, 0.5), height(14.0, 0.5), rtol=1e-14)
    with pytest.raises(lenstrace.RayError, match="wavelength cannot be traced"):
        jax.grad(lambda um: lenstrace.trace(lens, wavelength=um, path=False).y)(0.55)
    for wrong in (200.0, -90.0, "a", np.nan, (100.0, 30.0)):
        with pytest.raises(lenstrace.LensTraceError):
            lenstrace.trace(lens.replace(object_distance=50.0), field=wrong)


def test_a_ray_that_cannot_be_aimed_says_so(designs: dict[str, Lens]) -> None:
    aimed = dataclasses.replace(designs["cooke_triplet"], ray_aiming=True)
    path = lenstrace.trace(aimed, field=np.array([10.0, 75.0]))
    assert np.asarray(path.status[-1]).tolist() == [0, lenstrace.RayStatus.NOT_CONVERGED]
    assert np.asarray(path.surface[-1]).tolist() == [0, 0]
    assert all(np.isfinite(part).all() for part in jax.tree.leaves(path))
