"""Blocks and threads: the numbers and the derivatives of a function of rays, as if it were called plainly."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from lenstrace.compute import blocks
from lenstrace.compute.blocks import each
from lenstrace.compute.pytree import pytree
from lenstrace.compute.totals import total

Parameters = dict[str, jax.Array]

PARAMETERS = {"a": jnp.array(0.7), "b": jnp.array([1.5, -0.3, 2.0])}


@pytree
class Points:
    """Rays of two numbers and a whole number."""

    x: jax.Array
    y: jax.Array
    number: jax.Array


def curves(parameters: Parameters, rays: Points) -> dict[str, jax.Array]:
    """A number, three numbers and a whole number for each ray."""
    a, b = parameters["a"], parameters["b"]
    b = b.reshape(-1, *(1,) * rays.x.ndim)
    return {"root": jnp.sqrt(a * a + rays.x * rays.x), "three": b * rays.x + rays.y**2, "number": 2 * rays.number + 1}


def points(shape: tuple[int, ...], dtype: type = float) -> Points:
    """The same points every time, for each shape."""
    x, y = np.random.default_rng(3).uniform(-2, 2, (2, *shape)).astype(dtype)
    return Points(x, y, np.arange(x.size, dtype=np.int32).reshape(shape))


def in_numpy(rays: Points) -> dict[str, np.ndarray]:
    a, b = float(PARAMETERS["a"]), np.asarray(PARAMETERS["b"]).reshape(-1, *(1,) * np.ndim(rays.x))
    x, y = np.asarray(rays.x), np.asarray(rays.y)
    return {"root": np.sqrt(a * a + x * x), "three": b * x + y**2, "number": 2 * np.asarray(rays.number) + 1}


def assert_same(found: dict[str, jax.Array], expected: dict[str, np.ndarray], rtol: float = 1e-15) -> None:
    for name, values in expected.items():
        assert found[name].shape == values.shape
        assert_allclose(found[name], values, rtol=rtol, atol=rtol)


@pytest.fixture
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads are opened from 200 rays on."""
    monkeypatch.setattr(blocks, "CHUNK", 100)


@pytest.mark.parametrize("shape", [(), (1,), (7,), (64,), (131,), (3, 5)])
def test_every_ray_gets_the_numbers_of_the_function(shape: tuple[int, ...]) -> None:
    rays = points(shape)
    assert_same(each(curves, PARAMETERS, rays), in_numpy(rays))


@pytest.mark.parametrize("shape", [(200,), (201,), (399,), (2, 5, 37)])
@pytest.mark.usefixtures("small_chunks")
def test_threads_give_the_numbers_of_the_function(shape: tuple[int, ...]) -> None:
    rays = points(shape)
    found = each(curves, PARAMETERS, rays)
    assert_same(found, in_numpy(rays))
    assert found["number"].dtype == jnp.int32
    assert all(isinstance(leaf, jax.Array) for leaf in jax.tree.leaves(found))


def test_threads_give_the_numbers_of_one_thread_to_the_last_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    rays = points((331,))
    alone = each(curves, PARAMETERS, rays)
    monkeypatch.setattr(blocks, "CHUNK", 100)
    jax.tree.map(assert_array_equal, each(curves, PARAMETERS, rays), alone)


@pytest.mark.usefixtures("small_chunks")
def test_results_of_threads_are_not_overwritten_by_the_next_call() -> None:
    rays = points((500,))
    first = each(curves, PARAMETERS, rays)
    each(curves, {"a": jnp.array(9.0), "b": -PARAMETERS["b"]}, rays)
    assert_same(first, in_numpy(rays))


@pytest.mark.usefixtures("small_chunks")
def test_single_precision_stays_single() -> None:
    parameters = jax.tree.map(lambda a: a.astype(jnp.float32), PARAMETERS)
    for count in (131, 331):
        rays = points((count,), np.float32)
        found = each(curves, parameters, rays)
        assert found["root"].dtype == found["three"].dtype == jnp.float32
        assert_same(found, in_numpy(rays), 1e-6)


@pytest.mark.usefixtures("small_chunks")
def test_under_jit_and_vmap_the_numbers_are_the_same() -> None:
    rays = points((231,))
    assert_same(jax.jit(lambda p, r: each(curves, p, r))(PARAMETERS, rays), in_numpy(rays))
    # the rays are no argument: plain numbers, while JAX traces the function around them
    assert_same(jax.jit(lambda: each(curves, PARAMETERS, rays))(), in_numpy(rays))
    a = jnp.array([0.1, 0.7, 3.0])
    batch = jax.vmap(lambda a: each(curves, PARAMETERS | {"a": a}, rays))(a)
    assert_allclose(batch["root"], np.hypot(a[:, None], rays.x), rtol=1e-15)
    assert_allclose(batch["three"], np.broadcast_to(in_numpy(rays)["three"], (3, 3, 231)), rtol=1e-15, atol=1e-15)
    x = a[:, None] * rays.x
    batch = jax.vmap(lambda a, x: each(curves, PARAMETERS | {"a": a}, Points(x, rays.y, rays.number)))(a, x)
    assert_allclose(batch["root"], np.hypot(a[:, None], x), rtol=1e-15)


def test_derivatives_of_each_by_parameters_and_rays() -> None:
    rays = points((131,))
    a, x = float(PARAMETERS["a"]), np.asarray(rays.x)
    root = np.hypot(a, x)

    def roots(a: jax.Array, x: jax.Array) -> jax.Array:
        return each(curves, PARAMETERS | {"a": a}, Points(x, rays.y, rays.number))["root"]

    arguments = PARAMETERS["a"], jnp.asarray(x)
    assert_allclose(jax.jacfwd(roots)(*arguments), a / root, rtol=1e-14)
    along = jax.jvp(roots, arguments, (jnp.array(2.0), jnp.ones(131)))[1]
    assert_allclose(along, (2 * a + x) / root, rtol=1e-13, atol=1e-14)
    by_a, by_x = jax.grad(lambda a, x: roots(a, x).sum(), argnums=(0, 1))(*arguments)
    assert_allclose(by_a, (a / root).sum(), rtol=1e-14)
    assert_allclose(by_x, x / root, rtol=1e-14)
    second = jax.jit(jax.jacfwd(jax.grad(lambda a: roots(a, arguments[1]).sum())))(arguments[0])
    assert_allclose(second, (x * x / root**3).sum(), rtol=1e-13)


def test_any_number_of_rays_is_shared_out_in_chunks_of_one_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "CHUNK", 40)
    seen = []

    def spy(parameters: Parameters, rays: Points) -> dict[str, jax.Array]:
        seen.append(rays.x.shape)
        return curves(parameters, rays)

    for count in (80, 91, 1001):
        each(spy, PARAMETERS, points((count,)))
    assert set(seen) == {(40,)}


def moments(parameters: Parameters, case: tuple[jax.Array, jax.Array], rays: Points) -> tuple[jax.Array, jax.Array]:
    """Two polynomials of the rays; the case says whether x is squared in the first, and the shift of the second."""
    a, b = parameters["a"], parameters["b"]
    squared, shift = case
    x = jnp.where(squared, rays.x * rays.x, rays.x)
    return a * a * x + b[0] * rays.y, (b[1] * rays.x + shift) ** 2 * b[2]


CASES = np.array([False, True]), np.array([0.25, -1.0])


def exact(rays: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The sums, and their derivatives by a and by b, of each polynomial: (2, C), (2, C), (2, C, 3)."""
    a, b = float(PARAMETERS["a"]), np.asarray(PARAMETERS["b"])
    sums, by_a, by_b = np.zeros((2, 2)), np.zeros((2, 2)), np.zeros((2, 2, 3))
    for c, (squared, shift) in enumerate(zip(*CASES, strict=True)):
        x, line = rays.x ** (1 + squared), b[1] * rays.x + shift
        sums[:, c] = (a * a * x + b[0] * rays.y).sum(), (line**2 * b[2]).sum()
        by_a[0, c] = (2 * a * x).sum()
        by_b[0, c, 0] = rays.y.sum()
        by_b[1, c, 1:] = (2 * line * rays.x * b[2]).sum(), (line**2).sum()
    return sums, by_a, by_b


def totals(parameters: Parameters, rays: Points) -> tuple[jax.Array, jax.Array]:
    return total(moments, parameters, CASES, rays)


@pytest.mark.parametrize("count", [1, 64, 131, 200, 531])
@pytest.mark.usefixtures("small_chunks")
def test_totals_are_sums_over_all_rays(count: int) -> None:
    rays = points((count,))
    sums, by_a, by_b = exact(rays)
    assert_allclose(totals(PARAMETERS, rays), sums, rtol=1e-13, atol=1e-12)
    forward = jax.jacfwd(totals)(PARAMETERS, rays)
    assert_allclose([each["a"] for each in forward], by_a, rtol=1e-13, atol=1e-12)
    assert_allclose([each["b"] for each in forward], by_b, rtol=1e-13, atol=1e-12)


@pytest.mark.parametrize("count", [131, 331])
@pytest.mark.parametrize("wrapped", [False, True])
@pytest.mark.usefixtures("small_chunks")
def test_gradient_of_totals_in_reverse(count: int, wrapped: bool) -> None:
    rays = points((count,))
    weights = jnp.array([[1.0, -2.0], [0.5, 3.0]])

    def merit(parameters: Parameters) -> jax.Array:
        return jnp.sum(weights * jnp.stack(totals(parameters, rays)))

    value, gradient = (jax.jit if wrapped else lambda f: f)(jax.value_and_grad(merit))(PARAMETERS)
    sums, by_a, by_b = exact(rays)
    assert_allclose(value, (weights * sums).sum(), rtol=1e-13)
    assert_allclose(gradient["a"], (weights * by_a).sum(), rtol=1e-13)
    assert_allclose(gradient["b"], np.tensordot(weights, by_b), rtol=1e-13)


@pytest.mark.parametrize("count", [131, 331])
@pytest.mark.usefixtures("small_chunks")
def test_second_derivative_of_totals(count: int) -> None:
    rays = points((count,))

    def line_squared(b: jax.Array) -> jax.Array:
        return totals(PARAMETERS | {"b": b}, rays)[1].sum()

    hessian = jax.jacfwd(jax.grad(line_squared))(PARAMETERS["b"])
    b = np.asarray(PARAMETERS["b"])
    line = b[1] * rays.x[:, None] + CASES[1]
    mixed = (2 * line * rays.x[:, None]).sum()
    expected = [[0, 0, 0], [0, 2 * (2 * rays.x**2 * b[2]).sum(), mixed], [0, mixed, 0]]
    assert_allclose(hessian, expected, rtol=1e-13, atol=1e-12)


@pytest.mark.usefixtures("small_chunks")
def test_totals_under_jit_and_vmap_and_in_single_precision() -> None:
    rays = points((331,))
    assert_allclose(jax.jit(lambda: totals(PARAMETERS, rays))(), exact(rays)[0], rtol=1e-13)
    a = jnp.array([0.1, 0.7])
    batch = jax.vmap(lambda a: totals(PARAMETERS | {"a": a}, rays)[0])(a)
    assert_allclose(batch[1], exact(rays)[0][0], rtol=1e-13)
    single = jax.tree.map(lambda leaf: leaf.astype(jnp.float32), PARAMETERS)
    found = total(moments, single, (CASES[0], CASES[1].astype(np.float32)), points((331,), np.float32))
    assert found[0].dtype == found[1].dtype == jnp.float32
    assert_allclose(found, exact(rays)[0], rtol=1e-4, atol=1e-3)


def test_totals_are_not_differentiated_by_rays_or_cases() -> None:
    rays = points((5,))
    with pytest.raises(TypeError, match="by its parameters"):
        jax.grad(lambda x: totals(PARAMETERS, Points(x, rays.y, rays.number))[0].sum())(jnp.asarray(rays.x))
    with pytest.raises(TypeError, match="by its parameters"):
        jax.grad(lambda s: total(moments, PARAMETERS, (CASES[0], s), rays)[1].sum())(jnp.asarray(CASES[1]))
