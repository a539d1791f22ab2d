"""Rays through graded media against closed forms: a focusing rod with skew rays, and a uniform medium."""

import dataclasses
import tracemalloc

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lenstrace import OptionError, RayError, RayStatus, ray
from lenstrace.compute.pytree import pytree
from lenstrace.optics.graded import through
from lenstrace.optics.rays import Ray, failure_code


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


def parallel(heights: np.ndarray) -> Ray:
    """Rays along z from the plane z = 0."""
    zero = 0 * heights
    return ray((zero, heights, zero), (zero, zero, 1 + zero))


@pytest.mark.parametrize("beside", [3, 300])
def test_easy_rays_hide_no_error_of_a_hard_one(beside: int) -> None:
    n0, g, length = 1.5, 0.3, 60.0

    def error(heights: np.ndarray) -> float:
        found = through(Rod(n0, g), parallel(heights), length, plane(length), tolerance=1e-5, samples=200)
        _, y, z = found.points[:, :, 0]
        return np.abs(y - np.cos(g * z / np.sqrt(1 - g**2))).max()

    assert error(np.append(1.0, np.zeros(beside))) < 1.3 * error(np.ones(1))


def test_the_cost_is_linear_in_the_rays() -> None:
    tracemalloc.start()
    through(Rod(1.5, 0.0), parallel(np.linspace(-1, 1, 3000)), 10.0, plane(4.0), tolerance=1e-6)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # seven numbers of every ray for every ray are 504 MB
    assert peak < 200e6


def test_a_failed_ray_keeps_its_failure_and_stays_where_it_is() -> None:
    lost = int(failure_code(7, RayStatus.TIR))
    # n^2 is -3 where the failed ray is
    start = dataclasses.replace(parallel(np.array([0.0, 2.0])), failure=jnp.array([0, lost]), opl=jnp.array([5.0, 6.0]))
    found = through(Rod(1.0, 1.0), start, 10.0, plane(4.0))
    assert found.end.failure.tolist() == [0, lost]
    assert found.end.opl is not None
    np.testing.assert_allclose(found.end.opl, [9.0, 6.0], rtol=1e-12)
    np.testing.assert_array_equal([found.end.y[1], found.end.z[1]], [2.0, 0.0])
    assert np.isfinite(found.end_index).all()


def test_a_start_without_an_index_is_refused() -> None:
    expected = r"ray 1 starts, at \(0, 2, 0\) mm: n\^2 must be above 0, got -3; start rays within the medium"
    with pytest.raises(RayError, match=expected):
        through(Rod(1.0, 1.0), parallel(np.array([0.0, 2.0])), 10.0, plane(4.0))
