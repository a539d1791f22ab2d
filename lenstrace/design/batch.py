"""Damped least squares in JAX: many starts at once, each with its own damping and its own end.

Levenberg's and Marquardt's step (A + lambda D) d = -g, A = J^T J, g = J^T r, D = diag A, for the numbers that are free:
one at its bound whose slope leads out of it stays there, and a step that would leave the bounds ends on them. lambda
follows how well the step was foretold. Source: Nielsen, IMM-REP-1999-05 (Technical University of Denmark, 1999).
"""

from __future__ import annotations

import functools
import os
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Event
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.compute.compiled import LONG_OPTIONS, with_precision
from lenstrace.compute.packing import Packing, packed
from lenstrace.design.merit import KEPT, residuals
from lenstrace.design.problem import Start

# Starts that a program takes on side by side, and steps they take before those that have ended make room.
LANES, STEPS = 8, 10
THREADS = os.cpu_count() or 1
MOST_STEPS = 200
# Of the diagonal, at first; where it is above the last, no step is short enough to help.
DAMPING, MOST_DAMPING = 1e-2, 1e12
# A step that lessens the merit by less than this part of it is the last.
TOLERANCE = 1e-7
# Of the largest number on the diagonal: what does not move the residuals stays.
LEAST_DIAGONAL = 1e-12


class Lane(NamedTuple):
    """One search: numbers (P,), merit, A (P, P) and g (P,) there, damping and its growth, steps taken, whether it has
    ended."""

    numbers: Any
    merit: Any
    matrix: Any
    slope: Any
    damping: Any
    growth: Any
    steps: Any
    ended: Any


class Minimum(NamedTuple):
    """Where a search ended: numbers (P,), the merit there, and the place of its start."""

    numbers: np.ndarray
    merit: float
    start: int


def search_many(
    start: Start, starts: np.ndarray, seconds: float | None, progress: Callable[[int, int], None] | None
) -> tuple[list[Minimum], bool]:
    """Minima near to each of many starts (N, P), in the order in which they were found.

    seconds:  after so many no more are sought.
    progress: called with how many have ended, and N. Ctrl-C gives those found so far, and True.
    """
    fixed, packing = packed(start.posed)
    advanced, asked = _advanced(packing), (fixed, start.low, start.high)
    waiting, found = deque(enumerate(starts)), list[Minimum]()
    count = starts.shape[1]
    stopped, began = Event(), time.perf_counter()

    def work(_: int) -> None:
        places: list[int | None] = [None] * LANES
        nothing, one = np.zeros(LANES), np.ones(LANES)
        matrix, slope = np.zeros((LANES, count, count)), np.zeros((LANES, count))
        numbers = np.tile(start.numbers, (LANES, 1))
        lanes = Lane(numbers, nothing, matrix, slope, one, one, np.zeros(LANES, int), np.ones(LANES, bool))
        while not stopped.is_set() and (seconds is None or time.perf_counter() - began < seconds):
            fresh = np.zeros(LANES, bool)
            for i in range(LANES):
                if places[i] is None and waiting:
                    places[i], lanes.numbers[i] = waiting.popleft()
                    fresh[i] = True
            if all(place is None for place in places):
                return
            lanes = jax.tree.map(np.array, advanced(asked, lanes, fresh))
            for i, place in enumerate(places):
                if place is not None and lanes.ended[i]:
                    found.append(Minimum(lanes.numbers[i].copy(), float(lanes.merit[i]), place))
                    places[i] = None
            if progress is not None:
                progress(len(found), len(starts))

    with ThreadPoolExecutor(THREADS) as threads:
        working = [threads.submit(with_precision(work), i) for i in range(THREADS)]
        try:
            for each in working:
                each.result()
        except KeyboardInterrupt:
            stopped.set()
    return found, stopped.is_set()


@functools.lru_cache(maxsize=KEPT)
def _advanced(packing: Packing) -> Any:
    """A function that takes lanes on by STEPS steps; those that are fresh from their numbers alone."""

    def of_one(asked: Any, lane: Lane, fresh: jax.Array) -> Lane:
        fixed, low, high = asked

        def at(numbers: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
            """Merit, A and g."""
            unit = jnp.eye(len(numbers), dtype=numbers.dtype)
            of = functools.partial(residuals, packing, fixed)
            residual, jacobian = jax.vmap(
                lambda direction: jax.jvp(lambda p: of(p)[0], (numbers,), (direction,)), out_axes=(None, 0)
            )(unit)
            return residual @ residual, jacobian @ jacobian.T, jacobian @ residual

        def step(_: int, lane: Lane) -> Lane:
            trial, foretold = _trial(lane, low, high)
            merit, matrix, slope = at(trial)
            gain = (lane.merit - merit) / jnp.where(foretold > 0, foretold, 1.0)
            better = merit < lane.merit
            # nan is not better
            shrunk = lane.damping * jnp.maximum(1 / 3, 1 - (2 * jnp.clip(gain, 0.0, 1.0) - 1) ** 3)
            last = better & (lane.merit - merit < TOLERANCE * lane.merit)
            after = Lane(
                jnp.where(better, trial, lane.numbers),
                jnp.where(better, merit, lane.merit),
                jnp.where(better, matrix, lane.matrix),
                jnp.where(better, slope, lane.slope),
                jnp.where(better, shrunk, lane.damping * lane.growth),
                jnp.where(better, 2.0, 2 * lane.growth),
                lane.steps + 1,
                last | (lane.damping > MOST_DAMPING) | (lane.steps >= MOST_STEPS),
            )
            return jax.tree.map(lambda old, new: jnp.where(lane.ended, old, new), lane, after)

        merit, matrix, slope = at(lane.numbers)
        begun = Lane(
            lane.numbers,
            merit,
            matrix,
            slope,
            jnp.full_like(merit, DAMPING),
            jnp.full_like(merit, 2.0),
            jnp.zeros_like(lane.steps),
            ~jnp.isfinite(merit + jnp.sum(matrix)),
        )
        lane = jax.tree.map(lambda new, old: jnp.where(fresh, new, old), begun, lane)
        return lax.fori_loop(0, STEPS, step, lane)

    return jax.jit(jax.vmap(of_one, in_axes=(None, 0, 0)), compiler_options=LONG_OPTIONS)


def _trial(lane: Lane, low: jax.Array, high: jax.Array) -> tuple[jax.Array, jax.Array]:
    """The numbers after a step, and by how much it should lessen the merit."""
    numbers, slope = lane.numbers, lane.slope
    stays = ((numbers <= low) & (slope > 0)) | ((numbers >= high) & (slope < 0))
    free = jnp.where(stays, 0.0, 1.0)
    diagonal = jnp.diag(lane.matrix)
    scale = jnp.maximum(diagonal, LEAST_DIAGONAL * jnp.max(diagonal))
    scale = jnp.where(scale > 0, scale, 1.0)
    root = jnp.sqrt(scale)
    # in units of the diagonal, so that numbers of every size stand alike
    within = lane.matrix * (free[:, None] * free) / (root[:, None] * root)
    damped = within + jnp.diag(jnp.where(stays, 1.0, lane.damping))
    moved = jnp.linalg.solve(damped, -slope * free / root) / root
    trial = jnp.clip(numbers + moved, low, high)
    step = trial - numbers
    return trial, -(2 * step @ slope + step @ lane.matrix @ step)
