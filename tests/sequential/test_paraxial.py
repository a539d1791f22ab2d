"""Paraxial optics against closed forms, and against the derivative of the exact trace on the axial ray."""

import dataclasses
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens
from lenstrace.optics.rays import living
from lenstrace.sequential import paraxial
from lenstrace.sequential.trace import trace


def thick_lens(front: float, rear: float, thickness: float, index: float, **more: object) -> Lens:
    """Two surfaces in air with the image in the paraxial focus of nothing in particular."""
    rows = [
        {"radius": front, "thickness": thickness, "index": index, "stop": True},
        {"radius": rear, "thickness": 30.0},
    ]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 1.0}, [0.0], [0.5876], **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("front", "rear", "thickness", "index", "focal_length", "back_focal_length"),
    [
        (50, -50, 10, 1.5, 51.7241379310345, 48.2758620689655),
        (1, -1, 2, 1.5, 1.5, 0.5),
        (100, -100, 10, 1.5168, 98.4259980188549, None),
        (50, 40, 6, 1.5, -500, -480),
    ],
)
def test_thick_lenses(
    front: float, rear: float, thickness: float, index: float, focal_length: float, back_focal_length: float | None
) -> None:
    points = lenstrace.first_order(thick_lens(front, rear, thickness, index))
    assert_allclose(points.focal_length[0], focal_length, rtol=2e-14)
    if back_focal_length is not None:
        assert_allclose(points.back_focal_length[0], back_focal_length, rtol=2e-14)


def test_principal_planes_of_a_thick_lens() -> None:
    # h = -f (n - 1) t / (n R2), h' = -f (n - 1) t / (n R1)   (Hecht, Optics, Eqs. 6.3 and 6.4)
    front, rear, t, n = 40.0, -90.0, 12.0, 1.6
    points = lenstrace.first_order(thick_lens(front, rear, t, n))
    f = 1 / ((n - 1) * (1 / front - 1 / rear + (n - 1) * t / (n * front * rear)))
    assert_allclose(points.focal_length[0], f, rtol=1e-14)
    assert_allclose(points.front_principal_plane[0], -f * (n - 1) * t / (n * rear), rtol=1e-13)
    assert_allclose(points.rear_principal_plane[0], -f * (n - 1) * t / (n * front), rtol=1e-13)
    assert_allclose(points.front_nodal_point[0], points.front_principal_plane[0], rtol=1e-13)
    assert_allclose(points.rear_nodal_point[0], points.rear_principal_plane[0], rtol=1e-13)


def test_one_surface_between_two_media() -> None:
    # f' = n' R / (n' - n), f = -n R / (n' - n); both nodal points are the centre of curvature
    rows = [{"radius": 20.0, "thickness": 60.0, "index": 1.5, "stop": True}]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 2.0}, [0.0], [0.55], object_index=1.2)
    points = lenstrace.first_order(lens)
    assert_allclose(points.focal_length[0], 1.5 * 20 / 0.3, rtol=1e-14)
    assert_allclose(points.object_focal_length[0], -1.2 * 20 / 0.3, rtol=1e-14)
    assert_allclose([points.front_nodal_point[0], points.rear_nodal_point[0]], [20, 20], rtol=1e-13)
    assert_allclose([points.front_principal_plane[0], points.rear_principal_plane[0]], [0, 0], atol=1e-12)
    check = lenstrace.newton_check(lens)
    assert_allclose(check.expected, -100.0 * 80.0, rtol=1e-14)
    assert np.abs(check.residual).max() < 1e-12
    assert_allclose(check.slope, 2, atol=2e-3)


def test_newton_holds_around_a_fold() -> None:
    # the light is turned by 90 degrees; the axis goes on along it
    rows = [
        {"radius": 60.0, "thickness": 5.0, "index": 1.5168, "stop": True},
        {"radius": -60.0, "thickness": 30.0},
        {"break": True, "tilt": [45.0, 0.0, 0.0]},
        {"mirror": True},
        {"break": True, "tilt": [45.0, 0.0, 0.0], "thickness": -26.0},
    ]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 4.0}, [0.0], [0.5876])
    check = lenstrace.newton_check(lens)
    assert np.abs(check.residual).max() < 1e-12
    assert_allclose(check.slope, 2, atol=1e-2)
    assert np.abs(check.real_residual[-1]).max() < 1e-3
    # the image stands beside the fold, 26 mm off the axis, at the fold's own z
    assert_allclose(lenstrace.overview(lens).total_track, 35, rtol=1e-12)


def test_a_concave_mirror() -> None:
    # R = -100: the focus is 50 mm in front of the mirror; f' = n'/phi with n' = -1
    rows = [{"radius": -100.0, "thickness": -50.0, "mirror": True, "stop": True}]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 10.0}, [1.0], [0.55])
    points = lenstrace.first_order(lens)
    assert_allclose([points.power[0], points.focal_length[0], points.object_focal_length[0]], [0.02, -50, -50])
    assert_allclose([points.rear_focal_point[0], points.front_focal_point[0]], [-50, -50])
    assert_allclose(lenstrace.newton_check(lens).expected, 2500.0)
    # the image of a point above the axis at infinity (field angle 1: light goes up) lies above the axis
    assert_allclose(lenstrace.trace(lens, field=1.0).y[-1], 50 * math.tan(math.radians(1)), rtol=1e-12)


def test_two_mirror_telescope_focal_length(designs: dict[str, Lens]) -> None:
    # f = f1 f2 / (f1 - f2 - d) for a Cassegrain, f1 = R1 / 2 and f2 = R2 / 2 taken positive
    f1, f2, d = 5520.0, 679.0, 4906.071
    points = lenstrace.first_order(designs["hubble"])
    assert_allclose(points.focal_length[0], f1 * f2 / (f2 - (f1 - d)), rtol=1e-12)
    assert_allclose(points.focal_length[0], 57600, rtol=1e-5)
    assert_allclose(points.rear_focal_point[0], 6406.2, atol=0.01)


def test_afocal_lens_has_power_zero_and_no_nan() -> None:
    # two thin plano-convex lenses, 100 and 50 mm, with common focus
    rows = [
        {"radius": 50.0, "thickness": 0.0, "index": 1.5, "stop": True},
        {"thickness": 150.0},
        {"radius": 25.0, "thickness": 0.0, "index": 1.5},
        {"thickness": 10.0},
    ]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 5.0}, [0.0], [0.55])
    points = lenstrace.first_order(lens)
    assert float(points.power[0]) == 0
    lengths = [name for name in dataclasses.asdict(points) if name not in ("power", "rear_vertex")]
    assert all(np.isinf(getattr(points, name)).all() for name in lengths)
    with pytest.raises(lenstrace.ImageError, match="at infinity"):
        lenstrace.spots(lens)
    gradient = jax.grad(lambda c: lenstrace.first_order(lens.replace(surface=1, curvature=c)).power[0])(0.02)
    # d phi / d c1 = (n - 1)(1 - d phi2) = 0.5 (1 - 150 / 50)
    assert_allclose(gradient, -1.0, rtol=1e-12)


def test_figures_are_the_same_under_jit_whatever_follows_the_last_glass() -> None:
    # a dummy plane 5 mm behind the lens: rear points still count from the glass, also where JAX traces the indices
    rows = [
        {"radius": 50.0, "thickness": 10.0, "index": 1.5, "stop": True},
        {"radius": -50.0, "thickness": 5.0},
        {"thickness": 43.2, "tilt": [3.0, 0.0, 0.0]},
    ]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 5.0}, [0.0, 3.0], [0.55])
    plain, traced = lenstrace.first_order(lens), jax.jit(lenstrace.first_order)(lens)
    assert_allclose(plain.back_focal_length[0], 48.2758620689655, rtol=1e-13)
    for old, new in zip(jax.tree.leaves(plain), jax.tree.leaves(traced), strict=True):
        assert_allclose(new, old, rtol=1e-14)
    sizes, under_jit = lenstrace.spots(lens), jax.jit(lenstrace.spots)(lens)
    assert_allclose(under_jit.rms_centroid, sizes.rms_centroid, rtol=1e-12)


def test_asphere_quadratic_term_counts_in_power() -> None:
    plain = thick_lens(50, -50, 10, 1.5)
    # half of the curvature of surface 1 written as an r^2 term: 0.02 / 2 / 2
    split = plain.replace(surface=1, curvature=0.01, asphere={2: 0.005})
    assert_allclose(lenstrace.first_order(split).focal_length, lenstrace.first_order(plain).focal_length, rtol=1e-14)


def test_pupils_of_a_stop_behind_a_lens() -> None:
    # thin lens f = 100, stop 20 mm behind it: the entrance pupil is the virtual image, 1/s' = 1/20 - 1/100
    rows = [
        {"radius": 50.0, "thickness": 0.0, "index": 1.5},
        {"thickness": 20.0},
        {"thickness": 80.0, "stop": True},
    ]
    lens = lenstrace.lens(rows, {"stop_semi_diameter": 4.0}, [0.0], [0.55])
    found = lenstrace.overview(lens)
    assert_allclose([found.entrance_pupil.position, found.entrance_pupil.diameter], [25, 10], rtol=1e-13)
    assert_allclose([found.exit_pupil.position, found.exit_pupil.diameter], [-80, 8], rtol=1e-13)
    assert_allclose([found.f_number, found.total_track], [10, 100], rtol=1e-13)
    assert found.magnification is None


def test_finite_object_magnification_and_na() -> None:
    # thin lens f = 100 at 2 f: m = -1; marginal ray with sin(theta) = 0.1 reaches 200 tan(theta)
    rows = [{"radius": 50.0, "thickness": 0.0, "index": 1.5, "stop": True}, {"thickness": 200.0}]
    fields = {"kind": "object_height", "y": [0.0, 1.0]}
    lens = lenstrace.lens(rows, {"object_na": 0.1}, fields, [0.55], object_distance=200.0)
    found = lenstrace.overview(lens)
    assert_allclose(found.magnification, -1, rtol=1e-13)
    assert_allclose(found.entrance_pupil.diameter, 400 * 0.1 / math.sqrt(0.99), rtol=1e-13)


def test_angular_magnification_of_afocal_systems() -> None:
    def found(rows: list[dict[str, float]], **more: object) -> float:
        rows = [{**rows[0], "stop": True}, *rows[1:]]
        lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 1.0}, [0.0], [0.55], **more)  # type: ignore[arg-type]
        return float(paraxial.angular_magnification(lens.system.at(0)))

    # Galilean, f = 100 and -25 in air; a plane out of glass: Snell's law; two mirrors; a lens with power: nan
    glass = {"thickness": 0.0, "index": 1.5}
    lenses = [{"radius": 50.0, **glass}, {"thickness": 75.0}, {"radius": -12.5, **glass}, {"thickness": 10.0}]
    assert_allclose(found(lenses), 4, rtol=1e-14)
    assert_allclose(found([{"thickness": 10.0}], object_index=1.5), 1.5, rtol=1e-15)
    mirrors = [{"radius": -200.0, "thickness": -80.0}, {"radius": -40.0, "thickness": 100.0}]
    assert_allclose(found([{**row, "mirror": True} for row in mirrors]), 5, rtol=1e-14)
    assert math.isnan(found(lenses[:2]))


@pytest.mark.parametrize("name", ["cooke_triplet", "double_gauss", "tessar", "hubble", "negative_index_slab"])
def test_matrix_is_the_derivative_of_the_exact_trace(name: str, designs: dict[str, Lens]) -> None:
    system = designs[name].system.at(0)
    last = int(np.flatnonzero(system.bends)[-1]) + 1

    def exact(height: jax.Array, slope: jax.Array) -> jax.Array:
        zero = jnp.zeros(())
        length = jnp.sqrt(1 + slope * slope)
        end = trace(system, living(zero, height, zero, zero, slope / length, 1 / length), last=last)
        return jnp.stack([end.y - end.z * end.m / end.n, end.m / end.n])

    derivative = jnp.stack(jax.jacfwd(exact, argnums=(0, 1))(0.0, 0.0), 1)
    found = paraxial.matrix(system, 1, last)
    index = paraxial.signed_index(system)
    before, after = index[0], index[last]
    expected = [[found.a, found.b * before], [found.c / after, found.d * before / after]]
    assert_allclose(derivative, expected, rtol=1e-11, atol=1e-12)


def test_object_under_water() -> None:
    # one surface: n' / s' = n / s + (n' - n) / R, s and s' along +z, and m = n s' / (n' s)
    lens = lenstrace.lens(
        [{"radius": 10.0, "thickness": 55.0, "index": 1.6, "stop": True}],
        {"object_na": 0.1},
        {"kind": "object_height", "y": [0.0]},
        [0.5876],
        object_distance=200.0,
        object_glass="WATER",
    )
    water = 1.33304  # Hale and Querry, Appl. Opt. 12, 555 (1973), interpolated: to 1e-4
    image = 1.6 / (water / -200 + (1.6 - water) / 10)
    assert_allclose(lenstrace.overview(lens).magnification, water * image / (1.6 * -200), rtol=1e-4)
    # n sin(theta) of the marginal ray under water is the numerical aperture
    marginal = lenstrace.trace(lens, pupil=(0.0, 1.0))
    assert_allclose(lens.system.index[0, 0] * marginal.m[0], 0.1, rtol=1e-12)
