"""A start that loses rays, opened step by step: first for fields and a pupil so small that none is lost, then for more.

Where a ray is lost, residuals know only that, and how far its straight course goes astray. A lens whose small fields
and pupil are good loses fewer rays at larger ones.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable

import numpy as np

from lenstrace.design.merit import Merit
from lenstrace.design.problem import Posed, Start
from lenstrace.design.pupil_wants import OverPupil
from lenstrace.design.search import Step, search

# Parts of fields and pupil, and how many searches there are at most on the way to all of them.
PARTS = tuple(0.8**k for k in range(1, 20))
MOST_SEARCHES = 8


def opened(start: Start, deadline: float, progress: Callable[[int, Step], None] | None) -> tuple[np.ndarray, bool]:
    """Numbers from which a search may begin whose start loses rays, those of the start where nothing helps; and whether
    Ctrl-C came on the way. deadline: of `time.perf_counter`; progress: see `search`."""
    numbers, before = start.numbers, 0.0
    for _ in range(MOST_SEARCHES):
        if time.perf_counter() >= deadline:
            break
        part = next((part for part in (1.0, *PARTS) if not _lost(_part_of(start.posed, part), numbers)), None)
        if part is None or part <= before:
            break
        if part == 1.0:
            break
        there = dataclasses.replace(start, posed=_part_of(start.posed, part), numbers=numbers)
        left = deadline - time.perf_counter()
        course = search(Merit(there.posed), there, "least_squares", left if left < math.inf else None, progress)
        numbers, before = course.numbers, part
        if course.interrupted:
            return numbers, True
    return numbers, False


def _part_of(posed: Posed, part: float) -> Posed:
    """The problem for a part of the fields and of the pupil; its structure is the same."""
    fields = posed.lens.fields
    x, y = (tuple(part * each for each in component) for component in (fields.x, fields.y))
    lens = dataclasses.replace(posed.lens, fields=dataclasses.replace(fields, x=x, y=y))

    def smaller(want: OverPupil) -> OverPupil:
        assert want.points is not None
        return dataclasses.replace(want, points=want.points._replace(x=part * want.points.x, y=part * want.points.y))

    wants = tuple(smaller(want) if isinstance(want, OverPupil) else want for want in posed.wants)
    return dataclasses.replace(posed, lens=lens, wants=wants)


def _lost(posed: Posed, numbers: np.ndarray) -> bool:
    return float(Merit(posed).evaluated(numbers).terms.lost) > 0
