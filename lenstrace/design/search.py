"""Searches for the numbers of least merit: damped least squares, and L-BFGS where there are many."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from lenstrace.design.merit import Merit
from lenstrace.design.problem import Start

METHODS = ("least_squares", "lbfgs")
# Relative changes of merit and numbers, and slopes, below which a search has arrived.
TOLERANCE = 1e-10
# A merit that has fallen by less than this part of itself is not better.
BETTER = 1e-9
EVALUATIONS = 2000
# A beginning anew that gains less than this part of the merit is the last.
SAME_MERIT = 1e-6


class Step(NamedTuple):
    """One evaluation of a search.

    merit:    there.                   best: the least so far.
    change:   of the numbers against the best before, as a part of them, each in units of how much it moves the
              residuals: what damping allows.
    seconds:  since the search began.
    """

    merit: float
    best: float
    change: float
    seconds: float


@dataclasses.dataclass(frozen=True)
class Course:
    """What a search has done.

    numbers:   the best ones, (P,).          steps: every evaluation.
    arrived:   the search came to a minimum; else it ran out of evaluations or time, or was interrupted.
    stopped:   why it did not arrive, in words; empty where it did.
    interrupted: by Ctrl-C.
    """

    numbers: np.ndarray
    steps: tuple[Step, ...]
    arrived: bool
    stopped: str
    interrupted: bool


def search(
    merit: Merit,
    start: Start,
    method: str,
    seconds: float | None,
    progress: Callable[[int, Step], None] | None,
) -> Course:
    """Search from a start; Ctrl-C and the end of the time give what is best so far."""
    record = _Record(merit, start, seconds, progress)
    stopped, interrupted = "", False
    try:
        stopped = (_least_squares if method == "least_squares" else _lbfgs)(record, start)
    except _TimeIsUp:
        stopped = f"the time of {seconds:g} s was over"
    except KeyboardInterrupt:
        stopped, interrupted = "interrupted", True
    return Course(record.best, tuple(record.steps), not stopped, stopped, interrupted)


def standing(numbers: np.ndarray, merit: float, seconds: float) -> Course:
    """The course of a search that Ctrl-C did not let begin: where it would have."""
    return Course(numbers, (Step(merit, merit, 0.0, seconds),), False, "interrupted", True)


class _TimeIsUp(Exception):
    """The time given for a search is over."""


class _Record:
    """Evaluations of a merit, the best of them, and when they were."""

    def __init__(
        self, merit: Merit, start: Start, seconds: float | None, progress: Callable[[int, Step], None] | None
    ) -> None:
        self._merit, self._seconds, self._progress = merit, seconds, progress
        self._began = time.perf_counter()
        self._last: tuple[Any, Any] = (None, None)
        self._unit = np.ones(len(start.numbers))
        self.best, self.steps = start.numbers, list[Step]()

    def least_squares(self, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals and Jacobian."""

        def asked() -> tuple[float, tuple[np.ndarray, np.ndarray]]:
            found = self._merit.evaluated(numbers)
            residual, jacobian = np.asarray(found.residual), np.asarray(found.jacobian)
            if not self.steps:
                length = np.linalg.norm(jacobian, axis=0)
                self._unit = 1 / np.where(length > 0, length, 1)
            return float(residual @ residual), (residual, jacobian)

        return self._once("residuals", numbers, asked)

    def gradient(self, numbers: np.ndarray) -> tuple[float, np.ndarray]:
        """The merit and its gradient."""

        def asked() -> tuple[float, tuple[float, np.ndarray]]:
            value, slope = self._merit.gradient(numbers)
            return float(value), (float(value), np.asarray(slope))

        return self._once("gradient", numbers, asked)

    def _once(self, what: str, numbers: np.ndarray, asked: Callable[[], tuple[float, Any]]) -> Any:
        """Searches ask for values and derivatives apart; both are found at once."""
        key = what, numbers.tobytes()
        if self._last[0] == key:
            return self._last[1]
        now = time.perf_counter() - self._began
        if self._seconds is not None and now > self._seconds and self.steps:
            raise _TimeIsUp
        value, answer = asked()
        self._last = key, answer
        moved, size = (numbers - self.best) / self._unit, np.linalg.norm(numbers / self._unit)
        least = self.steps[-1].best if self.steps else np.inf
        if value < least:
            self.best = numbers.copy()
        change = float(np.linalg.norm(moved) / size) if size else 0.0
        step = Step(value, min(value, least), change, time.perf_counter() - self._began)
        self.steps.append(step)
        if self._progress is not None:
            self._progress(len(self.steps), step)
        return answer


def _least_squares(record: _Record, start: Start) -> str:
    """scipy's trust region reflective search, every number in units of how much it moves the residuals."""
    from scipy.optimize import least_squares  # 0.2 s to import, and only here

    found = least_squares(
        lambda numbers: record.least_squares(numbers)[0],
        start.numbers,
        jac=lambda numbers: record.least_squares(numbers)[1],  # pyright: ignore[reportArgumentType]
        bounds=(start.low, start.high),
        x_scale="jac",
        ftol=TOLERANCE,
        xtol=TOLERANCE,
        gtol=TOLERANCE,
        max_nfev=EVALUATIONS,
    )
    return "" if found.status > 0 else f"{EVALUATIONS} evaluations were not enough"


def _lbfgs(record: _Record, start: Start) -> str:
    """scipy's L-BFGS-B, on gradients in reverse, every number in units of how much it moves the residuals.

    It forgets its curvatures and begins anew, in new units, until that gains nothing: alone it may end in a valley."""
    from scipy.optimize import minimize

    low_and_high = np.stack([start.low, start.high], 1)
    while True:
        before = record.best
        residual, jacobian = record.least_squares(before)
        length = np.linalg.norm(jacobian, axis=0)
        unit = 1 / np.where(length > 0, length, max(float(length.max()), 1.0))
        # it stops where changes are small against 1
        scale = float(residual @ residual) or 1.0

        def scaled(x: np.ndarray, unit: np.ndarray = unit, scale: float = scale) -> tuple[float, np.ndarray]:
            value, slope = record.gradient(np.clip(x * unit, start.low, start.high))
            return value / scale, slope * unit / scale

        left = EVALUATIONS - len(record.steps)
        minimize(
            scaled,
            before / unit,
            jac=True,
            method="L-BFGS-B",
            bounds=low_and_high / unit[:, None],
            options={"maxiter": left, "maxfun": left, "maxcor": 30, "ftol": TOLERANCE**1.5, "gtol": 0.0},
        )
        if record.steps[-1].best >= (1 - SAME_MERIT) * float(residual @ residual):
            return ""
        if len(record.steps) >= EVALUATIONS:
            return f"{EVALUATIONS} evaluations were not enough"
