"""Rays through graded media against closed forms: a focusing rod with skew rays, and a uniform medium."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lenstrace import OptionError, ray
from lenstrace.compute.pytree import pytree
from lenstrace.optics.graded import through


@pytree
class Rod:
    """n^2 = n0^2 (1 - g^2 (x^2 + y^2))."""

    index: float
    strength: float

    def square(self, x: jax.Array, y: jax.Array, _z: jax.Array) -> jax.Array:
        return self.index**2 * (1 - self.strength**2 * (x * x + y * y))


def plane(at: float):
    return lambda points, _: points[2] - at


def test_skew_rays_in_a_rod_are_ellipses() -> None:
    n0, g, length = 1.6, 0.2, 30.0
    x, y = np.array([0.5, 0.0, -1.0]), np.array([0.0, 0.3, 1.0])
    l, m = np.array([0.02, 0.1, 0.0]), np.array([0.1, 0.0, 0.0])
    n = np.sqrt(1 - l**2 - m**2)
    found = through(Rod(n0, g), ray((x, y, 0 * x), (l, m, n)), 2 * length, plane(length), tolerance=1e-13, samples=5)
    start = n0 * np.sqrt(1 - g**2 * (x**2 + y**2))
    t = length / (start * n)
    for first, slope, there in ((x, l, found.end.x), (y, m, found.end.y)):
        w = n0 * g
        np.testing.assert_allclose(there, first * np.cos(w * t) + start * slope / w * np.sin(w * t), rtol=0, atol=1e-11)
    np.testing.assert_allclose(found.end.z, length, rtol=1e-14)
    np.testing.assert_allclose(found.drift, 0, atol=1e-12)
    np.testing.assert_allclose(found.points[:, 0], [x, y, 0 * x], atol=1e-15)
    np.testing.assert_allclose(found.points[2, 2], length / 2, rtol=1e-12)


def test_a_uniform_medium_is_straight_and_its_path_is_the_index_times_the_way() -> None:
    found = through(Rod(1.5, 0.0), ray((0.0, [0.0], 0.0), (0.0, 0.6, 0.8)), 10.0, plane(4.0))
    np.testing.assert_allclose([found.end.y[0], found.end.z[0], found.end.opl[0]], [3, 4, 7.5], rtol=1e-13)
    assert found.end.ok.all()


def test_a_ray_that_meets_no_boundary_says_so() -> None:
    found = through(Rod(1.5, 0.0), ray((0.0, [0.0, 0.0], 0.0), (0.0, 0.0, [1.0, -1.0])), 10.0, plane(4.0))
    assert found.end.ok.tolist() == [True, False]
    np.testing.assert_allclose(found.end.z[1], -15, rtol=1e-13)


@pytest.mark.parametrize("tolerance", [0.0, 1e-14, 1.0, float("nan")])
def test_tolerances_out_of_range_are_refused(tolerance: float) -> None:
    with pytest.raises(OptionError, match="tolerance must be at least 1e-13"):
        through(Rod(1.5, 0.0), ray((0.0, [0.0], 0.0), (0.0, 0.0, 1.0)), 10.0, plane(4.0), tolerance=tolerance)


def test_a_smaller_tolerance_is_more_accurate_and_costs_more() -> None:
    start = ray((0.0, [1.0], 0.0), (0.0, 0.0, 1.0))
    coarse, fine = (
        through(Rod(1.5, 0.3), start, 60.0, plane(60.0), tolerance=tolerance) for tolerance in (1e-4, 1e-12)
    )
    assert abs(fine.drift).max() < 1e-3 * abs(coarse.drift).max()
    assert fine.calls > coarse.calls
    assert jnp.isfinite(coarse.end.opl).all()
