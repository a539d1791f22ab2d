"""What the tolerance of rays through a graded index costs, and what error it leaves at their ends."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lenstrace.optics.graded import Course
from lenstrace.phenomena.options import Option

TOLERANCES = np.geomspace(1e-2, 1e-13, 12)
# How much larger than the tolerance of one step the error of a whole course may be, for the errors of steps add up:
# measured, up to 13. What a ray itself makes of an error on its way comes on top of that.
GROWTH = 30.0

STEP_ERROR = Option("relative error of a step", least=1e-13, most=1e-6)


class Cost(NamedTuple):
    """Of several tolerances: the largest error at the end, in units of a length of the picture, and how often the
    equation of the rays was evaluated."""

    tolerances: np.ndarray
    errors: np.ndarray
    calls: np.ndarray


def cost(follow: Callable[[float], Course], error: Callable[[Course], float]) -> Cost:
    """follow: rays at a tolerance.      error: of their ends."""
    courses = [follow(tolerance) for tolerance in TOLERANCES]
    return Cost(TOLERANCES, np.array([error(course) for course in courses]), np.array([c.calls for c in courses]))
