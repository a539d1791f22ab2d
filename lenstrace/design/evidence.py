"""What a search came to, with the evidence: every want and every number, before and after."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import jax
import numpy as np

from lenstrace.design.merit import Terms
from lenstrace.design.outcome import Change, Optimized, Term
from lenstrace.design.problem import Start
from lenstrace.design.ready import Ready
from lenstrace.design.search import BETTER, Course
from lenstrace.sequential.lens import Lens

# Numbers of a glass: one that varies is made a model glass before the search begins.
MADE = ("index", "abbe")


def outcome_of(lens: Lens, ready: Ready, course: Course, compiled_after: float, many: bool = False) -> Optimized:
    """The outcome of a search; many: it began elsewhere than at the lens, and may have ended at a worse one."""
    start, before = ready.start, ready.before
    after = jax.device_get(ready.merit.evaluated(course.numbers).terms)
    merits = float(before.merit.sum()), float(after.merit.sum())
    improved = merits[1] < merits[0] * (1 - BETTER)
    numbers, found = course.numbers, lens
    if not (improved or many):
        numbers, after, merits = start.numbers, before, (merits[0], merits[0])
    if improved or many or start.posed.ties or any(place.kind in MADE for place in start.posed.places):
        # what was published of the lens that was given does not hold any more
        found = dataclasses.replace(start.posed.lens_of(numbers.tolist(), start.lens), published=()).astype(
            lens.precision
        )
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
