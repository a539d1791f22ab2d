"""Areas against closed forms, and places that are even by area: their means and counts."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import chi2

from tests.optics.shapes.cases import A, B, C, N, found, shape_of

BINS, COUNT = 8, 200_000
AREAS = {
    "sphere": 4 * math.pi * 1.69,
    "rectangle": 4 * 1.5 * 0.7,
    "disk": math.pi * (1.4**2 - 0.4**2),
    "triangle": float(np.linalg.norm(N)) / 2,
}
MIDDLES = {"triangle": np.mean([A, B, C], 0)}


def halves(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Coordinates of a place in the triangle along two of its sides."""
    return np.linalg.lstsq(np.stack([a, b], 1), p, rcond=None)[0]


def of_triangle(p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    s, t = halves(p - np.array(A)[:, None], np.subtract(B, A), np.subtract(C, A))
    # the share of the area nearer to c, and the place in the strip: another way than that of the code
    return 1 - (1 - t) ** 2, s / (1 - t)


EVEN: dict[str, Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]] = {
    "sphere": lambda p: ((p[1] / 1.3 + 1) / 2, np.arctan2(p[0], p[2]) / (2 * np.pi) + 0.5),
    "rectangle": lambda p: ((p[0] / 1.5 + 1) / 2, (p[1] / 0.7 + 1) / 2),
    "disk": lambda p: (((p[0] ** 2 + p[1] ** 2) - 0.16) / 1.8, np.arctan2(p[1], p[0]) / (2 * np.pi) + 0.5),
    "triangle": of_triangle,
}


@pytest.mark.parametrize("name", AREAS)
def test_area(name: str) -> None:
    shape: Any = shape_of(name)
    assert_allclose(shape.area(), AREAS[name], rtol=1e-15)


@pytest.mark.parametrize("name", AREAS)
@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
def test_places_are_on_the_shape_and_even_by_area(name: str, dtype: Any) -> None:
    shape: Any = shape_of(name, 1.0, dtype)
    u, v = np.random.default_rng(1).uniform(size=(2, COUNT)).astype(dtype)
    place = np.stack(shape.place(jnp.asarray(u), jnp.asarray(v)))
    assert place.dtype == dtype
    assert np.abs(shape.value(tuple(map(jnp.asarray, place)))).max() < 4 * jnp.finfo(dtype).eps
    place = place.astype(float)
    spread = place.std(1) / math.sqrt(COUNT)
    assert (np.abs(place.mean(1) - MIDDLES.get(name, np.zeros(3))) <= 5 * spread + 1e-6).all()
    counts = np.histogram2d(*EVEN[name](place), bins=BINS, range=[[0, 1], [0, 1]])[0]
    assert counts.sum() > COUNT - 20  # the rest is rounded to beyond a rim
    expected = COUNT / BINS**2
    statistic = ((counts - expected) ** 2 / expected).sum()
    assert chi2.cdf(statistic, BINS**2 - 1) < 1 - 1e-4


@pytest.mark.parametrize("name", AREAS)
def test_a_ray_to_a_place_meets_it(name: str) -> None:
    shape: Any = shape_of(name)
    u, v = np.random.default_rng(2).uniform(0.001, 0.999, (2, 1000))
    place = np.stack(shape.place(jnp.asarray(u), jnp.asarray(v)))
    normal = np.stack(shape.normal(tuple(map(jnp.asarray, place))))
    distance, real = found(shape, place + 2 * normal, -normal)
    assert np.isclose(np.where(real, distance, np.inf), 2, rtol=0, atol=1e-14).any(0).all()


@pytest.mark.parametrize("name", AREAS)
def test_the_first_number_may_be_0(name: str) -> None:
    shape: Any = shape_of(name)
    assert np.isfinite(np.stack(shape.place(jnp.zeros(()), jnp.zeros(())))).all()
