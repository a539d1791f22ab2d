"""What accuracy costs: one question asked under many settings, with the error and the time of each."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from lenstrace.accuracy.convergence import check_tolerance
from lenstrace.errors import AccuracyError

# Warm calls of each setting, in turn with those of the others, so that what disturbs the machine disturbs all alike.
ROUNDS = 9
# Seconds of warm calls after which a setting is not asked again.
ENOUGH = 1.0

Progress = Callable[[int, int], None]


@dataclasses.dataclass(frozen=True)
class Setting:
    """One way to answer a question.

    name:    for a person.                    family: of settings that differ in the number of rays alone.
    rays:    that one answer is made of; samples of any kind.
    how:     what the question is given.
    """

    name: str
    family: str
    rays: int
    how: Any


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What a setting gave.

    value:           of the unit of the question; nan where there is none.
    error:           |value - truth|.         relative_error: over |truth|; inf where the truth is 0 and the value not.
    seconds:         median of repeated calls, compiled before.
    first_seconds:   of the first call beyond that: compilation.
    pareto:          no other setting is as fast and more accurate, or as accurate and faster; errors below the floor
                     count as equal.
    """

    setting: Setting
    value: float
    error: float
    relative_error: float
    seconds: float
    first_seconds: float
    pareto: bool


@dataclasses.dataclass(frozen=True)
class Trade:
    """The outcomes of all settings asked, in their order.

    truth:      the value that errors count from.
    tolerance:  the relative error allowed, or None.
    floor:      the absolute error that counts as none.
    chosen:     the fastest setting within the tolerance; None where there is none, or no tolerance.
    complete:   False where an interrupt (Ctrl-C) ended it before all settings were asked and timed.
    """

    truth: float
    tolerance: float | None
    floor: float
    outcomes: tuple[Outcome, ...]
    chosen: Outcome | None
    complete: bool

    @property
    def front(self) -> tuple[Outcome, ...]:
        """The Pareto front, the fastest first."""
        return tuple(sorted((each for each in self.outcomes if each.pareto), key=lambda each: each.seconds))


def trade(
    question: Callable[[Any], Any],
    settings: Iterable[Setting],
    truth: float,
    *,
    tolerance: float | None = None,
    floor: float = 0.0,
    rounds: int = ROUNDS,
    progress: Progress | None = None,
) -> Trade:
    """Ask a question under every setting, and time it.

    question:   from `how` of a setting to a number; it returns when that is known.
    truth:      the number itself, from a source that can be trusted.
    tolerance:  relative error allowed.        floor: absolute error that is allowed in any case: rounding.
    progress:   called with the number of settings asked so far, and of all.
    Ctrl-C ends it early, with what has been found. AccuracyError for a truth or a floor that is not finite, a tolerance
    that is not positive, for names that are not unique, or without any setting.
    """
    settings = list(settings)
    _check(settings, truth, tolerance, floor, rounds)
    asked: list[tuple[Setting, float, float, list[float]]] = []
    complete = False
    try:
        for setting in settings:
            value, first = _timed(question, setting)
            warm = [_timed(question, setting)[1]]
            asked.append((setting, value, max(first - warm[0], 0.0), warm))
            if progress is not None:
                progress(len(asked), len(settings))
        for _ in range(rounds - 1):
            for setting, _, _, warm in asked:
                if sum(warm) < ENOUGH:
                    warm.append(_timed(question, setting)[1])
        complete = True
    except KeyboardInterrupt:
        if not asked:
            raise
    seconds = [float(np.median(warm)) for *_, warm in asked]
    errors = [abs(value - truth) for _, value, _, _ in asked]
    best = _front(seconds, [max(error, floor) for error in errors])
    outcomes = tuple(
        Outcome(setting, value, error, _relative(error, truth), second, first, i in best)
        for i, ((setting, value, first, _), second, error) in enumerate(zip(asked, seconds, errors, strict=True))
    )
    chosen = None
    if tolerance is not None:
        met = [each for each in outcomes if each.error <= max(tolerance * abs(truth), floor)]
        chosen = min(met, key=lambda each: each.seconds, default=None)
    return Trade(truth, tolerance, floor, outcomes, chosen, complete)


def _timed(question: Callable[[Any], Any], setting: Setting) -> tuple[float, float]:
    """The answer, and the seconds until it was known."""
    start = time.perf_counter()
    value = float(question(setting.how))
    return value, time.perf_counter() - start


def _front(seconds: Sequence[float], errors: Sequence[float]) -> set[int]:
    """Places of what nothing else beats in both: by time, each more accurate than all before.

    >>> sorted(_front([1.0, 2.0, 2.0, 3.0, 4.0], [5.0, 6.0, 3.0, 3.0, float("nan")]))
    [0, 2]
    """
    front, least = set(), math.inf
    for i in sorted(range(len(seconds)), key=lambda i: (seconds[i], errors[i])):
        if errors[i] < least:
            front.add(i)
            least = errors[i]
    return front


def _relative(error: float, truth: float) -> float:
    if truth:
        return error / abs(truth)
    return 0.0 if error == 0 else math.inf if error > 0 else math.nan


def _check(settings: Sequence[Setting], truth: float, tolerance: float | None, floor: float, rounds: int) -> None:
    if not math.isfinite(truth):
        raise AccuracyError(f"the truth must be a finite number, got {truth!r}")
    if not 0 <= floor < math.inf:
        raise AccuracyError(f"the floor must be 0 or a positive number, got {floor!r}")
    if tolerance is not None:
        check_tolerance(tolerance)
    if isinstance(rounds, bool) or not isinstance(rounds, int) or rounds < 1:
        raise AccuracyError(f"rounds must be a whole number, at least 1, got {rounds!r}")
    names = [setting.name for setting in settings]
    if not names:
        raise AccuracyError("a trade needs at least one setting")
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise AccuracyError(f"two settings have the name {min(twice)!r}; names tell them apart")
