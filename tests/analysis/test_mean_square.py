"""The mean square spot: that of the spots, and its derivatives, against central differences."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens
from lenstrace.compute import blocks

ROWS = [
    {"radius": 30.0, "thickness": 4.0, "abbe": {"nd": 1.6, "vd": 60.0}, "conic": -0.4},
    {"radius": -60.0, "thickness": 2.0, "abbe": {"nd": 1.7, "vd": 30.0}},
    {"radius": -300.0, "thickness": 50.0, "stop": True},
]
RINGS = 3
QUICKLY = {"xla_backend_optimization_level": 0}  # what is called a few times compiles in a fifth of the time


def doublet(width: float = 7.6, **aperture: object) -> Lens:
    """Two colours of unequal weight."""
    fields, waves = {"x": [0.0, 1.0], "y": [0.5, 5.0]}, {"um": [0.5, 0.6], "weights": [1, 0.3]}
    return lenstrace.lens([ROWS[0] | aperture, *ROWS[1:]], {"entrance_pupil_diameter": width}, fields, waves)


@pytest.fixture(scope="module")
def lens() -> Lens:
    """The lens whose derivatives are taken."""
    return doublet()


def squares(lens: Lens) -> jax.Array:
    return lenstrace.mean_square_spot(lens, rings=RINGS)


def merit(lens: Lens) -> jax.Array:
    return jnp.sum(squares(lens) * jnp.array([1.0, 2.0]))


def difference(function: Callable[[float], jax.Array], step: float) -> np.ndarray:
    """The derivative of a function at 0, of fourth order in the step."""
    far, near = (np.asarray(function(s * step)) - np.asarray(function(-s * step)) for s in (2, 1))
    return (8 * near - far) / (12 * step)


@pytest.mark.parametrize("aperture", [{}, {"aperture": {"circle": 3.9}}])
def test_it_is_the_square_of_the_pooled_spot(aperture: dict) -> None:
    lens = doublet(**aperture)
    spots = lenstrace.spots(lens, rings=RINGS)
    assert (np.asarray(spots.lost)[0] == 0).all()
    assert (np.asarray(spots.lost)[1] > 0).all() == bool(aperture)
    assert_allclose(squares(lens), np.square(spots.polychromatic.rms_centroid), rtol=1e-10)


def test_threads_give_the_same_numbers(lens: Lens, monkeypatch: pytest.MonkeyPatch) -> None:
    alone = squares(lens)
    monkeypatch.setattr(blocks, "CHUNK", 15)
    assert_allclose(squares(lens), alone, rtol=1e-13)


def test_gradient_by_every_number_of_the_lens(lens: Lens) -> None:
    found = jax.tree.leaves(jax.grad(merit)(lens))
    leaves, tree = jax.tree.flatten(lens)
    value = float(merit(lens))
    # c, t, k of three rows and the image, nd and vd, the pupil, two fields in x and y, two weights
    assert len(leaves) == 4 * 3 + 4 + 1 + 4 + 2
    for i, leaf in enumerate(leaves):

        def moved(by: float, i: int = i) -> jax.Array:
            return merit(tree.unflatten([*leaves[:i], leaves[i] + by, *leaves[i + 1 :]]))

        # a step that changes the merit by about a thousandth, whatever the number is
        step = min(1e-3 * value / max(abs(float(found[i])), 1e-9), 0.005)
        assert_allclose(found[i], difference(moved, step), rtol=1e-7, atol=1e-10 * value, err_msg=f"number {i}, {leaf}")


def test_second_derivatives_by_two_curvatures(lens: Lens) -> None:
    def of_two(c: jax.Array) -> jax.Array:
        return merit(lens.replace(surface=1, curvature=c[0]).replace(surface=3, curvature=c[1]))

    c, step = jnp.array([lens[1].curvature, lens[3].curvature]), 1e-4
    hessian = jax.jit(jax.jacfwd(jax.grad(of_two)), compiler_options=QUICKLY)(c)
    assert_allclose(hessian, hessian.T, rtol=1e-10)
    for direction in ([1.0, 0.0], [0.0, 1.0], [1.0, -0.7]):
        values = [float(of_two(c + i * step * jnp.array(direction))) for i in (-2, -1, 0, 1, 2)]
        expected = np.dot([-1, 16, -30, 16, -1], values) / (12 * step**2)
        assert_allclose(direction @ np.asarray(hessian) @ direction, expected, rtol=1e-7)


def test_under_jit_and_vmap_it_is_the_same(lens: Lens) -> None:
    thickness = np.asarray(lens.thickness) + np.array([[0.0, 0.0, 0.0], [0.1, -0.2, 0.5]])
    expected = [squares(lens.replace(thickness=t)) for t in thickness]
    batch = jax.jit(jax.vmap(lambda t: squares(lens.replace(thickness=t))), compiler_options=QUICKLY)
    assert_allclose(batch(jnp.asarray(thickness)), expected, rtol=1e-12)


def test_a_field_without_rays_is_nan() -> None:
    # the entrance pupil, 0.2 mm wide, stands 4 mm behind the hole: light at 5 degrees passes 0.3 mm beside its centre
    found = np.asarray(squares(doublet(0.2, aperture={"circle": 0.15})))
    assert found[0] > 0
    assert np.isnan(found[1])


def test_an_image_at_infinity_is_an_error(designs: dict[str, Lens]) -> None:
    with pytest.raises(lenstrace.ImageError, match="afocal"):
        lenstrace.mean_square_spot(designs["afocal_expander"])


def test_single_precision_stays_single(lens: Lens) -> None:
    single = squares(lens.astype(jnp.float32))
    assert single.dtype == jnp.float32
    assert_allclose(single, squares(lens), rtol=2e-3)


def test_a_perfect_spot_is_not_negative() -> None:
    rows = [{"thickness": 100.0, "stop": True}, {"radius": -200.0, "conic": -1.0, "thickness": -100.0, "mirror": True}]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 40.0}, [0.0], [0.55])
    for precision, least in (("float64", 1e-28), ("float32", 1e-10)):
        found = float(lenstrace.mean_square_spot(lens.astype(precision))[0])
        assert 0 <= found < least


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_a_spot_of_few_rays_far_off_the_axis(precision: str, designs: dict[str, Lens]) -> None:
    """An aperture stops all rays that tell where the centroid is: no digits may cancel."""
    ring = designs["double_gauss"].replace(surface=1, aperture={"annulus": (9.6, 9.9)}, decenter=(0.0, 0.0))
    lens = ring.replace(fields=lenstrace.Fields((0.0,), (14.0,), "angle")).astype(precision)
    found = lenstrace.spots(lens, rings=40)
    expected = float(found.polychromatic.rms_centroid[0]) ** 2
    assert 0 < int(found.lost[0, 0]) < found.rays
    assert float(lenstrace.mean_square_spot(lens, rings=40)[0]) == pytest.approx(expected, rel=1e-3)
