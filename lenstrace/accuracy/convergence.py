"""An answer found twice at every step of a ladder, and how far it may be from the truth.

At each step a question is answered by two rules whose leading errors are of equal size and opposite sign, such as
Gauss's and Lobatto's quadrature. The answer is their mean; where the truth lies between the two, its error is at most
half their difference d. Both may happen to err alike. That is unlikely twice in a row: d is not taken to be less than
KEPT of what the two steps before foretell, d_(i-1) times d_(i-1) / d_(i-2), where d falls quickly; where it does not,
as for integrands with kinks, not less than d_(i-1) itself. SHARE of it is the estimate, or SLOW_SHARE; the first step,
with nothing before it, is trusted less. (The constants make the estimates for the spots of some 1,000 lenses hold in
more than 99 %, the median below 20 times the error; `tests/benchmarks/honesty.py` counts on others. For a kink in an
integrand of one variable the error may be twice the estimate.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from lenstrace.errors import AccuracyError

SHARE, SLOW_SHARE = 0.42, 0.55
KEPT = 0.4
SLOWLY = 0.1
# What is foretold of the second step, of the first one's difference.
FIRST_RATIO = 0.075

Found = TypeVar("Found")


class Answer(NamedTuple, Generic[Found]):
    """What a step of the ladder gave.

    found:       whatever belongs to it, given back at the end.
    value:       numbers that must be accurate, an array.
    difference:  of the two rules, of each of them, >= 0.
    """

    found: Found
    value: np.ndarray
    difference: np.ndarray


class Converged(NamedTuple, Generic[Found]):
    """The answer at the end of the ladder or before.

    step:     the one that gave it.         found, value: see `Answer`.
    error:    estimates of |value - truth|.
    reached:  whether all errors are within the tolerance.
    rounded:  where they are not, whether rounding alone keeps them from it: further steps would not help.
    """

    step: Any
    found: Found
    value: np.ndarray
    error: np.ndarray
    reached: bool
    rounded: bool


def converge(
    question: Callable[[Any], Answer[Found]], ladder: Sequence[Any], tolerance: float, floor: float = 0.0
) -> Converged[Found]:
    """The first step of a ladder at which every number is accurate, but for rounding; the last one if none is.

    tolerance:  relative error allowed.        floor: error by rounding, which no step makes less; part of the estimate.
    AccuracyError for a tolerance that is not positive.
    """
    check_tolerance(tolerance)
    differences: list[np.ndarray] = []
    step, answer, error, rounded = None, None, np.zeros(0), False
    for step in ladder:
        answer = question(step)
        error = estimate(differences, answer.difference)
        differences.append(answer.difference)
        rounded = bool(np.all(error <= np.maximum(tolerance * np.abs(answer.value) - floor, floor)))
        if rounded:
            break
    if answer is None:
        raise AccuracyError("a ladder needs at least one step")
    reached = bool(np.all(error + floor <= tolerance * np.abs(answer.value)))
    return Converged(step, answer.found, answer.value, error + floor, reached, rounded and not reached)


def estimate(before: Sequence[np.ndarray], difference: np.ndarray) -> np.ndarray:
    """The error of the mean of two rules, from their difference, and from those at the steps before."""
    if not before:
        return difference
    foretold, share = FIRST_RATIO * KEPT * before[-1], np.full_like(difference, SHARE)
    if len(before) > 1:
        ratio = np.divide(before[-1], before[-2], out=np.ones_like(before[-1]), where=before[-2] > before[-1])
        foretold = np.where(ratio > SLOWLY, 1.0, KEPT * ratio) * before[-1]
        share = np.where(ratio > SLOWLY, SLOW_SHARE, SHARE)
    return share * np.maximum(difference, foretold)


def check_tolerance(tolerance: Any) -> None:
    """AccuracyError for what is not a positive number."""
    if isinstance(tolerance, bool) or not isinstance(tolerance, int | float | np.number) or not 0 < tolerance < np.inf:
        raise AccuracyError(f"tolerance must be a positive number (a relative error), got {tolerance!r}")
