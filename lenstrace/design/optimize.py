"""Optimization: the lens of least merit, with the evidence."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable
from typing import overload

import jax
from jax.typing import ArrayLike

from lenstrace.design.batch import Minimum, search_many
from lenstrace.design.evidence import outcome_of
from lenstrace.design.opening import opened
from lenstrace.design.outcome import Minima, Optimized
from lenstrace.design.problem import Problem
from lenstrace.design.ready import begun
from lenstrace.design.search import METHODS, Course, Step, search, standing
from lenstrace.design.starts import distinct, starts_of
from lenstrace.errors import DesignError

# For each minimum that is kept, so many ends of searches are refined at most: many turn out to be the same lens.
REFINED = 3

Progress = Callable[[int, Step], None]


@overload
def optimize(
    problem: Problem,
    *,
    method: str = ...,
    seconds: float | None = ...,
    progress: Progress | None = ...,
    starts: None = ...,
) -> Optimized:
    """From the lens of the problem."""
    ...


@overload
def optimize(problem: Problem, *, starts: int | ArrayLike, seconds: float | None = ...) -> Minima:
    """From many starts."""
    ...


def optimize(
    problem: Problem,
    *,
    method: str = METHODS[0],
    seconds: float | None = None,
    progress: Progress | None = None,
    starts: int | ArrayLike | None = None,
) -> Optimized | Minima:
    """Change the numbers of a lens until its merit, the sum of squares of weighted residuals, is least.

    method:    "least_squares", scipy's bounded trust region search with the exact Jacobian; or "lbfgs", L-BFGS-B with
               the gradient in reverse, for hundreds of variables.
    seconds:   at most, for the search; the best lens so far is given then.
    progress:  called with the number of each evaluation and its `Step`.
    starts:    to search from many starts for several minima: see `optimize_from`, which it then calls.

    Ctrl-C gives the best lens so far. A program is compiled for each structure of a problem; none is for other numbers,
    weights, targets or bounds. The minimum that is found is a near one.
    DesignError for a problem that cannot be posed, LostRaysError where no ray of the start arrives.
    """
    if method not in METHODS:
        raise DesignError(f"method must be one of {', '.join(METHODS)}, got {method!r}")
    if starts is not None:
        if method != METHODS[0] or progress is not None:
            raise DesignError("starts: many searches have no method or progress; leave them out, or see optimize_from")
        return optimize_from(problem, starts, seconds=seconds)
    _check(problem, seconds)
    began = time.perf_counter()
    ready = begun(problem)
    compiled_after = time.perf_counter() - began
    start, left = ready.start, seconds
    if ready.before.lost > 0:
        deadline = math.inf if seconds is None else time.perf_counter() + seconds
        numbers, interrupted = opened(start, deadline, progress)
        left = None if seconds is None else max(deadline - time.perf_counter(), 0.0)
        start = dataclasses.replace(start, numbers=numbers)
        if interrupted:
            merit = float(jax.device_get(ready.merit.evaluated(numbers).terms.merit).sum())
            course = standing(numbers, merit, time.perf_counter() - began - compiled_after)
            return outcome_of(problem.lens, ready, course, compiled_after)
    course = search(ready.merit, start, method, left, progress)
    return outcome_of(problem.lens, ready, course, compiled_after)


def optimize_from(
    problem: Problem,
    starts: int | ArrayLike,
    *,
    keep: int = 16,
    seed: int = 0,
    seconds: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Minima:
    """Search from many starts at once, and keep the best distinct minima; those where rays are lost only if there are
    no others.

    starts:    how many: random ones, within the bounds of the variables where they have them (see `starts.ranges_of`),
               the first that of the problem. Or their numbers, (N, P), in the order of the variables.
    keep:      of the distinct minima, the best so many are refined as `optimize` does, and given.
    seed:      of the random numbers.
    seconds:   after so many no search is taken on; the best of those that have ended are refined then.
    progress:  called with how many searches have ended, and N.

    Ctrl-C gives what has been found so far.
    """
    _check(problem, seconds)
    if isinstance(keep, bool) or not isinstance(keep, int) or keep < 1:
        raise DesignError(f"keep must be a whole number, 1 or more, got {keep!r}")
    began = time.perf_counter()
    ready = begun(problem, checked=False)
    chosen = starts_of(ready.start, starts, seed)
    compiled_after = time.perf_counter() - began
    found, interrupted = search_many(ready.start, chosen, seconds, progress)
    refined: list[tuple[Minimum, Course]] = []
    for each in distinct(found, ready.start)[: REFINED * keep]:
        if interrupted:
            course = standing(each.numbers, each.merit, time.perf_counter() - began)
        else:
            there = dataclasses.replace(ready.start, numbers=each.numbers)
            course = search(ready.merit, there, METHODS[0], None, None)
            interrupted = course.interrupted
        refined.append((Minimum(course.numbers, course.steps[-1].best, each.start), course))
    apart = distinct([minimum for minimum, _ in refined], ready.start)
    courses = {minimum.start: course for minimum, course in refined}
    ends = [outcome_of(problem.lens, ready, courses[each.start], compiled_after, many=True) for each in apart]
    lenses = [end for end in ends if not end.lost] or ends
    seconds = time.perf_counter() - began
    return Minima(tuple(lenses[:keep]), len(lenses), len(found), len(chosen), seconds, interrupted)


def _check(problem: Problem, seconds: float | None) -> None:
    if not isinstance(problem, Problem):
        raise DesignError(
            f"a lenstrace.Problem is needed, got {type(problem).__name__}; say Problem(lens, vary=..., want=...)"
        )
    if seconds is not None and (not isinstance(seconds, int | float) or not seconds > 0):
        raise DesignError(f"seconds must be positive, got {seconds!r}")
