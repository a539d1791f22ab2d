"""float32: every number of a trace stays single, and is as good as single precision allows."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens


@pytest.mark.parametrize("aimed", [False, True])
def test_a_lens_in_single_precision(aimed: bool, designs: dict[str, Lens]) -> None:
    double = dataclasses.replace(designs["double_gauss"], ray_aiming=aimed)
    single = double.astype(jnp.float32)
    assert all(leaf.dtype == np.float32 for leaf in jax.tree.leaves(single.system))
    found, expected = lenstrace.spots(single), lenstrace.spots(double)
    assert found.x.dtype == jnp.float32
    # 100 mm scale: 2e-5 mm
    assert_allclose(found.x, expected.x, atol=2e-5)
    assert_allclose(found.y, expected.y, atol=2e-5)
    assert not np.asarray(found.lost).any()


def test_first_order_and_rays_in_single_precision(designs: dict[str, Lens]) -> None:
    double = designs["cooke_triplet"]
    single = double.astype(np.float32)
    points = lenstrace.first_order(single)
    assert points.focal_length.dtype == jnp.float32
    assert_allclose(points.focal_length, lenstrace.first_order(double).focal_length, rtol=1e-5)
    ray = lenstrace.ray((0.0, 2.0, 0.0), (0.0, 0.0, 1.0))
    path = lenstrace.trace(single, ray)
    assert path.opl is not None
    assert path.y.dtype == path.opl.dtype == jnp.float32
    exact = lenstrace.trace(double, ray)
    assert_allclose(path.y, exact.y, atol=2e-5)
    assert_allclose(path.opl, exact.opl, rtol=1e-6)
    check = lenstrace.newton_check(single)
    assert check.residual.dtype == jnp.float32
    assert np.abs(check.residual).max() < 1e-4


def test_other_precisions_are_refused(designs: dict[str, Lens]) -> None:
    with pytest.raises(lenstrace.PrescriptionError, match="float16"):
        designs["tessar"].astype(jnp.float16)


def test_gradients_in_single_precision(designs: dict[str, Lens]) -> None:
    def slopes(lens: Lens) -> np.ndarray:
        def merit(curvature: jax.Array) -> jax.Array:
            return lenstrace.mean_square_spot(lens.replace(curvature=curvature)).sum()

        return np.asarray(jax.grad(merit)(jnp.asarray(lens.curvature)), float)

    double = designs["double_gauss"]
    expected = slopes(double)
    # of the largest; single figures near a minimum may be worse
    assert np.abs(slopes(double.astype("float32")) - expected).max() < 3e-4 * np.abs(expected).max()
