"""Rays through an index that changes continuously, n(x, y, z).

With dt = ds / n the ray equation d/ds (n dr/ds) = grad n becomes

    d^2 r / dt^2 = grad n^2 / 2,      dr / dt = n d,      dL / dt = n^2,

d the unit direction, L the optical path: an equation of motion, solved by the method of Dormand and Prince of order 8 with
its own estimate of its error (scipy's DOP853); the gradient is exact, by automatic differentiation.
Source: Sharma, Kumar & Ghatak, Appl. Opt. 21, 984 (1982); Hairer, Norsett & Wanner, Solving Ordinary Differential
Equations I (1993), section II.10.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.errors import RayError
from lenstrace.optics.rays import Ray

SquaredIndex = Callable[[jax.Array, jax.Array, jax.Array], jax.Array]
# How often a boundary is looked for along a path, and how often the step in which it is found is halved.
LOOKS, HALVINGS = 400, 60
# The absolute tolerance of lengths, of the length of the path, for each unit of the relative one.
ABSOLUTE = 1e-3


@dataclass(frozen=True, eq=False)
class GradedPath:
    """The course of N rays, known at every t from 0 to `end`.

    end:          mm; t is the path divided by the index.
    evaluations:  how often the gradient was asked for: the cost.
    """

    end: float
    evaluations: int
    _squared: Any
    _solution: Any

    def at(self, t: np.ndarray | float) -> Ray:
        """The rays at t, mm: shape (N,) for a number or for an array (N,), one t for each ray; (K, N) for (K, 1)."""
        t = np.asarray(t, float)
        count = self._solution(0.0).size // 7
        values = self._solution(t.ravel()).reshape(7, count, *t.shape)
        if t.ndim == 1:
            values = np.diagonal(values, axis1=1, axis2=2)
        elif t.ndim == 2:
            values = np.swapaxes(values[..., 0], 1, 2)
        x, y, z, *momentum, opl = values
        index = np.sqrt(np.asarray(self._squared(x, y, z)))
        l, m, n = (p / index for p in momentum)
        return Ray(x, y, z, l, m, n, failure=np.zeros(x.shape, np.int32), opl=opl)  # type: ignore[arg-type]

    def first(self, beyond: Callable[[Ray], np.ndarray]) -> Ray:
        """Where each ray first comes to where `beyond` rises above 0, (N,); nan for one that never does.

        beyond: a number for each ray, negative before; what happens twice within a 400th of the path is overlooked.
        """
        times = np.linspace(0, self.end, LOOKS + 1)
        values = np.asarray(beyond(self.at(times[:, None])))
        rises = (values[:-1] < 0) & (values[1:] >= 0)
        found, step = rises.any(0), rises.argmax(0)
        low, high = times[step], times[step + 1]
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            outside = np.asarray(beyond(self.at(middle))) >= 0
            low, high = np.where(outside, low, middle), np.where(outside, middle, high)
        ray = self.at(np.where(found, high, 0))
        return jax.tree.map(lambda a: np.where(found, a, np.nan) if a.dtype.kind == "f" else a, ray)


def follow(squared_index: SquaredIndex, rays: Ray, end: float, tolerance: float = 1e-13) -> GradedPath:
    """Rays (N,) through a medium, from t = 0 to t = `end`, mm.

    squared_index:  n^2 at points x, y, z (mm), all of one shape; jax.numpy, positive wherever the rays come.
    rays:           points, mm, and unit directions.
    tolerance:      relative error of a step. RayError where the method finds no step that small enough.
    """
    from scipy.integrate import solve_ivp

    count = np.size(rays.x)
    squared = jax.jit(squared_index)
    force = jax.jit(jax.grad(lambda x, y, z: jnp.sum(squared_index(x, y, z)) / 2, (0, 1, 2)))
    point = np.array([np.ravel(a) for a in (rays.x, rays.y, rays.z)], float)
    direction = np.array([np.ravel(a) for a in (rays.l, rays.m, rays.n)], float)
    momentum = direction * np.sqrt(np.asarray(squared(*point)))

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        place, motion = state[: 3 * count].reshape(3, count), state[3 * count : 6 * count]
        pull = np.asarray(force(*place))
        return np.concatenate([motion, pull.ravel(), np.asarray(squared(*place))])

    start = np.concatenate([point.ravel(), momentum.ravel(), np.zeros(count)])
    solved = solve_ivp(
        rate, (0.0, end), start, "DOP853", dense_output=True, rtol=tolerance, atol=tolerance * ABSOLUTE * abs(end)
    )
    if not solved.success or not np.isfinite(solved.y[:, -1]).all():
        raise RayError(f"the rays cannot be followed through this medium: {solved.message}")
    return GradedPath(end, int(solved.nfev), squared, solved.sol)
