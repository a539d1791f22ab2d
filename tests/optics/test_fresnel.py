"""Fresnel's reflectances against mpmath, in the forms of sines and tangents; derivatives, limits, energy."""

from typing import Any

import jax
import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose

from lenstrace.optics.fresnel import reflectances

PAIRS = [(1.0, 1.5), (1.5, 1.0), (1.0, 4.0), (1.0, 1.0 + 1e-9), (1.333, 1.0), (0.2, 3.0)]
both = jax.jit(reflectances)
slopes = jax.jit(jax.jacfwd(reflectances, argnums=(0, 1, 2)))


@jax.jit
def pulled(cosines: jax.Array, before: jax.Array, after: jax.Array) -> tuple[Any, Any]:
    """Both reflectances, and the derivatives of their sum in reverse."""
    values, pull = jax.vjp(reflectances, cosines, before, after)
    return values, pull((jnp.ones_like(cosines), jnp.ones_like(cosines)))


def by_angles(angle: mpmath.mpf, before: float, after: float) -> tuple[float, float]:
    """sin^2(t1 - t2) / sin^2(t1 + t2) and tan^2(t1 - t2) / tan^2(t1 + t2)."""
    sine = mpmath.mpf(before) / mpmath.mpf(after) * mpmath.sin(angle)
    if sine >= 1:
        return 1.0, 1.0
    bent = mpmath.asin(sine)
    s = (mpmath.sin(angle - bent) / mpmath.sin(angle + bent)) ** 2
    return float(s), float((mpmath.tan(angle - bent) / mpmath.tan(angle + bent)) ** 2)


@pytest.mark.parametrize(("before", "after"), PAIRS)
def test_against_the_forms_of_sines_and_tangents(before: float, after: float) -> None:
    with mpmath.workdps(50):
        angles = [mpmath.mpf(k) / 64 for k in (1, 5, 20, 40, 50, 70, 90, 100)]
        cosines = np.array([float(mpmath.cos(angle)) for angle in angles])
        expected = np.array([by_angles(mpmath.acos(mpmath.mpf(cosine)), before, after) for cosine in cosines]).T
    assert_allclose(both(cosines, before, after), expected, rtol=2e-12, atol=1e-33)


def test_published_values() -> None:
    s, p = both(np.sqrt(0.5), 1.0, 1.5)
    assert_allclose((s, p), (0.0920133630455, 0.00846645897895), atol=6e-15)
    assert_allclose(both(1.0, 1.0, 1.5), 0.04, rtol=1e-15)
    # Brewster's angle
    assert_allclose(both(np.cos(np.deg2rad(56.309932474)), 1.0, 1.5)[1], 0, atol=1e-22)


@pytest.mark.parametrize("cosine", [1.0, 0.6, 0.0])
def test_limits(cosine: float) -> None:
    assert_allclose(both(cosine, 1.3, 1.3), 0)
    assert_allclose(both(cosine, 1.0, -1.0), 0)
    assert_allclose(both(cosine, 1.0, -1.5), both(cosine, 1.0, 1.5))
    if cosine == 0:
        assert_allclose(both(cosine, 1.0, 1.5), 1, rtol=1e-15)
        assert_allclose(both(cosine, 1.5, 1.0), 1)


def test_the_same_from_either_side() -> None:
    angle = np.linspace(0, 1.5, 20)
    bent = np.arcsin(np.sin(angle) / 1.7)
    assert_allclose(both(np.cos(angle), 1.0, 1.7), both(np.cos(bent), 1.7, 1.0), rtol=1e-12, atol=1e-16)


@pytest.mark.parametrize(("before", "after"), PAIRS[:3])
@pytest.mark.parametrize("cosine", [1.0, 0.9, 0.3])
def test_derivatives(cosine: float, before: float, after: float) -> None:
    step = 1e-6
    found = slopes(cosine, before, after)
    for k in range(2):
        for place in range(3):
            moved = np.array([[cosine, before, after]] * 2)
            moved[:, place] += [step, -step]
            above, below = (float(both(*each)[k]) for each in moved)
            assert_allclose(found[k][place], (above - below) / (2 * step), rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
@pytest.mark.parametrize(("before", "after"), [(1.0, 1.5), (1.5, 1.0), (1.5, 1.5), (1.0, -1.5), (1.0, -1.0)])
def test_derivatives_are_finite_everywhere(before: float, after: float, dtype: type) -> None:
    critical = float(np.sqrt(max(1 - (after / before) ** 2, 0)))
    edge = np.asarray([critical, np.nextafter(critical, 0), np.nextafter(critical, 1), critical / 2, 0, 1e-30, 1])
    cosines = jnp.asarray(edge, dtype)
    indices = jnp.full(len(edge), before, dtype), jnp.full(len(edge), after, dtype)
    values, derivatives = (tuple(map(np.asarray, each)) for each in pulled(cosines, *indices))
    for each in (*values, *derivatives):
        assert each.dtype == dtype
        assert np.isfinite(each).all()
    assert all(((each >= 0) & (each <= 1 + 4 * np.finfo(dtype).eps)).all() for each in values)
    if after == 1.0:
        # total reflection: R is 1, whatever the angle
        assert all(each[3] == 1 and each[4] == 1 for each in values)
        assert all(each[3] == 0 for each in derivatives)


def test_single_precision() -> None:
    cosines = np.linspace(0.01, 1, 50)
    single = both(*(jnp.asarray(each, jnp.float32) for each in (cosines, 1.0, 1.5)))
    assert_allclose(single, both(cosines, 1.0, 1.5), rtol=2e-5, atol=1e-7)
