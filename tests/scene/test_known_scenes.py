"""Scenes whose pictures are known: by geometry, by series, by integrals done by hand."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lenstrace.optics.shapes.plane import Plane
from lenstrace.optics.shapes.rectangle import Rectangle
from lenstrace.optics.shapes.sphere import Sphere
from lenstrace.scene.build import world_of
from lenstrace.scene.cameras.simple import Orthographic, Pinhole, ThinLens
from lenstrace.scene.cameras.view import View
from lenstrace.scene.draws import Draws
from lenstrace.scene.lights.delta import DistantLight, PointLight
from lenstrace.scene.materials.dielectric import Dielectric
from lenstrace.scene.materials.diffuse import Diffuse
from lenstrace.scene.materials.material import Place
from lenstrace.scene.materials.mirror import Mirror
from lenstrace.scene.methods.method import method_of
from lenstrace.scene.objects import Object, Scene
from lenstrace.scene.rays import SceneRay, nowhere
from lenstrace.scene.render import render

WHITE = Diffuse((1.0, 1.0, 1.0))
FLOOR = Object(Plane(), WHITE, rotation=(-90, 0, 0))


def seen(scene, points, directions, method="cast", depth=None, threshold=None, draws=1):
    """Radiance along rays in float64, and how many were traced, for each; the mean over `draws` samples."""
    world = world_of(scene, np.float64)
    points, directions = (np.broadcast_to(np.asarray(a, float), np.shape(points)) for a in (points, directions))
    points, directions = (np.repeat(a.reshape(-1, 3), draws, 0) for a in (points, directions))
    directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    start = nowhere(points[:, 0])
    ray = SceneRay(tuple(map(jnp.asarray, points.T)), tuple(map(jnp.asarray, directions.T)), start)
    words = jnp.arange(len(points), dtype=jnp.uint32)
    how = method_of(method, depth, threshold, np.float64)
    colour, rays = jax.jit(lambda: how.radiance(world, ray, Draws(words, words, jnp.uint32(1))))()
    values = np.stack([np.asarray(c) for c in colour], -1).reshape(-1, draws, 3)
    return values, np.asarray(rays).reshape(-1, draws)


def test_shadow_of_a_sphere():
    """r = .5 at height 1 under a light at height 4: the tangent cone meets the floor at .676123403782813."""
    scene = Scene([FLOOR, Object(Sphere(0.5), WHITE, (0, 1, 0))], [PointLight((0, 4, 0), 1.0)])
    radius = 0.676123403782813
    x = radius + np.array([-1e-12, 1e-12])
    below = np.stack([x, 0 * x + 0.3, 0 * x], -1)
    dark, lit = seen(scene, below, (0, -1, 0))[0][:, 0, 0]
    assert dark == 0
    # E = I cos / d^2, radiance E / pi
    assert lit == pytest.approx(4 / (16 + radius**2) ** 1.5 / np.pi, rel=1e-11)


@pytest.mark.parametrize(("reflectance", "bounces"), [(0.5, 8), (0.9, 53), (0.95, 109)])
def test_parallel_mirrors_end_by_the_threshold(reflectance, bounces):
    """The ray that would carry less than 1 / 255 is not traced: that many surfaces are met."""
    mirror = Mirror(reflectance)
    scene = Scene([Object(Plane(), mirror), Object(Plane(), mirror, (0, 0, 1), (180, 0, 0))])
    _, rays = seen(scene, [(0, 0, 0.5)], (0.01, 0, 1), "whitted", depth=1000)
    assert rays[0, 0] == bounces


def test_each_of_whitteds_stops_alone():
    mirror = Object(Plane(), Mirror(1.0))
    start, up = [(0, 0, 0.5)], (0.0, 0.3, -1)
    # nothing is hit
    assert seen(Scene([mirror], environment=1.0), start, up, "whitted", threshold=0.0)[1][0, 0] == 2
    # a diffuse surface
    two = Scene([mirror, Object(Plane(), WHITE, (0, 0, 1))])
    assert seen(two, start, up, "whitted", threshold=0.0)[1][0, 0] == 2
    # depth
    four = Scene([mirror, Object(Plane(), mirror.material, (0, 0, 1))])
    assert seen(four, start, up, "whitted", depth=7, threshold=0.0)[1][0, 0] == 7


def test_glass_slab_by_a_tree_of_rays():
    """Unpolarized at normal incidence 12 / 13 of the light behind a slab of n = 1.5 comes through."""
    slab = (
        Object(Rectangle(9.0, 9.0), Dielectric(1.5), rotation=(180, 0, 0)),
        Object(Rectangle(9.0, 9.0), Dielectric(1.5), (0, 0, 1)),
    )
    lamp = Object(Rectangle(9.0, 9.0), Diffuse(0.0), (0, 0, 5), (180, 0, 0), emission=1.0)
    scene = Scene([*slab, lamp])
    for depth, value in ((3, 0.9216), (5, 0.92307456), (7, 0.923076919296)):
        found = seen(scene, [(0, 0, -3)], (0, 0, 1), "whitted", depth, 0.0)[0][0, 0, 0]
        assert found == pytest.approx(value, rel=1e-12)
    assert seen(scene, [(0, 0, -3)], (0, 0, 1), "whitted", 99, 1e-9)[0][0, 0, 0] == pytest.approx(12 / 13, rel=1e-8)
    by_chance = seen(scene, [(0, 0, -3)], (0, 0, 1), "path", 40, draws=100_000)[0][0, :, 0]
    assert by_chance.mean() == pytest.approx(12 / 13, abs=4 * by_chance.std() / 100_000**0.5)


def test_radiance_in_glass_is_denser():
    """Seen from inside glass a lamp outside has n^2 of its radiance, less what is reflected."""
    scene = Scene(
        [
            Object(Plane(), Dielectric(1.5)),
            Object(Rectangle(50.0, 50.0), Diffuse(0.0), (0, 0, 5), (180, 0, 0), emission=1.0),
        ]
    )
    found = seen(scene, [(0, 0, -3)], (0, 0, 1), "path", 9, draws=50_000)[0][0, :, 0]
    assert found.mean() == pytest.approx(0.96 * 1.5**2, abs=4 * found.std() / 50_000**0.5)


@pytest.mark.parametrize(("terms", "value"), [(1, 0.5), (2, 0.75), (4, 0.9375), (8, 0.99609375), (16, 0.9999847412)])
def test_white_furnace(terms, value):
    """Between walls all around that shine with .5 and give back half: .5 sum of .5^k, from any place."""
    walls = [
        Object(Rectangle(1.0, 1.0), Diffuse(0.5), position, rotation, emission=0.5)
        for position, rotation in (
            ((0, 0, -1), (0, 0, 0)),
            ((0, 0, 1), (180, 0, 0)),
            ((0, -1, 0), (-90, 0, 0)),
            ((0, 1, 0), (90, 0, 0)),
            ((-1, 0, 0), (0, 90, 0)),
            ((1, 0, 0), (0, -90, 0)),
        )
    ]
    found = seen(Scene(walls), [(0.1, 0.2, 0.3)], (0.3, -0.2, 0.7), "path", terms, draws=40_000)[0][0, :, 0]
    assert found.mean() == pytest.approx(value, abs=max(4 * found.std() / 200, 1e-12))


def test_form_factor_of_an_element_under_a_square():
    """A 1 x 1 light at h = 1 above an element: .239456470460774, with a standard error below 1e-4."""
    lamp = Object(Rectangle(0.5, 0.5), Diffuse(0.0), (0, 1, 0), (90, 0, 0), emission=1.0)
    found = seen(Scene([FLOOR, lamp]), [(0, 0.5, 0)], (0, -1, 0), "path", 2, draws=400_000)[0][0, :, 0]
    error = found.std() / 400_000**0.5
    assert error < 1e-4
    assert found.mean() == pytest.approx(0.239456470460774, abs=4 * error)


def test_light_from_all_around():
    """Under an even sky a white floor is as bright as the sky; both ways of finding it are joined rightly."""
    found = seen(Scene([FLOOR], environment=(0.7, 0.7, 0.7)), [(0, 1, 0)], (0, -1, 0), "path", 2, draws=50_000)[0][0]
    assert found[:, 0].mean() == pytest.approx(0.7, abs=4 * found[:, 0].std() / 50_000**0.5)


def test_light_of_a_map_is_where_the_map_says():
    """One bright cell of a map of 8 x 16: irradiance of the floor is its integral of cos."""
    cells = np.zeros((8, 16, 3))
    cells[2, 5] = 10.0
    scene = Scene([FLOOR], environment=cells)
    found = seen(scene, [(0, 1, 0)], (0, -1, 0), "path", 2, draws=100_000)[0][0, :, 0]
    # rows of equal height: cos from .5 to .25, integral of cos over the solid angle
    expected = 10 * (0.5**2 - 0.25**2) / 2 * 2 * np.pi / 16 / np.pi
    assert found.mean() == pytest.approx(expected, abs=4 * found.std() / 100_000**0.5)
    angle = 2 * np.pi * 5.5 / 16
    toward = np.array([0.9 * np.sin(angle), 0.4, 0.9 * np.cos(angle)])
    assert seen(scene, [(0, 1, 0)], toward, "cast")[0][0, 0, 0] == 10


def test_sun_at_an_angle():
    scene = Scene([FLOOR], [DistantLight((1, -1, 0), 3.0)])
    found = seen(scene, [(0, 1, 0)], (0, -1, 0))[0][0, 0, 0]
    assert found == pytest.approx(3 / np.sqrt(2) / np.pi, rel=1e-12)


def test_circle_of_confusion():
    """50 mm f/2 focused at 2 m, a point at 4 m: .320512820513 mm on the film."""
    lens = ThinLens(View((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), 50.0, 2.0, 2000.0, 24.0)
    assert lens.circle_of_confusion(4000.0) == pytest.approx(0.320512820513, rel=1e-11)
    # rays through the rim that meet at 4 m on the axis: how far from the middle of the film they begin
    u = jnp.asarray([1 - 1e-16, 0.0])
    x = lens.circle_of_confusion(4000.0) / 2 / (24 / 2) * jnp.asarray([1.0, -1.0])
    seen_by = lens.rays(x, 0 * x, u, 0 * u + 0.5, None)
    at = [p + d * (4000 / -seen_by.direction[2]) for p, d in zip(seen_by.point, seen_by.direction, strict=True)]
    np.testing.assert_allclose(at[0], 0, atol=1e-9)


def test_pictures_are_upright():
    """A lamp at the upper right is in the picture's upper right, for every camera."""
    lamp = Object(Sphere(0.4), Diffuse(0.0), (1.0, 1.0, 0.0), emission=1.0)
    view = View((0.0, 0.0, 10.0), (0.0, 0.0, 0.0))
    for camera in (Pinhole(view, 30.0), Orthographic(view, 5.0), ThinLens(view, 5.0, 4.0, 10.0, 2.7)):
        picture = render(Scene([lamp]), camera, size=(32, 32), method="cast", samples=4)
        rows, columns = np.nonzero(picture.radiance[..., 0] > 0)
        assert 0 < len(rows) < 200
        assert rows.max() < 16
        assert columns.min() >= 16


def test_directions_by_the_cosine_are_less_noisy() -> None:
    """Irradiance over pi of a sky of radiance cos(theta): variance 1/18 by the directions of a matt surface, of which
    each counts f cos L / density = cos, and 16/45 by uniform ones, of which each counts 2 cos^2; by hand."""
    u, v, w = (jnp.asarray(a) for a in np.random.default_rng(4).random((3, 1_000_000)))
    place = Place((0 * u, 0 * u, 0 * u), jnp.ones(u.shape, bool), None)
    outgoing = 0 * u, 0 * u, 1 + 0 * u
    incoming, weight, _ = WHITE.sample(place, outgoing, u, v, w)
    by_cosine = np.asarray(weight[0] * incoming[2])
    # the height of a point of the half sphere is uniform
    uniform = jnp.sqrt(1 - u * u) * jnp.cos(2 * np.pi * v), jnp.sqrt(1 - u * u) * jnp.sin(2 * np.pi * v), u
    value, _ = WHITE.evaluate(place, outgoing, uniform)
    by_chance = np.asarray(value[0] * u) * 2 * np.pi
    for found, variance in ((by_cosine, 1 / 18), (by_chance, 16 / 45)):
        assert found.mean() == pytest.approx(2 / 3, abs=3e-3)
        assert found.var() == pytest.approx(variance, rel=5e-3)
    assert by_chance.var() / by_cosine.var() == pytest.approx(6.4, abs=0.05)
