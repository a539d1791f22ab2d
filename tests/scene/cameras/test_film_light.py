"""How much light a point of the film gets: against a trace in numpy that knows nothing of the camera."""

import dataclasses
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lenstrace import Aperture, Lens
from lenstrace.scene.cameras.focusing import focused
from lenstrace.scene.cameras.lens_camera import LensCamera, lens_camera

RIMS = [27.0, 24.0, 21.0, 17.0, 13.0, None, 12.5, 16.0, 17.0, 19.0, 19.5]  # of the double Gauss, mm; drawn here
COLUMNS = 200  # across the pupil, in the integrals of this file


def backward(lens: Lens, stop_radius: float, x: float, slope_x: np.ndarray, slope_y: np.ndarray, rims: bool) -> dict:
    """Rays from the point (x, 0) of the film of a lens of spheres and planes, against its light, in numpy.

    passes; transmission without coatings; lengths in the glasses behind each surface.
    """
    vertex = np.concatenate([[0], np.cumsum(lens.thickness)])
    index = np.asarray(lens.system.index)[lens.system.primary]
    direction = np.stack([slope_x, slope_y, -np.ones_like(slope_x)])
    direction = direction / np.sqrt((direction**2).sum(0))
    point = np.stack([np.full_like(slope_x, x), 0 * slope_x, np.full_like(slope_x, vertex[-1])])
    passes, transmission, lengths = np.ones(slope_x.shape, bool), np.ones(slope_x.shape), {}
    for number in range(len(lens), 0, -1):
        row, c = lens[number], float(lens.curvature[number - 1])
        local = point - np.array([0, 0, vertex[number - 1]])[:, None]
        if c == 0:
            t = -local[2] / direction[2]
        else:
            # |p + t d - (0, 0, R)|^2 = R^2, the root next to the vertex plane
            b = (local * direction).sum(0) - direction[2] / c
            square = b * b - (local**2).sum(0) + 2 * local[2] / c
            passes &= square >= 0
            root = np.sqrt(np.maximum(square, 0))
            t = np.where(np.sign(c) * direction[2] < 0, -b + root, -b - root)
        local, point = local + t * direction, point + t * direction
        lengths[number] = t
        r2 = local[0] ** 2 + local[1] ** 2
        if row.stop:
            passes &= r2 <= stop_radius**2
        elif rims and row.semi_diameter is not None:
            passes &= r2 <= row.semi_diameter**2
        normal = np.stack([-c * local[0], -c * local[1], 1 - c * local[2]])
        n1, n2 = index[number], index[number - 1]
        cosine = -(normal * direction).sum(0)
        inside = 1 - (n1 / n2) ** 2 * (1 - cosine**2)
        passes &= inside > 0
        after = np.sqrt(np.maximum(inside, 0))
        s = (n1 * cosine - n2 * after) / (n1 * cosine + n2 * after)
        p = (n2 * cosine - n1 * after) / (n2 * cosine + n1 * after)
        transmission = transmission * (1 - (s * s + p * p) / 2)
        direction = n1 / n2 * direction + (n1 / n2 * cosine - after) * normal
    return {"passes": passes, "transmission": transmission, "lengths": lengths}


def irradiance(lens: Lens, stop_radius: float, x: float, rims: bool = False, fresnel: bool = False) -> float:
    """Of the film point for a scene of radiance 1: the integral of cos^4 over the slopes (u, v) from which light comes.

    Its edges are found by bisection: first those in u where v = 0, then that in v at each of many u.
    """

    def passes(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return backward(lens, stop_radius, x, u, v, rims)["passes"]

    # about a point far before the last vertex, near the exit pupil
    u = -x / (2 * float(lens.rows[-1].thickness)) + np.linspace(-0.3, 0.3, 601)
    lit = u[passes(u, 0 * u)]
    inside, outside = np.array([lit[0], lit[-1]]), np.array([lit[0] - 1e-3, lit[-1] + 1e-3])
    low, high = _bisected(lambda u: passes(u, 0 * u), inside, outside)
    turn = (np.arange(COLUMNS) + 0.5) / COLUMNS * np.pi
    u = (low + high) / 2 - (high - low) / 2 * np.cos(turn)
    edge = _bisected(lambda v: passes(u, v), 0 * u, 0 * u + 0.4)
    node, weight = np.polynomial.legendre.leggauss(12)
    u, v = u[:, None] + 0 * node, edge[:, None] * (1 + node) / 2
    value = 1 / (1 + u * u + v * v) ** 2
    if fresnel:
        value = value * backward(lens, stop_radius, x, u.ravel(), v.ravel(), rims)["transmission"].reshape(u.shape)
    columns = np.sum(value * weight, 1) * edge
    return float(np.sum(columns * np.sin(turn)) * (high - low) / 2 * np.pi / COLUMNS)


def _bisected(passes: Callable[[np.ndarray], np.ndarray], inside: np.ndarray, outside: np.ndarray) -> np.ndarray:
    for _ in range(40):
        middle = (inside + outside) / 2
        here = passes(middle)
        inside, outside = np.where(here, middle, inside), np.where(here, outside, middle)
    return inside


traced = jax.jit(lambda camera, *places: camera.rays(*places))


def seen(camera: LensCamera, x: float, count: int = 1 << 15) -> float:
    """The mean weight: the white wall of radiance 1, at a place so far from the middle of the picture."""
    k = np.arange(count)
    u, v = (k + 0.5) / count, (k * (np.sqrt(5) - 1) / 2) % 1
    place = [jnp.full(count, part * x) for part in (0.8, 0.6)]
    return float(jnp.mean(traced(camera, *place, jnp.asarray(u), jnp.asarray(v), None).weight))


def with_rims(lens: Lens) -> Lens:
    rows = [dataclasses.replace(row, semi_diameter=rim) for row, rim in zip(lens.rows, RIMS, strict=True)]
    return dataclasses.replace(lens, rows=tuple(rows))


def of_50_mm(lens: Lens) -> Lens:
    diameter = lens.aperture.value / 2
    return lens.replace(
        curvature=lens.curvature * 2,
        thickness=lens.thickness / 2,
        aperture=Aperture(diameter, "entrance_pupil_diameter"),
    )


@pytest.fixture(scope="module")
def gauss(designs: dict[str, Lens]) -> Lens:
    return designs["double_gauss"]


@pytest.mark.parametrize(("size", "film", "f_number"), [(100, 48.0, None), (50, 24.0, None), (50, 24.0, 2.8)])
def test_a_white_wall_on_axis_and_off(gauss: Lens, size: int, film: float, f_number: float | None) -> None:
    lens = gauss if size == 100 else of_50_mm(gauss)
    camera = lens_camera(
        lens, (0, 0, 0), (0, 0, -1), film=film, focus=3000.0, f_number=f_number, irradiance=True, rims=False
    )
    opened = focused(lens, 3000.0, f_number=f_number)
    for x in (0.0, 0.5, 1.0, 1.5):
        exact = irradiance(opened, opened.aperture.value, x * film / 2)
        assert seen(camera, x) == pytest.approx(exact, rel=1e-3)


def test_the_middle_of_the_film_at_infinity(gauss: Lens) -> None:
    """pi / (4 N^2), for a lens that obeys the sine condition: sin u' = 1 / (2 N)."""
    camera = lens_camera(gauss, (0, 0, 0), (0, 0, -1), irradiance=True, rims=False, f_number=5.0)
    assert seen(camera, 0.0) == pytest.approx(np.pi / (4 * 5.0**2), rel=3e-3)


def test_vignetting_by_rims(gauss: Lens) -> None:
    lens, film = with_rims(gauss), 40.0
    camera = lens_camera(lens, (0, 0, 0), (0, 0, -1), film=film, f_number=3.0, irradiance=True)
    clear = lens_camera(lens, (0, 0, 0), (0, 0, -1), film=film, f_number=3.0, irradiance=True, rims=False)
    opened = focused(lens, np.inf, f_number=3.0)
    shares = []
    for x in (0.0, 0.8, 1.6, 2.0):
        exact = irradiance(opened, opened.aperture.value, x * film / 2, rims=True)
        assert seen(camera, x) == pytest.approx(exact, rel=2e-3, abs=1e-6)
        shares.append(exact / irradiance(opened, opened.aperture.value, x * film / 2))
        assert seen(clear, x) * shares[-1] == pytest.approx(seen(camera, x), rel=2e-3)
    assert shares[0] == 1
    assert shares[-1] < 0.7
    # the picture is normalized by its middle
    picture = lens_camera(lens, (0, 0, 0), (0, 0, -1), film=film, f_number=3.0)
    assert seen(picture, 0.0) == pytest.approx(1, rel=1e-3)
    assert seen(picture, 1.6) == pytest.approx(seen(camera, 1.6) / seen(camera, 0.0), rel=1e-3)


@pytest.mark.parametrize(
    ("name", "film", "focus", "um"),
    [
        ("double_gauss", 48.0, 1500.0, 0.45),
        ("phone_lens", 4.0, np.inf, None),
        ("hubble", 50.0, np.inf, None),
    ],
)
def test_the_bound_cuts_nothing_off(
    name: str, film: float, focus: float, um: float | None, designs: dict[str, Lens]
) -> None:
    """A bound twice as wide brings no more light, at any place of the film: the same samples of the pupil in both."""
    camera = lens_camera(designs[name], (0, 0, 0), (0, 0, -1), film=film, focus=focus)
    bound = camera.bound
    wide = dataclasses.replace(
        camera, bound=dataclasses.replace(bound, half_s=bound.half_s * 2, half_t=bound.half_t * 2, ellipse=False)
    )
    x, y, u, v = (jnp.asarray(a) for a in np.random.default_rng(1).uniform(size=(4, 8_000)))
    # what a lens without rims lets through far outside its field has no bound
    x, y = 0.8 * x, 0.8 * y
    colour = None if um is None else jnp.full(x.shape, um)
    ray = traced(wide, x, y, u, v, colour)
    lit = np.asarray(ray.weight) > 0
    radius = jnp.sqrt(x * x + y * y) * abs(camera.half_film)
    _, _, half_s, half_t = bound.at(radius)
    # places in the wide rectangle, in units of the half axes of the bound
    far = np.asarray((2 * (2 * u - 1)) ** 2 + (2 * (2 * v - 1)) ** 2)
    outside = lit & (far > 1)
    weight = np.asarray(ray.weight * half_s * half_t)
    assert lit.sum() > 1000
    assert weight[outside].sum() <= 1e-6 * weight[lit].sum()
    # and it is not much wider than needed
    narrow = traced(camera, x, y, u, v, colour)
    middle = np.asarray(radius) < 0.3 * np.asarray(radius).max()
    assert (np.asarray(narrow.weight) > 0)[middle].mean() > 0.78


def test_reflection_losses(gauss: Lens) -> None:
    lens, film = gauss, 48.0
    camera = lens_camera(lens, (0, 0, 0), (0, 0, -1), film=film, rims=False, irradiance=True, fresnel=True)
    opened = focused(lens, np.inf)
    for x in (0.0, 1.3):
        exact = irradiance(opened, opened.aperture.value, x * film / 2, fresnel=True)
        assert seen(camera, x) == pytest.approx(exact, rel=1e-3)
    # on the axis: the product of 1 - ((n1 - n2) / (n1 + n2))^2
    index = np.asarray(lens.system.index)[1]
    normal = np.prod(1 - ((index[1:] - index[:-1]) / (index[1:] + index[:-1])) ** 2)
    clear = lens_camera(lens, (0, 0, 0), (0, 0, -1), film=film, rims=False, irradiance=True)
    assert seen(camera, 0.0) / seen(clear, 0.0) == pytest.approx(normal, rel=2e-3)


def test_absorption(gauss: Lens) -> None:
    lens, amounts = gauss, {1: 0.01, 3: 0.02, 10: 0.005}
    kwargs = {"film": 48.0, "rims": False, "irradiance": True}
    dark = lens_camera(lens, (0, 0, 0), (0, 0, -1), absorption=amounts, **kwargs)
    clear = lens_camera(lens, (0, 0, 0), (0, 0, -1), **kwargs)
    u, v = jnp.asarray([0.5, 0.3, 0.8, 0.61]), jnp.asarray([0.5, 0.6, 0.4, 0.33])
    x = jnp.asarray([0.0, 0.2, 0.7, 1.2])
    opened = focused(lens, np.inf)
    slope_x, slope_y, _ = clear._slopes(x * clear.half_film, 0 * x, u, v)
    got = traced(dark, x, 0 * x, u, v, None).weight / traced(clear, x, 0 * x, u, v, None).weight
    for i in range(4):
        one = (np.asarray(a)[i : i + 1] for a in (slope_x, slope_y))
        found = backward(opened, 1e3, float(x[i] * clear.half_film), *one, False)
        # the way behind a surface is the one that ends at it, counted from the film
        exact = np.exp(-sum(a * found["lengths"][number][0] for number, a in amounts.items()))
        assert float(got[i]) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("rims", [False, True])
def test_derivatives_of_the_light(gauss: Lens, rims: bool) -> None:
    """Of the irradiance by a curvature, at a fixed radius of the stop and place of the film: the edge of the pupil
    moves, which no sample sees."""
    film, step = 40.0, 5e-4
    stopped = with_rims(gauss).replace(aperture=Aperture(7.0, "stop_semi_diameter"))
    u, v = (jnp.asarray(a) for a in np.random.default_rng(0).uniform(size=(2, 1024)))

    def light(curvature: jax.Array, x: jax.Array) -> jax.Array:
        lens = stopped.replace(curvature=curvature)
        camera = lens_camera(lens, (0, 0, 0), (0, 0, -1), film=film, focus=None, irradiance=True, rims=rims)
        return jnp.mean(camera.rays(0 * u + x, 0 * u, u, v, None).weight)

    derivative = jax.jit(lambda c, x, toward: jax.jvp(lambda c: light(c, x), (c,), (toward,)))
    for surface, x in ((10, 1.6),) if rims else ((10, 0.0), (7, 1.5)):
        c, toward = np.asarray(gauss.curvature), np.eye(11)[surface - 1]
        value, slope = derivative(jnp.asarray(c), jnp.asarray(x), jnp.asarray(toward))
        exact = [irradiance(stopped.replace(curvature=c + d * toward), 7.0, x * film / 2, rims) for d in (-step, step)]
        want = (exact[1] - exact[0]) / (exact[1] + exact[0]) / step
        # a rim that moves across the pupil changes the form of its edge as well
        assert float(slope / value) == pytest.approx(want, rel=0.06 if rims else 0.01)
