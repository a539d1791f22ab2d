"""Light that a plate reflects totally is no light through it: the same refusal for all plates."""

from __future__ import annotations

import math

from lenstrace.errors import OptionError

GRAZING = 1e-4  # of the sine inside, from 1: nearer to that the ray runs along the face, and rounding decides its way


def refuse_total_reflection(where: str, angle: float, index: float, surroundings: float, keep: str) -> None:
    """OptionError for light at an angle from the normal, radians; keep: what must be less, in words."""
    steepest = (1 - GRAZING) * abs(index) / surroundings
    if math.sin(angle) >= steepest:
        raise OptionError(
            f"{where}: light at {math.degrees(angle):.4g} deg from the index {surroundings:g} is reflected totally at "
            f"the index {index:g}; keep {keep} below {math.degrees(math.asin(steepest)):.4g} deg"
        )
