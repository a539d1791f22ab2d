"""Times of several calls taken in turn, a b c a b c ..., so that what disturbs the machine disturbs all of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np


def interleaved(calls: dict[str, Callable[[], Any]], rounds: int) -> dict[str, np.ndarray]:
    """Seconds of every call in every round, (rounds,) for each name.

    A call returns when its work is done (JAX: `jax.block_until_ready`). Each is made once beforehand, untimed: what
    it compiles and first touches does not count.
    """
    for call in calls.values():
        call()
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            seconds[name].append(time.perf_counter() - start)
    return {name: np.array(values) for name, values in seconds.items()}


def repeated(call: Callable[[], Any], times: int) -> Callable[[], None]:
    """A call too short to be timed alone, made several times."""

    def several() -> None:
        for _ in range(times):
            call()

    return several


def ratio(above: np.ndarray, below: np.ndarray) -> tuple[float, tuple[float, float]]:
    """The ratio of two medians, and the quartiles of the ratios within a round.

    >>> ratio(np.array([2.0, 4.0, 9.0]), np.array([1.0, 2.0, 3.0]))
    (2.0, (2.0, 2.5))
    """
    low, high = np.percentile(above / below, [25, 75])
    return float(np.median(above) / np.median(below)), (float(low), float(high))
