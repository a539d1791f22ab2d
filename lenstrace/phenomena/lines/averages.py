"""Averages over a unit cube by points of three kinds, each with an estimate of its error.

Random points: the standard error. Scrambled Sobol points: the spread of independent scramblings. Gauss's rule: how far
it is from two coarser ones.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

SCRAMBLINGS = 16  # that the points of one average are shared out to
ROUNDING = 1e-14  # of an average

Integrand = Callable[[np.ndarray], np.ndarray]
Points = Callable[[int, int, tuple[int, ...]], np.ndarray]


class Average(NamedTuple):
    """A value, what it may be off by (one standard deviation where there is chance), and the points it took."""

    value: float
    error: float
    points: int


def random_points(dimensions: int, count: int, seed: tuple[int, ...]) -> np.ndarray:
    """Independent points, (N, D); more of them begin with the same ones."""
    return np.random.default_rng(seed).random((count, dimensions))


def sobol_points(dimensions: int, count: int, seed: tuple[int, ...]) -> np.ndarray:
    """Sobol points in one scrambling, (N, D), N a power of two; more of them begin with the same ones."""
    from scipy.stats import qmc  # 0.4 s to import, needed here alone

    return qmc.Sobol(dimensions, rng=np.random.default_rng(seed)).random(count)


def gauss_rule(dimensions: int, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (N, D) and weights (N,) of the product of Gauss's rules, N = nodes^D."""
    places, weights = np.polynomial.legendre.leggauss(nodes)
    grid = np.meshgrid(*[(1 + places) / 2] * dimensions, indexing="ij")
    product = weights / 2
    for _ in range(dimensions - 1):
        product = np.multiply.outer(product, weights / 2)
    return np.stack(grid, -1).reshape(-1, dimensions), product.ravel()


def by_random(f: Integrand, dimensions: int, count: int, seed: tuple[int, ...]) -> Average:
    """By independent points."""
    values = f(random_points(dimensions, count, seed))
    return Average(float(values.mean()), float(values.std(ddof=1)) / math.sqrt(count), count)


def by_sobol(f: Integrand, dimensions: int, count: int, seed: tuple[int, ...]) -> Average:
    """By Sobol points in independent scramblings; count: a power of two, of all of them together."""
    each = count // SCRAMBLINGS
    values = np.array([f(sobol_points(dimensions, each, (*seed, i))).mean() for i in range(SCRAMBLINGS)])
    return Average(float(values.mean()), float(values.std(ddof=1)) / math.sqrt(SCRAMBLINGS), count)


def by_gauss(f: Integrand, dimensions: int, nodes: int) -> Average:
    """By Gauss's rule with so many nodes along each axis."""
    value, *coarser = (gauss_value(f, dimensions, n) for n in (nodes, nodes // 2 + 1, nodes // 2))
    error = max(abs(value - other) for other in coarser)
    return Average(value, error + ROUNDING * abs(value), nodes**dimensions)


def gauss_value(f: Integrand, dimensions: int, nodes: int) -> float:
    """The value alone."""
    points, weights = gauss_rule(dimensions, nodes)
    # not `weights @ ...`: a product of vectors wakes threads, which take longer than it does
    return float((weights * f(points)).sum())


def averages_of_sets(
    f: Integrand, points: Points, dimensions: int, sizes: np.ndarray, sets: int, seed: int
) -> np.ndarray:
    """Averages of independent sets of points, (sets, sizes): of each the first so many; sizes: ascending."""
    most = int(sizes[-1])
    return np.stack([f(points(dimensions, most, (seed, i))).cumsum()[sizes - 1] / sizes for i in range(sets)])


def slope(counts: np.ndarray, errors: np.ndarray) -> float:
    """Of the straight line through the logarithms of errors against those of counts."""
    return float(np.polyfit(np.log(counts), np.log(errors), 1)[0])
