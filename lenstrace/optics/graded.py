"""Rays through an index that changes continuously, n(x, y, z).

With p = n d, d the unit direction, and the optical path L as the parameter, dL = n ds, the ray equation
d/ds (n dr/ds) = grad n becomes

    dr / dL = p / n^2,      dp / dL = grad n^2 / (2 n^2):

rays at the same L are on one wavefront. It is solved by the method of Dormand and Prince of order 8 with its own
estimate of its error (scipy's DOP853); the gradient is exact, by automatic differentiation.
Source: Born & Wolf, Principles of Optics (7th ed.), section 3.2.1; Hairer, Norsett & Wanner, Solving Ordinary
Differential Equations I (1993), section II.10.
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
STEPS = 100


@dataclass(frozen=True, eq=False)
class GradedPath:
    """The course of N rays, known at every optical path from 0 to `end`, mm.

    evaluations:  how often the gradient was asked for: the cost.
    """

    end: float
    evaluations: int
    _solution: Any

    def at(self, opl: np.ndarray | float) -> Ray:
        """The rays at optical paths, mm: one for all, (N,) for each ray, or (K, 1) or (K, N) for K places of each."""
        count = self._solution(0.0).size // 6
        paths = np.broadcast_to(opl, np.broadcast_shapes(np.shape(opl), (count,)))
        # the solution gives all rays for every path; each ray wants its own
        values = np.stack(
            [self._solution(own).reshape(6, count, -1)[:, i] for i, own in enumerate(paths.reshape(-1, count).T)], -1
        )
        values = values.reshape(6, *paths.shape)
        x, y, z, *momentum = values
        length = np.sqrt(sum(p * p for p in momentum))
        l, m, n = (p / length for p in momentum)
        return Ray(x, y, z, l, m, n, failure=np.zeros(x.shape, np.int32), opl=paths)  # type: ignore[arg-type]

    def first(self, beyond: Callable[[Ray], np.ndarray]) -> Ray:
        """Where each ray first comes to where `beyond` rises above 0, (N,); nan for one that never does.

        beyond: a number for each ray, negative before; what happens twice within a 400th of the path is overlooked.
        """
        paths = np.linspace(0, self.end, LOOKS + 1)
        values = np.asarray(beyond(self.at(paths[:, None])))
        rises = (values[:-1] < 0) & (values[1:] >= 0)
        found, step = rises.any(0), rises.argmax(0)
        low, high = paths[step], paths[step + 1]
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            outside = np.asarray(beyond(self.at(middle))) >= 0
            low, high = np.where(outside, low, middle), np.where(outside, middle, high)
        ray = self.at(np.where(found, high, 0))
        return jax.tree.map(lambda a: np.where(found, a, np.nan) if a.dtype.kind == "f" else a, ray)


def follow(
    squared_index: SquaredIndex, rays: Ray, end: float, *, tolerance: float = 1e-13, steps: int = STEPS
) -> GradedPath:
    """Rays (N,) through a medium, as far as the optical path `end`, mm.

    squared_index:  n^2 at points x, y, z (mm), all of one shape; jax.numpy, positive wherever the rays come.
    rays:           points, mm, and unit directions.
    tolerance:      relative error of a step. RayError where the method finds no step that is small enough.
    steps:          at least so many are taken: between them the path is interpolated, by an order less.
    """
    from scipy.integrate import solve_ivp

    count = np.size(rays.x)

    @jax.jit
    def rates(place: jax.Array, momentum: jax.Array) -> tuple[jax.Array, jax.Array]:
        square = squared_index(*place)
        slopes = jax.grad(lambda place: jnp.sum(squared_index(*place)))(place)
        return momentum / square, slopes / (2 * square)

    point = np.array([np.ravel(a) for a in (rays.x, rays.y, rays.z)], float)
    direction = np.array([np.ravel(a) for a in (rays.l, rays.m, rays.n)], float)
    momentum = direction * np.sqrt(np.asarray(jax.jit(squared_index)(*point)))

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        return np.concatenate(rates(*state.reshape(2, 3, count))).ravel()

    start = np.concatenate([point.ravel(), momentum.ravel()])
    solved = solve_ivp(
        rate,
        (0.0, end),
        start,
        "DOP853",
        dense_output=True,
        max_step=abs(end) / steps,
        rtol=tolerance,
        atol=tolerance * ABSOLUTE * abs(end),
    )
    if not solved.success or not np.isfinite(solved.y[:, -1]).all():
        raise RayError(f"the rays cannot be followed through this medium: {solved.message}")
    return GradedPath(end, int(solved.nfev), solved.sol)
