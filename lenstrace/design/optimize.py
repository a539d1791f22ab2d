"""Optimization: the lens of least merit, with the evidence."""

from __future__ import annotations

import dataclasses
import importlib
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple, overload

import jax
import numpy as np
from jax.typing import ArrayLike

from lenstrace.design.batch import Minimum, search_many
from lenstrace.design.merit import Merit, Terms
from lenstrace.design.opening import opened
from lenstrace.design.outcome import Change, Minima, Optimized, Term
from lenstrace.design.problem import Problem, Start, check, start_of
from lenstrace.design.search import BETTER, METHODS, Course, Step, search
from lenstrace.design.starts import distinct, starts_of
from lenstrace.errors import DesignError
from lenstrace.sequential.lens import Lens

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
    if starts is not None:
        return optimize_from(problem, starts, seconds=seconds)
    if method not in METHODS:
        raise DesignError(f"method must be one of {', '.join(METHODS)}, got {method!r}")
    _check(problem, seconds)
    began = time.perf_counter()
    ready = begun(problem)
    compiled_after = time.perf_counter() - began
    start = ready.start
    if ready.before.lost > 0:
        start = dataclasses.replace(start, numbers=opened(start, seconds))
    course = search(ready.merit, start, method, seconds, progress)
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
    began = time.perf_counter()
    ready = begun(problem, checked=False)
    chosen = starts_of(ready.start, starts, seed)
    compiled_after = time.perf_counter() - began
    found, interrupted = search_many(ready.start, chosen, seconds, progress)
    refined: list[tuple[Minimum, Course]] = []
    for each in distinct(found, ready.start)[: REFINED * keep]:
        course = search(ready.merit, dataclasses.replace(ready.start, numbers=each.numbers), METHODS[0], None, None)
        refined.append((Minimum(course.numbers, course.steps[-1].best, each.start), course))
        interrupted = interrupted or course.interrupted
        if interrupted:
            break
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


class Ready(NamedTuple):
    """A problem whose search may begin: its merit is compiled, and known at the start."""

    start: Start
    merit: Merit
    before: Terms


def begun(problem: Problem, checked: bool = True) -> Ready:
    """Pose a problem and compile its merit. DesignError, ImageError or LostRaysError where it has no start.

    checked: whether all that is wanted must exist at the start; flat plates have no focal length, but lead to some."""
    start = start_of(problem)
    try:
        Merit(start.posed).begin(start.numbers)
    except Exception:
        check(start)  # says more clearly what there is not
        raise
    # while it is compiled
    if checked:
        check(start)
    importlib.import_module("scipy.optimize")  # 0.2 s, needed next
    terms = _evaluated(start)
    wants = tuple(
        want if failure is None else want.counting(np.asarray(failure))
        for want, failure in zip(start.posed.wants, terms.failure, strict=True)
    )
    start = dataclasses.replace(start, posed=dataclasses.replace(start.posed, wants=wants))
    return Ready(start, Merit(start.posed), _evaluated(start))


def outcome_of(lens: Lens, ready: Ready, course: Course, compiled_after: float, many: bool = False) -> Optimized:
    """The outcome of a search; many: it began elsewhere than at the lens, and may have ended at a worse one."""
    start, before = ready.start, ready.before
    after = jax.device_get(ready.merit.evaluated(course.numbers).terms)
    merits = float(before.merit.sum()), float(after.merit.sum())
    improved = merits[1] < merits[0] * (1 - BETTER)
    numbers, found = course.numbers, lens
    if improved or many:
        # what was published of the start does not hold any more
        found = dataclasses.replace(start.posed.lens_of(numbers.tolist(), start.lens), published=()).astype(
            lens.precision
        )
    else:
        numbers, after, merits = start.numbers, before, (merits[0], merits[0])
    return Optimized(
        lens=found,
        history=course.steps,
        terms=tuple(_terms(start, before, after)),
        changes=tuple(_changes(start, numbers)),
        merit_before=merits[0],
        merit_after=merits[1],
        improved=improved,
        arrived=course.arrived,
        lost=round(float(after.lost)),
        message=_message(improved, course, many) + _lost(round(float(after.lost))),
        interrupted=course.interrupted,
        seconds=course.steps[-1].seconds,
        compile_seconds=compiled_after,
    )


def _evaluated(start: Start) -> Terms:
    return jax.device_get(Merit(start.posed).evaluated(start.numbers).terms)


def _lost(rays: int) -> str:
    return f", where {rays} of the rays {'are' if rays > 1 else 'is'} lost" if rays else ""


def _message(improved: bool, course: Course, many: bool) -> str:
    if many and not improved:
        return "a minimum, no better than the start of the problem"
    if course.stopped:
        return f"stopped: {course.stopped}; {'the best lens so far' if improved else 'nothing better was found'}"
    return "a minimum" if improved else "not improved: the start is a minimum, or nothing that varies can help"


def _terms(start: Start, before: Terms, after: Terms) -> Iterator[Term]:
    lens, place = start.lens, 0
    for want in start.posed.wants:
        target = getattr(want, "target", 0.0)
        for i, name in enumerate(names := want.names(lens)):
            aim = None if target is None else float(np.broadcast_to(np.asarray(target, float), len(names))[i])
            values = [float(a[place]) for a in (before.value, after.value, before.merit, after.merit)]
            yield Term(name, want.unit, want.aim, aim, *values)
            place += 1


def _changes(start: Start, numbers: np.ndarray) -> list[Change]:
    def at(number: float, low: float, high: float) -> str:
        slack = 1e-6 * (high - low if np.isfinite(high - low) else 1.0)
        return "least" if number - low <= slack else "most" if high - number <= slack else ""

    return [
        Change(place.label, place.unit, float(old), float(new), at(new, low, high))
        for place, old, new, low, high in zip(
            start.posed.places, start.numbers, numbers, start.low, start.high, strict=True
        )
    ]
