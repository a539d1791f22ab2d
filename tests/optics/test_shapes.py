"""One contract for every shape: sag, normal and crossing agree with each other and with closed forms."""

import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from mpmath import mp
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from lenstrace.optics.rays import RayStatus
from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.shapes.crossing import Crossing
from lenstrace.optics.vectors import Vector

SHAPES = {
    "plane": Conic(jnp.array(0.0), jnp.array(0.0)),
    "sphere": Conic(jnp.array(1 / 50), jnp.array(0.0)),
    "concave": Conic(jnp.array(-1 / 30), jnp.array(0.0)),
    "parabola": Conic(jnp.array(1 / 40), jnp.array(-1.0)),
    "hyperbola": Conic(jnp.array(-1 / 25), jnp.array(-3.0)),
    "oblate": Conic(jnp.array(1 / 60), jnp.array(5.0)),
    "asphere": Asphere(
        jnp.array(1 / 40), jnp.array(-0.5), jnp.array([0.04096, -0.031457, 0.002684]), jnp.array(16.0), (4, 6, 8)
    ),
    "odd": Asphere(
        jnp.array(1 / 50),
        jnp.array(0.3),
        jnp.array([8e-4, 1.92e-3, -4.096e-4, 6.5536e-4]),
        jnp.array(8.0),
        (2, 3, 5, 6),
    ),
    "flat asphere": Asphere(jnp.array(0.0), jnp.array(0.0), jnp.array([2e-3, 1e-6]), jnp.array(1.0), (2, 4)),
}
# Python's numbers become arrays of another kind than those of numpy: one program serves all
SHAPES = {name: jax.tree.map(lambda a: jnp.asarray(a, float), shape) for name, shape in SHAPES.items()}


@pytest.fixture(params=SHAPES)
def shape(request: pytest.FixtureRequest) -> Conic | Asphere:
    """A shape."""
    return SHAPES[request.param]


def rays(seed: int, count: int = 200) -> tuple[np.ndarray, np.ndarray]:
    """Points on the vertex plane within 10 mm and directions within 35 degrees of +z."""
    generator = np.random.default_rng(seed)
    x, y = generator.uniform(-7, 7, (2, count))
    angle, turn = generator.uniform(0, 0.6, count), generator.uniform(0, 2 * np.pi, count)
    direction = np.array([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)])
    return np.array([x, y, np.zeros(count)]), direction


@jax.jit
def crossed(shape: Conic | Asphere, point: Vector, direction: Vector, side: jax.Array) -> Crossing:
    """What is met."""
    return shape.crossing(point, direction, side)


@jax.jit
def sag_of_one(shape: Conic | Asphere, x: jax.Array, y: jax.Array) -> jax.Array:
    """Of two numbers."""
    return shape.sag(x, y)


@jax.jit
def sag_and_slopes(shape: Conic | Asphere, x: jax.Array, y: jax.Array) -> tuple[jax.Array, Any]:
    """Of arrays of one size."""
    return shape.sag(x, y), jax.vmap(jax.grad(shape.sag, argnums=(0, 1)))(x, y)


@jax.jit
def distance_and_derivatives(shape: Conic | Asphere, point: Vector, direction: Vector) -> tuple[jax.Array, Any, Any]:
    """Of one ray: by every number of the shape and by y, and the second one by y."""

    def distance(shape: Conic | Asphere, y: jax.Array) -> jax.Array:
        return shape.crossing((point[0], y, point[2]), direction, jnp.ones(())).distance

    value, slopes = jax.value_and_grad(distance, argnums=(0, 1))(shape, point[1])
    return value, slopes, jax.grad(jax.grad(distance, argnums=1), argnums=1)(shape, point[1])


@jax.jit
def derivatives_along_the_axis(shape: Conic | Asphere, y: jax.Array) -> Any:
    """Of all that is found, of a ray along the axis."""

    def found(shape: Conic | Asphere, y: jax.Array) -> jax.Array:
        zero = jnp.zeros(())
        found = shape.crossing((zero, y, zero), (zero, zero, jnp.ones(())), jnp.ones(()))
        return found.distance + found.cosine + found.normal[1]

    return jax.grad(found, argnums=(0, 1))(shape, y)


def crossing(shape: Conic | Asphere, point: Any, direction: Any, side: float = 1.0) -> Crossing:
    """By numbers of numpy."""
    point, direction = (tuple(np.asarray(a, float)) for a in (point, direction))
    return crossed(shape, point, direction, np.float64(side))


def test_crossing_lies_on_the_surface_and_on_the_ray(shape: Conic | Asphere) -> None:
    point, direction = rays(1)
    found = crossing(shape, point, direction)
    assert (np.asarray(found.status) == 0).all()
    assert_allclose(found.point, point + np.asarray(found.distance) * direction, atol=1e-14)
    assert_allclose(found.point[2], sag_and_slopes(shape, *found.point[:2])[0], atol=5e-15)


def test_crossing_agrees_with_bisection(shape: Conic | Asphere) -> None:
    point, direction = rays(2)
    found = crossing(shape, point, direction)
    for i in range(12):
        p, d = point[:, i], direction[:, i]

        def height(t: float, p: np.ndarray = p, d: np.ndarray = d) -> float:
            x, y, z = p + t * d
            return float(z - sag_of_one(shape, x, y))

        assert_allclose(found.distance[i], brentq(height, -6, 6, xtol=1e-14), atol=1e-13)


def test_normal_is_the_gradient_of_the_sag(shape: Conic | Asphere) -> None:
    point, direction = rays(3)
    found = crossing(shape, point, direction)
    _, slope = sag_and_slopes(shape, *found.point[:2])
    normal = np.asarray(found.normal)
    assert_allclose(normal[0] / normal[2], -slope[0], atol=1e-14)
    assert_allclose(normal[1] / normal[2], -slope[1], atol=1e-14)
    assert_allclose(found.normal_squared, (normal**2).sum(0), rtol=1e-14)
    assert_allclose(found.cosine, np.abs((normal * direction).sum(0)), rtol=1e-13)


def test_backward_light_meets_the_same_point(shape: Conic | Asphere) -> None:
    point, direction = rays(4)
    forward = crossing(shape, point, direction)
    backward = crossing(shape, point, -direction, -1.0)
    assert_allclose(backward.distance, -np.asarray(forward.distance), atol=1e-14)
    assert_allclose(backward.point, forward.point, atol=1e-14)


def test_derivatives_of_the_crossing(shape: Conic | Asphere) -> None:
    """By every number of the shape and of the ray, to second order, against central differences."""
    x, y, z, *direction = np.concatenate(rays(5, 1))[:, 0]
    _, (first, _), second = distance_and_derivatives(shape, (x, y, z), direction)
    leaves, tree = jax.tree.flatten(shape)
    for i, leaf in enumerate(leaves):
        for j in np.ndindex(leaf.shape):
            step = 1e-6 * max(1e-3, float(abs(leaf[j])))
            changed = [[*leaves[:i], leaf.at[j].add(s), *leaves[i + 1 :]] for s in (step, -step)]
            ends = [distance_and_derivatives(tree.unflatten(each), (x, y, z), direction)[0] for each in changed]
            difference = (ends[0] - ends[1]) / (2 * step)
            assert_allclose(jax.tree.leaves(first)[i][j], difference, rtol=2e-5, atol=1e-6)
    rates = [distance_and_derivatives(shape, (x, y + s, z), direction)[1][1] for s in (1e-5, -1e-5)]
    assert_allclose(second, (rates[0] - rates[1]) / 2e-5, rtol=1e-5, atol=1e-9)


def met(numbers: jax.Array, side: jax.Array) -> jax.Array:
    """What `met_in_many_digits` says, in JAX."""
    c, k, x, y, z, l, m, n = numbers
    found = Conic(c, k).crossing((x, y, z), (l, m, n), side)
    return jnp.stack([found.distance, *found.point, found.cosine])


SLOPES, BENDS = jax.jit(jax.jacfwd(met)), jax.jit(jax.jacfwd(jax.jacrev(met)))


def met_in_many_digits(numbers: list[mp.mpf], start: mp.mpf, side: int) -> list[mp.mpf]:
    """t, x, y, z and |N . d| where the line r + t d meets F = 0 near t = start; numbers: c, k, r and d."""
    c, k, *line = numbers

    def place(t: mp.mpf) -> list[mp.mpf]:
        return [p + t * d for p, d in zip(line[:3], line[3:], strict=True)]

    def equation(t: mp.mpf) -> mp.mpf:
        x, y, z = place(t)
        return c * (x * x + y * y + (1 + k) * z * z) - 2 * z

    t = mp.findroot(equation, start)
    x, y, z = place(t)
    normal = -c * x, -c * y, 1 - (1 + k) * c * z
    return [t, x, y, z, side * mp.fdot(normal, line[3:])]


@pytest.mark.parametrize("c", [0.0, 1e-9, 0.02, -0.11])
@pytest.mark.parametrize("k", [-1.0, 0.0, 0.5, 3.0])
@pytest.mark.parametrize("side", [1, -1])
def test_derivatives_of_a_conic_by_curvature_conic_point_and_direction(c: float, k: float, side: int) -> None:
    """A ray from a point off the vertex plane, by numbers of 40 digits; the second derivatives are finite."""
    turned = side * np.array([0.28, -0.21, math.sqrt(1 - 0.28**2 - 0.21**2)])
    numbers = np.array([c, k, 2.1, -1.4, -3.0, *turned])

    value = np.asarray(met(numbers, float(side)))
    slopes = SLOPES(numbers, float(side))
    with mp.workdps(40):
        exact, step = [mp.mpf(float(number)) for number in numbers], mp.mpf(10) ** -12
        start = mp.mpf(float(value[0]))
        assert_allclose(value, [float(v) for v in met_in_many_digits(exact, start, side)], rtol=1e-13, atol=1e-14)
        for i in range(8):
            ends = []
            for sign in (1, -1):
                moved = [number + sign * step * (i == j) for j, number in enumerate(exact)]
                ends.append(met_in_many_digits(moved, start, side))
            expected = [float((a - b) / (2 * step)) for a, b in zip(*ends, strict=True)]
            assert_allclose(slopes[:, i], expected, rtol=1e-12, atol=1e-12, err_msg=f"number {i}")
    assert np.isfinite(BENDS(numbers, float(side))).all()


def test_derivatives_are_finite_on_the_vertex_and_beyond_the_rim(shape: Conic | Asphere) -> None:
    for y in (0.0, 1e3):
        gradient = derivatives_along_the_axis(shape, np.float64(y))
        assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(gradient))


def test_curvature_derivative_of_a_plane_is_exact() -> None:
    # a ray parallel to the axis at height h: sag = c h^2 / 2 + ..., d sag / dc = h^2 / 2 at c = 0
    height, zero, one = np.float64(3), np.float64(0), np.float64(1)
    _, (slopes, _), _ = distance_and_derivatives(SHAPES["plane"], (zero, height, zero), [zero, zero, one])
    assert float(slopes.curvature) == 4.5


def test_a_parabola_met_parallel_to_its_axis_loses_no_digits() -> None:
    h = np.array([1e-9, 1e-3, 1.0, 30.0])
    found = crossing(SHAPES["parabola"], np.array([0 * h, h, 0 * h]), np.array([0 * h, 0 * h, 1 + 0 * h]))
    assert_allclose(found.distance, h**2 / 80, rtol=4e-16)


def test_misses_are_statuses() -> None:
    sphere, hyperbola = Conic(jnp.array(0.1), jnp.array(0.0)), Conic(jnp.array(0.1), jnp.array(-4.0))
    straight = [0.0, 0.0, 1.0]
    assert int(crossing(sphere, [0.0, 9.999, 0.0], straight).status) == RayStatus.OK  # type: ignore[arg-type]
    assert int(crossing(sphere, [0.0, 10.001, 0.0], straight).status) == RayStatus.MISSED  # type: ignore[arg-type]
    # this line meets the hyperboloid on its other sheet alone, which begins at z = 2 / (c (1 + k)) = -6.7
    slope = np.arctan(0.3)
    other = crossing(hyperbola, [0.0, 0.0, -10.0], [0.0, np.cos(slope), np.sin(slope)])  # type: ignore[arg-type]
    assert int(other.status) == RayStatus.MISSED
    # the far half of a ball does not belong to the sheet through the vertex
    side = crossing(sphere, [0.0, 0.0, 15.0], [0.0, 1.0, 0.0])  # type: ignore[arg-type]
    assert int(side.status) == RayStatus.MISSED


def test_a_field_beyond_a_right_angle_enters_the_front_of_a_dome() -> None:
    # R = 10; light going up and 5 degrees backward enters at the lower rim, from outside
    angle = np.deg2rad(95)
    direction = [0.0, np.sin(angle), np.cos(angle)]
    found = crossing(Conic(jnp.array(0.1), jnp.array(0.0)), [0.0, 0.0, 2.0], direction)  # type: ignore[arg-type]
    assert int(found.status) == RayStatus.OK
    assert float(found.point[1]) < -5
    assert_allclose((np.asarray(found.point) - [0, 0, 10]) @ (np.asarray(found.point) - [0, 0, 10]), 100, rtol=1e-14)
    assert np.dot(np.asarray(found.normal), direction) > 0


def test_an_asphere_that_nothing_meets_says_so() -> None:
    steep = Asphere(jnp.array(0.1), jnp.array(0.0), jnp.array([1e-4]), jnp.array(1.0), (4,))
    status = int(crossing(steep, [0.0, 10.5, 0.0], [0.0, 0.0, 1.0]).status)  # type: ignore[arg-type]
    assert status == RayStatus.MISSED


def test_single_precision_stays_single() -> None:
    shape = jax.tree.map(lambda a: a.astype(jnp.float32), SHAPES["odd"])
    point, direction = (tuple(jnp.asarray(a, jnp.float32) for a in part) for part in rays(6))
    found = crossed(shape, point, direction, jnp.float32(1))
    assert found.distance.dtype == jnp.float32
    assert (np.asarray(found.status) == 0).all()
    assert_allclose(found.point[2], sag_and_slopes(shape, *found.point[:2])[0], atol=1e-6)
