"""A problem made ready: posed, its merit compiled, and known at the start."""

from __future__ import annotations

import dataclasses
import importlib
from typing import NamedTuple

import jax
import numpy as np

from lenstrace.design.merit import Merit, Terms
from lenstrace.design.problem import Problem, Start, check, start_of


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


def _evaluated(start: Start) -> Terms:
    return jax.device_get(Merit(start.posed).evaluated(start.numbers).terms)
