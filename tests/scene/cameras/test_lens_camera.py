"""Rays of the camera against the sequential tracer run forward; precision, blocks, colour, derivatives, bad input."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lenstrace
from lenstrace import CameraError, Lens, PrescriptionError
from lenstrace.compute.blocks import each
from lenstrace.optics.rays import Ray, living
from lenstrace.scene import Diffuse, Object, PointLight, Rectangle, Scene, radiance
from lenstrace.scene.cameras.focusing import focused
from lenstrace.scene.cameras.lens_camera import LensCamera, lens_camera
from lenstrace.scene.cameras.simple import Pinhole
from lenstrace.scene.cameras.view import CameraRay, View
from lenstrace.sequential import paraxial
from lenstrace.sequential.trace import trace

HERE, THERE = (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)  # right, up and back are then x, y and z
EVENT = "/jax/core/compile/backend_compile_duration"

TILTED = [
    {"radius": 60.0, "thickness": 6.0, "glass": "N-BK7", "tilt": [1.0, 2.0, 0.0], "decenter": [0.4, -0.7]},
    {"radius": -60.0, "thickness": 3.0, "stop": True, "aperture": {"circle": 12.0}},
    {"thickness": 58.0, "aperture": {"rectangle": [6.0, 5.0]}},
]

traced = jax.jit(lambda camera, *places: camera.rays(*places))


def tilted() -> Lens:
    return lenstrace.lens(TILTED, {"entrance_pupil_diameter": 14.0}, [0.0], [0.48, 0.55, 0.65])


def places(count: int, seed: int = 0, wide: float = 1.0) -> list[jax.Array]:
    """Places in the picture and of the pupil."""
    x, y, u, v = np.random.default_rng(seed).uniform(size=(4, count))
    return [jnp.asarray(a) for a in (wide * (2 * x - 1), wide * (2 * y - 1), u, v)]


def forward(lens: Lens, seen: CameraRay, wavelength: int) -> Ray:
    """What the camera sees, sent back through the lens as it is prescribed."""
    system = lens.system.at(wavelength)
    pupil = float(paraxial.entrance_pupil(lens.system.at(lens.system.primary)).position)
    x, y, z = seen.point
    start = living(x, y, z + pupil, *(-d for d in seen.direction))
    return trace(system.without_apertures(), start)


@pytest.fixture(scope="module")
def gauss(designs: dict[str, Lens]) -> Lens:
    return designs["double_gauss"]


@pytest.mark.parametrize(
    ("name", "film", "focus"),
    [("double_gauss", 48.0, 2000.0), ("tessar", 24.0, np.inf), ("tilted", 20.0, 500.0)],
)
def test_what_is_seen_comes_back_to_the_film(name: str, film: float, focus: float, designs: dict[str, Lens]) -> None:
    lens = tilted() if name == "tilted" else designs[name]
    camera = lens_camera(lens, HERE, THERE, film=film, focus=focus)
    x, y, u, v = places(512)
    opened = focused(lens, focus)
    for wavelength, um in enumerate(lens.wavelengths.um):
        seen = traced(camera, x, y, u, v, jnp.full(x.shape, um))
        arrived = forward(opened, seen, wavelength)
        lit = np.asarray(seen.weight) > 0
        assert lit.mean() > 0.4
        assert np.asarray(arrived.ok)[lit].all()
        for got, place in ((arrived.x, x), (arrived.y, y)):
            assert np.abs(np.asarray(got) + np.asarray(place) * film / 2)[lit].max() < 1e-6
        if wavelength == lens.wavelengths.primary:
            seen = traced(camera, x, y, u, v, None)
            arrived = forward(opened, seen, wavelength)
            for got, place in ((arrived.x, x), (arrived.y, y)):
                assert np.abs(np.asarray(got) + np.asarray(place) * film / 2)[lit].max() < 1e-9


def test_the_light_of_one_point_is_seen_where_its_spot_is(gauss: Lens) -> None:
    """Rays of an object point, traced forward to the film; from there the camera sees them all come from that point."""
    camera = lens_camera(gauss, HERE, THERE, film=48.0, focus=2000.0)
    lens = focused(gauss, 2000.0)
    system = lens.system.at(1)
    target = np.array([120.0, -210.0, -1800.0])  # of the first vertex
    x, y = (4 * jnp.asarray(a) for a in np.random.default_rng(2).uniform(-1, 1, (2, 200)))
    toward = np.stack([x - target[0], y - target[1], 0 * x - target[2]])
    start = living(x, y, 0 * x, *(jnp.asarray(a) for a in toward / np.sqrt((toward**2).sum(0))))
    spot = trace(system, start)
    back = living(spot.x, spot.y, jnp.full(x.shape, -lens.rows[-1].thickness), -spot.l, -spot.m, spot.n)
    seen = camera._in_scene(camera._through(camera.system, back)[0], jnp.ones_like(x))
    pupil = float(paraxial.entrance_pupil(system).position)
    point, direction = (np.stack([np.asarray(a) for a in each]) for each in (seen.point, seen.direction))
    far = (target + np.array([0, 0, -pupil]))[:, None] - point
    miss = far - direction * (far * direction).sum(0)
    assert np.abs(miss).max() < 1e-9
    # a spot, not a point
    assert float(jnp.std(spot.x)) > 1e-4


def test_lateral_colour_is_that_of_the_sequential_tracer(gauss: Lens) -> None:
    """With catalogue glass, whose indices the camera fits: the chief ray of one colour, to 1e-6 mm on the film."""
    lens = gauss
    for surface, glass in ((1, "N-SSK2"), (3, "N-SK2"), (4, "F5"), (7, "F5"), (8, "N-SK16"), (10, "N-SK16")):
        lens = lens.replace(surface=surface, glass=glass)
    camera = lens_camera(lens, HERE, THERE, film=48.0)
    opened = focused(lens, np.inf)
    x = jnp.linspace(-1.0, 1.0, 512)
    arrived = []
    for wavelength, um in enumerate(lens.wavelengths.um):
        seen = traced(camera, x, 0.5 * x, 0 * x + 0.5, 0 * x + 0.5, jnp.full(x.shape, um))
        arrived.append(np.asarray(forward(opened, seen, wavelength).x))
    assert max(np.abs(each + 24.0 * np.asarray(x)).max() for each in arrived) < 1e-6
    # there is such colour: the blue chief ray of one direction lands elsewhere than the red one
    blue, red = (
        traced(camera, x, 0 * x, 0 * x + 0.5, 0 * x + 0.5, jnp.full(x.shape, um)).direction[0]
        for um in (0.4861, 0.6563)
    )
    assert float(jnp.abs(blue - red).max()) > 1e-5


def test_the_picture_is_upright_and_has_the_perspective_of_a_pinhole(gauss: Lens) -> None:
    camera = lens_camera(gauss, (1.0, 2.0, 3.0), (1.0, 2.0, -5.0), film=24.0, focus=np.inf)
    view = View(*(tuple(map(jnp.asarray, each)) for each in ((1.0, 2.0, 3.0), (1.0, 2.0, -5.0), (0.0, 1.0, 0.0))))
    pinhole = Pinhole(view, jnp.asarray(2 * np.degrees(np.arctan(12 / 100.00374787))))
    x, y, u, _ = places(64)
    middle = 0 * u + 0.5
    lens_ray, hole_ray = (traced(each, x, y, middle, middle, None) for each in (camera, pinhole))
    for got, want in zip(lens_ray.direction, hole_ray.direction, strict=True):
        np.testing.assert_allclose(got, want, atol=2e-3)
    assert float(jnp.sum(lens_ray.direction[0] * x + lens_ray.direction[1] * y)) > 0
    # through the entrance pupil, where the pinhole is
    t = (3.0 - lens_ray.point[2]) / lens_ray.direction[2]
    assert float(jnp.abs(lens_ray.point[0] + t * lens_ray.direction[0] - 1.0).max()) < 0.2


def test_lengths_of_the_scene(gauss: Lens) -> None:
    metres = lens_camera(gauss, HERE, THERE, focus=2.0, unit_mm=1000.0)
    plain = lens_camera(gauss, HERE, THERE, focus=2000.0)
    where = places(32)
    a, b = traced(metres, *where, None), traced(plain, *where, None)
    np.testing.assert_allclose(np.stack(a.point) * 1000, np.stack(b.point), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(np.stack(a.direction), np.stack(b.direction), rtol=1e-9, atol=1e-12)


def test_single_precision(gauss: Lens) -> None:
    camera = lens_camera(gauss, HERE, THERE, film=48.0, focus=2000.0)
    single = camera.astype(jnp.float32)
    where = places(4096)
    um = jnp.linspace(0.4, 0.7, 4096)
    exact = traced(camera, *where, um)
    got = traced(single, *(a.astype(jnp.float32) for a in where), um.astype(jnp.float32))
    assert all(a.dtype == jnp.float32 for a in jax.tree.leaves(got))
    both = (np.asarray(exact.weight) > 0) & (np.asarray(got.weight) > 0)
    assert ((np.asarray(exact.weight) > 0) == (np.asarray(got.weight) > 0)).mean() > 0.999
    assert np.abs(np.stack(got.point) - np.stack(exact.point))[:, both].max() < 5e-5
    assert np.abs(np.stack(got.direction) - np.stack(exact.direction))[:, both].max() < 2e-6
    np.testing.assert_allclose(np.asarray(got.weight)[both], np.asarray(exact.weight)[both], rtol=1e-5)


def camera_rays(camera: LensCamera, where: list[jax.Array]) -> CameraRay:
    return camera.rays(*where)


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_blocks_of_rays_and_no_program_for_new_numbers(gauss: Lens, dtype: type) -> None:
    where = [a.astype(dtype) for a in (*places(3000), jnp.linspace(0.42, 0.68, 3000))]
    camera = lens_camera(gauss, HERE, THERE, focus=2000.0).astype(dtype)
    in_blocks, plain = each(camera_rays, camera, where), traced(camera, *where)
    near = 1e-12 if dtype is jnp.float64 else 1e-5
    for a, b in zip(jax.tree.leaves(in_blocks), jax.tree.leaves(plain), strict=True):
        np.testing.assert_allclose(a, b, atol=near * 1e3, rtol=near)
    compiled: list[str] = []

    def heard(event: str, _: float, **more: str) -> None:
        if event == EVENT:
            compiled.append(more.get("fun_name", "?"))

    other = gauss.replace(curvature=gauss.curvature * 1.01, thickness=gauss.thickness * 0.99)
    other = other.replace(surface=1, index={"um": [0.4861, 0.5876, 0.6563], "n": [1.64, 1.63, 1.625]})
    jax.monitoring.register_event_duration_secs_listener(heard)
    again = lens_camera(other, HERE, (0.0, 1.0, -1.0), focus=700.0, film=30.0).astype(dtype)
    each(camera_rays, again, where)
    jax.monitoring.unregister_event_duration_listener(heard)
    assert compiled == []


WALL = Scene(
    [Object(Rectangle(1e4, 1e4), Diffuse(0.7), (0.0, 0.0, -2000.0))], [PointLight((300.0, -300.0, -1700.0), 1e5)]
)


def test_derivatives(gauss: Lens) -> None:
    """Of a ray, of the focus, and of a pixel by a curvature: against central differences with the same samples."""
    slant = [jnp.asarray([a]) for a in (3.0, -8.0, 0.02, 0.15, np.sqrt(1 - 0.0229))]

    def values(c: jax.Array) -> jax.Array:
        lens = gauss.replace(surface=5, curvature=c)
        camera = lens_camera(lens, HERE, THERE, film=48.0, focus=1000.0, colour=False)
        # a wall 2 m away, out of focus, unevenly lit
        few = {"samples": 1 << 14, "method": "cast", "sampler": "sobol", "dtype": np.float64}
        pixel = radiance(WALL, camera, (8, 8), crop=(6, 5, 1, 1), **few)[0, 0, 0]
        start = living(slant[0], slant[1], -camera.system.object_distance, *slant[2:])
        seen = camera._in_scene(camera._through(camera.system, start)[0], slant[0])
        return jnp.stack([pixel, seen.direction[1][0], camera.system.object_distance])

    c = jnp.asarray(float(gauss.curvature[4]))
    value, slope = jax.jit(values), jax.jit(lambda c: jax.jvp(values, (c,), (jnp.ones_like(c),))[1])
    got = slope(c)
    # of the pixel a long step: its samples are few where the edge of the pupil moves
    for which, step, near in (([0], 3e-4, 0.01), ([1, 2], 1e-6, 1e-6)):
        difference = (value(c + step) - value(c - step)) / (2 * step)
        for place in which:
            assert float(got[place]) == pytest.approx(float(difference[place]), rel=near)


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("double_gauss", {"focus": 300.0}, "focus: 300 from the film is nearer than this lens can image, 368.78"),
        (
            "double_gauss",
            {"focus": 0.3, "unit_mm": 1000.0},
            "focus: 0.3 from the film is nearer than this lens can ima",
        ),
        ("double_gauss", {"focus": -1.0}, "focus must be positive, from the film to the sharp plane, got -1"),
        ("double_gauss", {"f_number": 0.0}, "f_number must be positive, got 0.0"),
        ("double_gauss", {"f_number": 0.5}, "f_number 0.5: its marginal ray does not reach the stop"),
        ("tessar", {"f_number": 2.0}, "f_number 2 opens the stop wider than the rims of this lens let light through"),
        ("afocal_expander", {}, "this lens is afocal"),
        ("double_gauss", {"film": 0.0}, "film must be positive, got 0.0"),
        ("double_gauss", {"aspect": 0.5}, "aspect is the longer side over the shorter one, at least 1, got 0.5"),
        ("double_gauss", {"up": (0.0, 0.0, 2.0)}, "up must not point along the axis"),
        ("double_gauss", {"absorption": {12: 0.1}}, "absorption: surface 12 does not exist; this lens has 1 to 11"),
        ("double_gauss", {"absorption": {1: -0.1}}, "absorption: behind surface 1 must not be negative"),
        ("hubble", {"f_number": 120.0, "film": 50.0}, "the stop is open from 300 to 239.999"),
    ],
)
def test_what_no_camera_can_do(name: str, arguments: dict, message: str, designs: dict[str, Lens]) -> None:
    with pytest.raises(CameraError, match=message):
        lens_camera(designs[name], HERE, THERE, **arguments)


def test_lenses_that_make_no_picture(designs: dict[str, Lens]) -> None:
    negative = [{"radius": -50.0, "thickness": 3.0, "index": 1.5, "stop": True}, {"radius": 50.0, "thickness": 50.0}]
    lens = lenstrace.lens(negative, {"entrance_pupil_diameter": 10.0}, [0.0], [0.55])
    with pytest.raises(CameraError, match="no real image of a plane inf from the film"):
        lens_camera(lens, HERE, THERE)
    with pytest.raises(CameraError, match="target must be another point than position"):
        lens_camera(designs["double_gauss"], HERE, HERE)
    with pytest.raises(PrescriptionError, match="break = true cannot be reversed"):
        lens_camera(designs["fold_mirror"], HERE, THERE, focus=None)
    with pytest.raises(PrescriptionError, match="no row is the stop"):
        lens_camera(designs["double_gauss"].replace(surface=6, stop=False), HERE, THERE)
    dark = dataclasses.replace(lens_camera(designs["double_gauss"], HERE, THERE), dispersion=None)
    with pytest.raises(CameraError, match="not known in visible light"):
        dark.rays(*places(4), jnp.full(4, 0.55))
