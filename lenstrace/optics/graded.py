"""Rays through a medium whose index changes from place to place: an ordinary differential equation.

With dt = ds / n and p = n times the direction, d/ds (n dr/ds) = grad n becomes

    dr/dt = p,      dp/dt = grad(n^2) / 2,      dL/dt = n^2,

L the optical path; |p| = n along the whole course. All rays run together, by Dormand and Prince's method of order 8.
Source: A. Sharma, D. V. Kumar, A. K. Ghatak, Appl. Opt. 21, 984 (1982); Hairer, Norsett, Wanner, "Solving Ordinary
Differential Equations I" (1993).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.errors import AccuracyError, OptionError, RayError
from lenstrace.optics.rays import Ray, RayStatus, failure_code

# Relative error that a step may make: more accurate than this float64 cannot be.
LEAST_TOLERANCE, MOST_TOLERANCE = 1e-13, 1e-1
# The smallest relative error that scipy's solver takes.
LEAST_OF_SOLVER = 100 * np.finfo(float).eps
# Numbers smaller than this part of the reach, or of 1 for p, are as accurate as numbers of that size.
FLOOR = 1e-3
# A boundary is looked for at so many places along the whole way, closer at first, for rays that soon end; then it is
# met by halving, to the last digit.
LOOKS = 256
HALVINGS = 50


class Field(Protocol):
    """A medium: a pytree, so that one program serves all its numbers."""

    def square(self, x: jax.Array, y: jax.Array, z: jax.Array, /) -> jax.Array:
        """n^2 at points in mm, of their shape; smooth wherever a ray goes and for some way beyond the boundary."""
        ...


# Of points (3, N) in mm and n times their directions (3, N): (N,) numbers that rise through 0 where rays end.
Boundary = Callable[[np.ndarray, np.ndarray], np.ndarray]


class Course(NamedTuple):
    """Where N rays went.

    end:       where they ended, their optical path added to that of the start; MISSED those that met no boundary.
    points:    (3, samples, N), mm, from the start to the end in equal parts of t.
    end_index: (N,), n there.
    drift:     (N,), how far |p| / n departs from 1 at the end: 0 but for the errors of the steps.
    calls:     how often the equation was evaluated, for all rays at once.
    """

    end: Ray
    points: np.ndarray
    end_index: np.ndarray
    drift: np.ndarray
    calls: int


def through(
    field: Field,
    start: Ray,
    reach: float,
    boundary: Boundary,
    *,
    tolerance: float = 1e-12,
    samples: int = 2,
) -> Course:
    """Rays from where they start to where they first leave through a boundary.

    field:      the medium.                  start: (N,), points in mm, unit directions; failed rays stay there.
    reach:      how far rays are followed at most, of t, mm: way divided by index.
    boundary:   negative inside; a ray may start on it.
    tolerance:  relative error of one step; those of the end are some ten times as large, see `Course.drift`. The
                steps serve all N rays: the solver, which bounds the mean square over all numbers of all rays, is
                given tolerance / sqrt(N), so that no ray hides its error behind easier ones.
    OptionError for a tolerance beyond what float64 allows, AccuracyError where the steps become too small, RayError for
    a start where n^2 is not positive.
    """
    from scipy.integrate import solve_ivp

    if not LEAST_TOLERANCE <= tolerance <= MOST_TOLERANCE:
        raise OptionError(
            f"tolerance must be at least {LEAST_TOLERANCE:g} and at most {MOST_TOLERANCE:g}, got {tolerance!r}"
        )
    places = np.array([start.x, start.y, start.z], float)
    directions = np.array([start.l, start.m, start.n], float)
    living, paths = np.asarray(start.ok), np.zeros((1, places.shape[1]))
    first = np.concatenate([places, _first_index(field, places, living) * directions, paths])

    def slope(_: float, state: np.ndarray) -> np.ndarray:
        now = state.reshape(first.shape)
        square, forces = _forces(field, *now[:3])
        return np.where(living, np.concatenate([now[3:6], forces, np.asarray(square)[None]]), 0).ravel()

    size = np.array([reach] * 3 + [1.0] * 3 + [reach])
    of_bundle = tolerance / np.sqrt(places.shape[1])
    # a first step that is far too long may meet numbers that overflow, and is then made shorter
    with np.errstate(over="ignore", invalid="ignore"):
        solved = solve_ivp(
            slope,
            (0.0, reach),
            first.ravel(),
            method="DOP853",
            rtol=max(of_bundle, LEAST_OF_SOLVER),
            atol=np.repeat(FLOOR * of_bundle * size, places.shape[1]),
            dense_output=True,
        )
    if not solved.success:
        raise AccuracyError(f"rays cannot be followed through this medium: {solved.message}; take a larger tolerance")

    state_at = _each_at(solved.sol, first.shape)
    ends, met = _ends(solved.sol, state_at, boundary, reach, first.shape)
    last = state_at(ends)
    sampled = np.stack([state_at(part * ends)[:3] for part in np.linspace(0, 1, samples)], 1)
    length = np.sqrt((last[3:6] ** 2).sum(0))
    index = np.sqrt(np.where(living, _forces(field, *last[:3])[0], 1))
    failure = np.where(living, np.where(met, 0, failure_code(1, RayStatus.MISSED)), start.failure).astype(np.int32)
    opl = last[6] if start.opl is None else last[6] + np.asarray(start.opl)
    end = Ray(*last[:3], *(last[3:6] / length), failure=jnp.asarray(failure), opl=opl)
    return Course(end, sampled, index, length / index - 1, solved.nfev)


def _first_index(field: Field, points: np.ndarray, living: np.ndarray) -> np.ndarray:
    """n where rays start, at points (3, N), and 1 for failed ones; RayError where n^2 is not positive."""
    square = np.asarray(_forces(field, *points)[0])
    bad = living & ~(square > 0)
    if bad.any():
        first = bad.argmax()
        x, y, z = points[:, first]
        raise RayError(
            f"the medium has no index where ray {first} starts, at ({x:g}, {y:g}, {z:g}) mm: n^2 must be above 0, "
            f"got {square[first]:g}; start rays within the medium"
        )
    return np.sqrt(np.where(living, square, 1))


@jax.jit
def _forces(field: Field, x: jax.Array, y: jax.Array, z: jax.Array) -> tuple[jax.Array, jax.Array]:
    """n^2, (N,), and half its gradient, (3, N)."""
    square, back = jax.vjp(field.square, x, y, z)
    return square, jnp.stack(back(jnp.full_like(square, 0.5)))


def _each_at(solution: Any, shape: tuple[int, ...]) -> Callable[[np.ndarray], np.ndarray]:
    """(7, N) of one t for each ray, out of scipy's solution for all rays at once; shape: (7, N).

    In a step from t0 to t1, u = (t - t0) / (t1 - t0), the state is y0 + u (F0 + (1 - u) (F1 + u (F2 + ... u F6))).
    Source: Hairer, Norsett, Wanner, section II.6.
    """
    times = solution.ts
    begin = np.array([step.y_old.reshape(shape) for step in solution.interpolants])
    factors = np.array([step.F.reshape(-1, *shape) for step in solution.interpolants])

    def at(t: np.ndarray) -> np.ndarray:
        ray = np.arange(len(t))
        step = np.clip(np.searchsorted(times, t) - 1, 0, len(begin) - 1)
        u = (t - times[step]) / (times[step + 1] - times[step])
        state = np.zeros(shape)
        for order in reversed(range(factors.shape[1])):
            state = (state + factors[step, order, :, ray].T) * (1 - u if order % 2 else u)
        return state + begin[step, :, ray].T

    return at


def _ends(
    states_at: Callable[[np.ndarray], np.ndarray],
    state_at: Callable[[np.ndarray], np.ndarray],
    boundary: Boundary,
    reach: float,
    shape: tuple[int, ...],
) -> tuple[np.ndarray, np.ndarray]:
    """The t of every ray where it first leaves through the boundary, (N,), or the last one; and whether it does.

    states_at: (7 N, T) of times (T,).      state_at: (7, N) of one time for each ray.      shape: (7, N).
    """
    times = reach * np.linspace(0, 1, LOOKS) ** 2
    looks = states_at(times).reshape(*shape, LOOKS)
    heights = np.stack([boundary(now[:3], now[3:6]) for now in np.moveaxis(looks, -1, 0)])
    leaves = (heights[:-1] < 0) & (heights[1:] >= 0)
    met, place = leaves.any(0), leaves.argmax(0)
    before = np.where(met, times[place], reach)
    behind = np.where(met, times[place + 1], reach)
    for _ in range(HALVINGS):
        middle = (before + behind) / 2
        now = state_at(middle)
        outside = boundary(now[:3], now[3:6]) >= 0
        before, behind = np.where(outside, before, middle), np.where(outside, middle, behind)
    return behind, np.asarray(met)
