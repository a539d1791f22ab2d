"""One contract for every shape of a scene: crossings, values, normals, bounds and derivatives agree."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

from lenstrace.optics.shapes.shape import Shape, touch
from tests.optics.shapes.cases import (
    CASES,
    FARTHEST,
    aimed,
    crossings_by_sampling,
    first_ahead,
    found,
    normals,
    shape_of,
    units,
    value_normal_and_gradient,
)

EPS = {jnp.float32: 2.0**-23, jnp.float64: 2.0**-52}


@pytest.fixture(params=CASES)
def name(request: pytest.FixtureRequest) -> str:
    """Every shape."""
    return request.param


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e6])
@pytest.mark.parametrize("dtype", EPS)
def test_crossings_lie_on_the_surface(name: str, scale: float, dtype: Any) -> None:
    shape = shape_of(name, scale, dtype)
    point, direction = aimed(1, 500)
    distance, real = found(shape, scale * point, direction)
    assert real.any()
    place = scale * point[:, None] + distance.astype(float) * direction[:, None]
    exact = shape_of(name, scale)
    value, normal, _ = value_normal_and_gradient(exact, place)
    off = value / np.linalg.norm(normal, axis=0)
    # of a few coordinates as large as the distance of the start
    assert np.abs(off[real]).max() < 8 * EPS[dtype] * 3 * scale


def test_crossings_are_those_of_the_equation(name: str) -> None:
    case, shape = CASES[name], shape_of(name)
    point, direction = aimed(2, 100)
    distance, real = found(shape, point, direction)
    for i in range(100):
        expected = crossings_by_sampling(case, point[:, i], direction[:, i])
        got = np.sort(distance[real[:, i] & (distance[:, i] > 0) & (distance[:, i] < FARTHEST), i])
        assert_allclose(got, expected[:1] if case.one else expected, rtol=0, atol=2e-13, err_msg=f"ray {i}")


def test_crossings_from_inside_and_between_are_those_of_the_equation(name: str) -> None:
    case, shape = CASES[name], shape_of(name)
    point, direction = np.random.default_rng(3).uniform(-1, 1, (3, 70)), units(4, 70)
    distance, real = found(shape, point, direction)
    for i in range(70):
        expected = [t for t in crossings_by_sampling(case, point[:, i], direction[:, i]) if t > 0]
        got = np.sort(distance[real[:, i] & (distance[:, i] > 0) & (distance[:, i] < FARTHEST), i])
        assert_allclose(got, expected[:1] if case.one else expected, rtol=0, atol=2e-13, err_msg=f"ray {i}")


def test_the_normal_is_the_gradient_of_the_value(name: str) -> None:
    shape = shape_of(name)
    point, direction = aimed(5, 200)
    t = first_ahead(*found(shape, point, direction))
    met = np.isfinite(t)
    _, normal, gradient = value_normal_and_gradient(shape, (point + np.where(met, t, 0) * direction)[:, met])
    assert_allclose(normal, gradient, atol=3e-15)


def test_solids_are_negative_inside_and_open_shapes_face_the_axis(name: str) -> None:
    case, shape = CASES[name], shape_of(name)
    place = np.random.default_rng(6).uniform(-1.5, 1.5, (3, 500))
    if not case.solid:
        place[:, 0] = 0
    value, normal, _ = value_normal_and_gradient(shape, place)
    if case.solid:
        assert_allclose(np.sign(value), np.sign(case.equation(*place)))
    elif name != "triangle":
        assert normal[2, 0] == 1


def test_bounds_hold_all_crossings(name: str) -> None:
    shape = shape_of(name)
    point, direction = aimed(7, 500)
    distance, real = found(shape, point, direction)
    place = point[:, None] + distance * direction[:, None]
    lowest, highest = (np.asarray(corner)[:, None, None] for corner in shape.bounds())
    assert ((place >= lowest - 1e-14) & (place <= highest + 1e-14))[:, real].all()
    assert np.isfinite(lowest).all() == (name != "plane")


@jax.jit
def refined(shape: Shape, start: Any, direction: Any, near: Any) -> tuple[Any, Any, Any]:
    """The distance by `touch`, its derivatives by all numbers, and the second one by z."""

    def distance(shape: Shape, start: Any, direction: Any) -> jax.Array:
        return touch(shape, start, direction, near)

    def along_z(z: jax.Array) -> jax.Array:
        return jax.grad(lambda z: distance(shape, (*start[:2], z), direction))(z)

    value, slopes = jax.value_and_grad(distance, argnums=(0, 1, 2))(shape, start, direction)
    return value, slopes, jax.grad(along_z)(start[2])


@jax.jit
def searched(shape: Shape, start: Any, direction: Any) -> tuple[jax.Array, jax.Array]:
    """The smallest root > 0, and the derivative of `touch` by z there."""
    roots = shape.roots(start, direction, jnp.asarray(False))
    near = jnp.min(jnp.stack([jnp.where(real & (d > 0), d, jnp.inf) for d, real in roots]))
    return near, jax.grad(lambda z: touch(shape, (*start[:2], z), direction, near))(start[2])


def test_derivatives_of_the_distance(name: str) -> None:
    """By every number of the shape and of the start, to second order, against central differences."""
    shape = shape_of(name)
    point, direction = aimed(8, 300)
    t = first_ahead(*found(shape, point, direction))
    i = np.nonzero(np.isfinite(t))[0][0]
    start, way = (tuple(map(jnp.asarray, a[:, i])) for a in (point, direction))
    value, slopes, second = refined(shape, start, way, t[i])
    assert_allclose(value, t[i], atol=5e-15)
    leaves, tree = jax.tree.flatten((shape, start))
    step = 1e-6
    for j, (leaf, slope) in enumerate(zip(leaves, jax.tree.leaves(slopes[:2]), strict=True)):
        for k in filter(lambda _, leaf=leaf: np.isfinite(leaf).all(), np.ndindex(leaf.shape)):
            moves = step * (np.arange(leaf.size) == np.ravel_multi_index(k, leaf.shape)).reshape(leaf.shape)
            ends = [
                searched(*tree.unflatten([*leaves[:j], leaf + m, *leaves[j + 1 :]]), way)[0] for m in (moves, -moves)
            ]
            difference = (ends[0] - ends[1]) / (2 * step)
            assert_allclose(slope[k], difference, rtol=1e-6, atol=2e-8, err_msg=f"leaf {j}")
    rates = [searched(shape, (*start[:2], start[2] + s), way)[1] for s in (1e-5, -1e-5)]
    assert_allclose(second, (rates[0] - rates[1]) / 2e-5, rtol=1e-5, atol=1e-7)


def test_derivatives_are_finite_where_the_ray_is_tangent(name: str) -> None:
    shape = shape_of(name)
    point, direction = aimed(9, 300)
    t = first_ahead(*found(shape, point, direction))
    i = np.nonzero(np.isfinite(t))[0][0]
    place = point[:, i] + t[i] * direction[:, i]
    x, y, z = normals(shape, place[:, None])[:, 0]
    tangent = np.array([0.0, z, -y]) / np.hypot(y, z) if abs(x) < 0.5 else np.array([y, -x, 0.0])
    distance, slopes, _ = refined(
        shape, tuple(map(jnp.asarray, place)), tuple(map(jnp.asarray, tangent)), np.float64(0)
    )
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(slopes))
    assert float(distance) == 0


def test_a_ray_of_no_hit_leaves_derivatives_finite(name: str) -> None:
    shape = shape_of(name)

    def total(shape: Shape, y: jax.Array) -> jax.Array:
        zero = jnp.zeros(())
        roots = shape.roots((zero + 50, y, zero + 40), (zero, zero, zero + 1), jnp.asarray(False))
        distances = [touch(shape, (zero, y, zero), (zero, zero, zero + 1), d) for d, _ in roots]
        return jnp.sum(jnp.where(jnp.stack([real for _, real in roots]), jnp.stack(distances), 0))

    # every ray meets the plane; caps of aspheres are found as the torus is, and take the compiler long
    if name not in ("plane", "bowl", "wing"):
        gradient = jax.jit(jax.grad(total, argnums=(0, 1)))(shape, jnp.asarray(0.3))
        assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(gradient))
