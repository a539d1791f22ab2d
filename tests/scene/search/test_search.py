"""The nearest of many primitives: all ways agree, nothing leaks, and derivatives are those of what is met."""

from __future__ import annotations

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lenstrace.compute.blocks import each
from lenstrace.compute.tiles import each_tile
from lenstrace.optics.shapes.sphere import Sphere
from lenstrace.scene.build import world_of
from lenstrace.scene.hits import blocked, intersect, nearest
from lenstrace.scene.materials.diffuse import Diffuse
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.mesh_formula import formula_mesh
from lenstrace.scene.objects import Object, Scene
from lenstrace.scene.rays import NOWHERE, SceneRay
from lenstrace.scene.search.embree import Embree, available
from lenstrace.scene.search.hierarchy import Hierarchy
from lenstrace.scene.search.kind import Way, has_callback
from lenstrace.scene.world import World

GREY = Diffuse((0.5, 0.5, 0.5))
WAYS = [
    Way.ALL,
    Way.HIERARCHY,
    pytest.param(Way.EMBREE, marks=pytest.mark.skipif(not available(), reason="embreex is not installed")),
]
PRECISIONS = [np.float32, np.float64]


def _world(shape: Any, dtype: Any, way: Way, **settings: Any) -> World:
    return world_of(Scene([Object(shape, GREY, **settings)]), dtype, way)


def _run(function: Any, world: World, rays: Any) -> Any:
    """In the way that a picture is made."""
    run = each_tile if has_callback(world.searches) else each
    return jax.tree.map(np.asarray, run(function, world, rays))


def _ray(point: np.ndarray, direction: np.ndarray, dtype: Any, start: Any = None) -> SceneRay:
    start = np.full(len(point), NOWHERE, np.int32) if start is None else start
    x, y, z = (jnp.asarray(a, dtype) for a in np.asarray(point).T)
    l, m, n = (jnp.asarray(a, dtype) for a in np.asarray(direction).T)
    return SceneRay((x, y, z), (l, m, n), jnp.asarray(start, jnp.int32))


def _directions(count: int, random: np.random.Generator) -> np.ndarray:
    direction = random.normal(size=(count, 3))
    return direction / np.linalg.norm(direction, axis=1, keepdims=True)


def _inside_ball(count: int, radius: float, random: np.random.Generator) -> np.ndarray:
    return _directions(count, random) * radius * random.random((count, 1)) ** (1 / 3)


def _nearest(world: World, ray: SceneRay) -> Any:
    return nearest(world, ray)


def _intersect(world: World, ray: SceneRay) -> Any:
    return intersect(world, ray)


def _onward(world: World, ray: SceneRay) -> SceneRay:
    hit = intersect(world, ray)
    return ray.onward(hit.point, hit.normal, hit.primitive)


def _blocked(world: World, asked: Any) -> Any:
    return blocked(world, *asked)


@functools.cache
def _by_asking_all(
    mesh: str, across: int, down: int, reach: float, dtype: Any, count: int
) -> tuple[Mesh, SceneRay, Any]:
    """A mesh, rays from all over a ball, and what they meet."""
    random = np.random.default_rng(1)
    made = formula_mesh(mesh, across, down)
    ray = _ray(_inside_ball(count, reach, random), _directions(count, random), dtype)
    return made, ray, _run(_nearest, _world(made, dtype, Way.ALL), ray)


@pytest.mark.parametrize("dtype", PRECISIONS)
@pytest.mark.parametrize("way", WAYS[1:])
def test_meets_what_asking_all_meets(way: Way, dtype: Any) -> None:
    mesh, ray, (all_t, all_number) = _by_asking_all("rippled sphere", 40, 20, 1.2, dtype, 4_000)
    t, number = _run(_nearest, _world(mesh, dtype, way), ray)
    met = all_number != NOWHERE
    assert 0.5 < met.mean() < 0.95
    same = number == all_number
    if way is Way.HIERARCHY:
        assert same.all()
        # two programs: one may fuse a product with a sum where the other does not
        assert (np.abs(t[met] - all_t[met]) <= 8 * np.finfo(dtype).eps).all()
        assert np.isinf(t[~met]).all()
    # ties at edges that two triangles share, by single precision
    assert (~same).sum() <= 3
    assert (np.isfinite(t) == np.isfinite(all_t)).sum() >= len(t) - 1
    both = met & np.isfinite(t)
    assert np.abs(t[both] - all_t[both]).max() < 4e-6


@pytest.mark.parametrize("dtype", PRECISIONS)
def test_many_spheres_go_through_a_hierarchy(dtype: Any) -> None:
    random = np.random.default_rng(2)
    objects = [
        Object(Sphere(radius), GREY, tuple(place), motion=(0.05, 0.0, 0.02))  # type: ignore[arg-type]
        for place, radius in zip(random.uniform(-1, 1, (300, 3)), random.uniform(0.01, 0.1, 300), strict=True)
    ]
    tree, every = (world_of(Scene(objects), dtype, way) for way in (Way.AUTO, Way.ALL))
    assert isinstance(tree.searches[0], Hierarchy)
    assert every.searches == (None,)
    ray = _ray(_inside_ball(6_000, 1.5, random), _directions(6_000, random), dtype)
    ray = SceneRay(ray.point, ray.direction, ray.start, jnp.asarray(random.uniform(-0.5, 0.5, 6_000), dtype))
    (t, number), (all_t, all_number) = (_run(_nearest, world, ray) for world in (tree, every))
    assert (number == all_number).all()
    met = number != NOWHERE
    # grazed spheres are met to the root of a rounding error alone
    apart = np.abs(t[met] - all_t[met])
    assert np.quantile(apart, 0.99) < 10 * np.finfo(dtype).eps
    assert apart.max() < np.sqrt(np.finfo(dtype).eps)
    # and from where they begin on a sphere
    onward = _run(_onward, every, ray)
    assert (_run(_nearest, tree, onward)[1] == _run(_nearest, every, onward)[1]).all()


@pytest.mark.parametrize("way", WAYS)
def test_blocked(way: Way) -> None:
    mesh, ray, (t, number) = _by_asking_all("torus knot", 60, 12, 3, np.float64, 2_000)
    world = _world(mesh, np.float64, way)
    met = number != NOWHERE
    assert 0.2 < met.mean() < 0.9
    nobody = jnp.full(met.shape, NOWHERE, jnp.int32)
    far = jnp.where(met, t, 1.0)
    # single precision tells no distances apart right at the beginning
    near = (t > 0.05) | ~met
    for factor, expected in ((1 - 1e-4, np.zeros_like(met)), (1 + 1e-4, met), (np.inf, met), (0.0, np.zeros_like(met))):
        found = _run(_blocked, world, (ray, jnp.where(far > 0, far * factor, 0), nobody))
        # a grazed edge may be met in single precision alone
        assert (found != expected)[near].sum() <= (2 if way is Way.EMBREE else 0)
    # the target itself does not stand in its own light
    target = jnp.asarray(number, jnp.int32)
    assert not _run(_blocked, world, (ray, far * (1 + 1e-9), target))[near & met].any()


@pytest.mark.parametrize("dtype", PRECISIONS)
@pytest.mark.parametrize("way", WAYS)
def test_no_ray_goes_through_an_edge_or_a_corner(way: Way, dtype: Any) -> None:
    mesh = formula_mesh("rippled sphere", 20, 10)
    a, b = (mesh.vertices[mesh.faces[:, i]] for i in (0, 1))
    aims = np.concatenate([mesh.vertices, *(a + s * (b - a) for s in (0.5, 0.25, 0.3, 1e-3))])
    aims = np.concatenate([aims, aims * [1, 1, -1], aims[:, [1, 2, 0]]])
    world = _world(mesh, dtype, way)
    for middle in ([0, 0, 0], [0.1, -0.2, 0.3]):
        way_there = aims - np.array(middle)
        way_there /= np.linalg.norm(way_there, axis=1, keepdims=True)
        _, number = _run(_nearest, world, _ray(np.full_like(aims, middle), way_there, dtype))
        assert (number != NOWHERE).all()


def _bounce(world: World, asked: tuple[SceneRay, Any]) -> Any:
    """Onward from what is met, to the side that the ray came from."""
    ray, onward = asked
    hit = intersect(world, ray)
    toward = sum(d * n for d, n in zip(onward, hit.normal, strict=True))
    cosine = sum(d * n for d, n in zip(ray.direction, hit.normal, strict=True))
    sign = jnp.where(toward > 0, -1, 1).astype(toward.dtype)
    x, y, z = (sign * d for d in onward)
    return hit.met, cosine, hit.primitive == ray.start, ray.onward(hit.point, (x, y, z), hit.primitive)


@pytest.mark.parametrize(("scale", "shift"), [(1, 0), (1e-3, 0), (1e6, 0), (1, 10), (1e-3, 1)])
@pytest.mark.parametrize("dtype", PRECISIONS)
@pytest.mark.parametrize("way", WAYS[1:])
def test_light_never_leaves_a_closed_mesh(way: Way, dtype: Any, scale: float, shift: float) -> None:
    random, count = np.random.default_rng(4), 1 << 16 if way is Way.EMBREE else 1 << 14
    mesh = formula_mesh("rippled sphere", 72, 36)
    middle = shift * np.array([1, -0.7, 0.3])
    world = _world(Mesh(mesh.vertices * scale + middle, mesh.faces), dtype, way)
    ray = _ray(np.full((count, 3), middle), _directions(count, random), dtype)
    for _ in range(3):
        onward = tuple(jnp.asarray(a, dtype) for a in _directions(count, random).T)
        met, cosine, again, ray = _run(_bounce, world, (ray, onward))
        assert met.all()
        # no wall is met from outside, but for rays along it
        assert (cosine > -1e-4).all()
        assert not again.any()


@pytest.mark.parametrize("way", WAYS)
def test_without_the_move_off_the_triangle_light_leaks(way: Way) -> None:
    """The test above can fail: a ray that begins beyond an edge, as rounding may put it, is brought back."""
    mesh = formula_mesh("superquadric", 24, 12, {"north": 1, "east": 1})
    world = _world(mesh, np.float64, way)
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    # just outside the mesh beside the middle of an edge of each face
    start = (a + b) / 2 * (1 + 1e-6)
    inward = -np.cross(b - a, c - a)
    inward /= np.linalg.norm(inward, axis=1, keepdims=True)
    slant = (a + b) / 2 - c
    slant = slant / np.linalg.norm(slant, axis=1, keepdims=True) + 0.02 * inward
    slant /= np.linalg.norm(slant, axis=1, keepdims=True)
    numbers = np.arange(len(mesh), dtype=np.int32)
    lost = _run(_nearest, world, _ray(start, slant, np.float64))[1] == NOWHERE
    assert lost.mean() > 0.3
    kept = _run(_nearest, world, _ray(start, slant, np.float64, numbers))[1] != NOWHERE
    assert kept.all()


@pytest.mark.parametrize("way", WAYS[1:])
def test_derivatives_of_the_distance(way: Way) -> None:
    mesh = formula_mesh("rippled sphere", 24, 12)
    world = _world(mesh, np.float64, way)
    ray = _ray(np.array([[0.1, 0.2, -0.1]]), np.array([[0.48, 0.6, 0.64]]), np.float64)
    kind = world.primitives.kinds[0]

    def distance(moved: Any, scale: jax.Array) -> jax.Array:
        point = tuple(p + m for p, m in zip(ray.point, moved, strict=True))
        shape = jax.tree.map(lambda a: a * scale, kind.shape)
        primitives = jax.tree_util.tree_map(lambda a: a, world.primitives)
        primitives = type(primitives)((type(kind)(shape, None, kind.number),), primitives.kind, primitives.place)
        changed = type(world)(primitives, *[getattr(world, n) for n in list(world.__dataclass_fields__)[1:]])
        return intersect(changed, SceneRay(point, ray.direction, ray.start)).distance[0]

    zero = (jnp.zeros(()),) * 3
    run = jax.jit(jax.value_and_grad(distance, (0, 1)))
    _, slopes = run(zero, jnp.ones(()))

    def value(moved: Any, scale: Any) -> Any:
        return run(moved, scale)[0]

    step = 1e-6
    for i in range(3):
        there, back = (tuple(s * step * (j == i) + jnp.zeros(()) for j in range(3)) for s in (1, -1))
        difference = (value(there, jnp.ones(())) - value(back, jnp.ones(()))) / (2 * step)
        assert slopes[0][i] == pytest.approx(float(difference), rel=1e-6, abs=1e-9)
    # larger by a factor: the tree stands where it was, and the triangle that was met is met
    difference = (value(zero, jnp.ones(()) + step) - value(zero, jnp.ones(()) - step)) / (2 * step)
    assert slopes[1] == pytest.approx(float(difference), rel=1e-6)


def test_auto() -> None:
    few, many = formula_mesh("rippled sphere", 6, 3), formula_mesh("rippled sphere", 12, 6)
    assert _world(few, np.float32, Way.AUTO).searches == (None,)
    assert isinstance(_world(many, np.float32, Way.AUTO).searches[0], Embree if available() else Hierarchy)
    assert isinstance(_world(many, np.float32, Way.HIERARCHY).searches[0], Hierarchy)


def test_meshes_among_other_objects() -> None:
    """Numbers, materials and lights of triangles are those of their objects."""
    mesh, red, blue = formula_mesh("rippled sphere", 12, 6), Diffuse((0.9, 0.1, 0.1)), Diffuse((0.1, 0.1, 0.9))
    scene = Scene(
        [
            Object(mesh, red, (0, 0, 5)),
            Object(Sphere(1.0), blue, (0, 0, -5)),
            Object(mesh, blue, (0, 5, 0), emission=(1.0, 2.0, 3.0)),
        ]
    )
    for way in (Way.ALL, Way.HIERARCHY, Way.AUTO):
        world = world_of(scene, np.float64, way)
        assert world.light is not None
        direction = np.array([[0, 0, 1], [0, 0, -1], [0, 1, 0], [1, 0, 0]], float)
        t, number = _run(_nearest, world, _ray(np.zeros((4, 3)), direction, np.float64))
        assert np.isfinite(t).tolist() == [True, True, True, False]
        assert t[1] == pytest.approx(4)
        material, light = np.asarray(world.material)[number[:3]], np.asarray(world.light)[number[:3]]
        albedos = [np.asarray(world.materials.kinds[0].albedo)[:, place] for place in material]
        assert np.allclose(albedos, [(0.9, 0.1, 0.1), (0.1, 0.1, 0.9), (0.1, 0.1, 0.9)])
        assert (light >= 0).tolist() == [False, False, True]
        assert world.lights is not None
        lights = world.lights.kinds[0]
        assert np.asarray(lights.number)[light[2]] == number[2]
        # a triangle is chosen by its area
        shares = np.diff(np.asarray(world.chosen), prepend=0)
        areas = np.asarray(lights.shape.area())
        assert np.allclose(shares, areas / areas.sum(), rtol=1e-9)


@pytest.mark.skipif(not available(), reason="embreex is not installed")
def test_call_back_from_several_threads_and_under_vmap() -> None:
    random, count = np.random.default_rng(5), 1 << 15
    world = _world(formula_mesh("rippled sphere", 24, 12), np.float32, Way.EMBREE)
    ray = _ray(_inside_ball(count, 0.5, random), _directions(count, random), np.float32)
    t, number = _run(_nearest, world, ray)
    small = jax.tree.map(np.asarray, each_tile(_nearest, world, ray, 1 << 11))
    assert (small[0] == t).all()
    assert (small[1] == number).all()
    rows = jax.tree.map(lambda a: a.reshape(8, -1), ray)
    folded = jax.jit(jax.vmap(_nearest, (None, 0)))(world, rows)
    assert (np.asarray(folded[1]).ravel() == number).all()
