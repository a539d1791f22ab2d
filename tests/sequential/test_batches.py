"""A lens as the argument of JAX's transformations: batches, gradients, precision, aimed rays, other media."""

import dataclasses
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens

QUICKLY = {"xla_backend_optimization_level": 0}  # what is called a few times compiles in a fifth of the time


def sizes(lens: Lens) -> jax.Array:
    return lenstrace.spots(lens, rings=2).polychromatic.rms_centroid


def heights(lens: Lens) -> jax.Array:
    """y and optical path of a few rays at every surface."""
    fields, pupil = np.array([0.0, 5.0, 14.0]), (np.array([0.1, 0.0, 0.3]), np.array([0.7, -1.0, 0.5]))
    path = lenstrace.trace(lens, field=fields, pupil=pupil)
    return jnp.stack([path.y, path.opl])


def focal_lengths(lens: Lens) -> jax.Array:
    return lenstrace.first_order(lens).focal_length


def difference(function: Callable[[float], jax.Array], step: float) -> np.ndarray:
    """The derivative of a function at 0, of fourth order in the step."""
    far, near = (np.asarray(function(s * step)) - np.asarray(function(-s * step)) for s in (2, 1))
    return (8 * near - far) / (12 * step)


def stacked(lenses: list[Lens]) -> Lens:
    """A lens whose numbers have a leading axis."""
    return jax.tree.map(lambda *numbers: jnp.array(numbers), *lenses)


@pytest.mark.parametrize("question", [sizes, heights, focal_lengths])
def test_a_batch_of_eight_lenses_is_a_loop(question: Callable[[Lens], jax.Array], designs: dict[str, Lens]) -> None:
    lens, random = designs["cooke_triplet"], np.random.default_rng(1)
    lenses = [
        lens.replace(
            curvature=lens.curvature * random.uniform(0.98, 1.02, 6),
            thickness=lens.thickness + random.uniform(0, 0.1, 6),
        )
        for _ in range(8)
    ]
    expected = np.array([question(lens) for lens in lenses])
    assert np.ptp(expected, 0).max() > 1e-3
    assert_allclose(jax.vmap(question)(stacked(lenses)), expected, rtol=1e-11, atol=1e-13)


def quick(function: Callable) -> Callable:
    return jax.jit(function, compiler_options=QUICKLY)


def test_transformations_agree_with_each_other_and_with_differences(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]

    def merit(c: jax.Array) -> jax.Array:
        return sizes(lens.replace(curvature=c)) * jnp.array([1.0, 0.5, 2.0])

    c = jnp.asarray(lens.curvature)
    at_once = quick(merit)
    assert_allclose(at_once(c), merit(c), rtol=1e-12)
    forward = quick(jax.jacfwd(merit))(c)
    assert_allclose(quick(jax.jacrev(merit))(c), forward, rtol=1e-9)
    assert_allclose(quick(jax.grad(lambda c: merit(c).sum()))(c), forward.sum(0), rtol=1e-9)
    for i in range(6):
        unit = np.eye(6)[i]
        expected = difference(lambda s, unit=unit: at_once(c + s * unit), 2e-7)
        assert_allclose(forward[:, i], expected, rtol=2e-7, atol=2e-7)


def test_single_precision_all_through(designs: dict[str, Lens]) -> None:
    double = designs["cooke_triplet"]
    single = double.astype(jnp.float32)
    for question in (lenstrace.trace, lenstrace.spots, lenstrace.first_order, lenstrace.overview):
        found, expected = question(single), question(double)
        pairs = list(zip(jax.tree.leaves(found), jax.tree.leaves(expected), strict=True))
        assert all(leaf.dtype == (np.float32 if exact.dtype == np.float64 else exact.dtype) for leaf, exact in pairs)
        for leaf, exact in pairs:
            assert_allclose(leaf, exact, rtol=2e-6, atol=2e-5)


def test_single_precision_under_jit_and_grad(designs: dict[str, Lens]) -> None:
    single = designs["cooke_triplet"].astype(jnp.float32)

    def merit(c: jax.Array) -> jax.Array:
        return sizes(single.replace(curvature=c)).sum()

    value, gradient = quick(jax.value_and_grad(merit))(jnp.asarray(single.curvature))
    assert value.dtype == gradient.dtype == jnp.float32
    exact = quick(jax.grad(lambda c: sizes(designs["cooke_triplet"].replace(curvature=c)).sum()))
    assert_allclose(gradient, exact(jnp.asarray(designs["cooke_triplet"].curvature)), rtol=4e-3)


def test_aimed_rays_in_a_batch_and_in_a_gradient() -> None:
    rows = [
        {"radius": 40.0, "thickness": 4.0, "abbe": {"nd": 1.6, "vd": 60.0}},
        {"radius": 200.0, "thickness": 6.0},
        {"thickness": 55.0, "stop": True},
    ]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 8.0}, [0.0, 12.0], [0.55], ray_aiming=True)

    def height(c: jax.Array) -> jax.Array:
        at = lens.replace(surface=1, curvature=c)
        path = lenstrace.trace(at, field=np.array([0.0, 12.0]), pupil=(0.2, 0.9))
        # at the stop every ray stands where it was sent, whatever the lens
        return jnp.stack([path.y[-1], path.y[3]])

    c = jnp.array([1 / 40, 1 / 45, -1 / 90])
    batch = quick(jax.vmap(height))
    heights = batch(c)
    assert_allclose(heights[0], height(c[0]), rtol=1e-10)
    assert_allclose(heights[:, 1, 0], heights[:, 1, 1], rtol=1e-9)
    slope = quick(jax.jacrev(height))(c[0])
    assert np.isfinite(slope).all()
    assert_allclose(slope, difference(lambda s: batch(c + s)[0], 1e-5), rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("name", ["immersion_objective", "cartesian_oval"])
def test_a_near_object_in_any_medium_is_differentiated(name: str, designs: dict[str, Lens]) -> None:
    """Object in oil, or image in glass; both with an aperture that is a sine."""
    lens = designs[name]

    def heights_of(curvature: jax.Array) -> jax.Array:
        y = np.array([0.0, 0.01])
        return lenstrace.trace(lens.replace(curvature=curvature), field=y, pupil=(0.0, 0.8), path=False).y

    c = jnp.asarray(lens.curvature)
    reverse, at_once = quick(jax.jacrev(heights_of))(c), quick(heights_of)
    for i in range(len(c)):
        unit = np.eye(len(c))[i]
        expected = difference(lambda s, unit=unit: at_once(c + s * unit), 1e-6)
        assert_allclose(reverse[:, i], expected, rtol=1e-6, atol=1e-5)


def test_the_sine_of_the_aperture_is_that_of_the_rays(designs: dict[str, Lens]) -> None:
    """object_na = n sin(theta) of the ray at the edge of the pupil of an aplanatic objective, n = 1.5."""
    lens = designs["immersion_objective"]
    batch = stacked([lens, dataclasses.replace(lens, aperture=lenstrace.Aperture(0.3, "object_na"))])
    sine = jax.vmap(lambda lens: lenstrace.trace(lens, pupil=(0.0, 1.0)).m[0])(batch)
    assert_allclose(1.5 * sine, [1.2, 0.3], rtol=1e-12)
