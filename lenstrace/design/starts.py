"""Where searches for many minima begin, and which of their ends are the same lens."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from lenstrace.analysis.conditions import with_pupil
from lenstrace.design.batch import Minimum
from lenstrace.design.places import Place
from lenstrace.design.problem import Start
from lenstrace.errors import DesignError

# Half the range of a random curvature, in units of one over the radius of the entrance pupil: the sphere is still
# four times as wide as the light.
CURVED = 0.25
# Half the range of other numbers without bounds, about the start: as a part of a length, and by itself.
PART = 0.5
WIDE = {"conic": 1.0, "index": 0.1, "abbe": 15.0, "tilt": 1.0}
MOST_STARTS = 1_000_000
# Minima whose numbers differ by less than this part of the range of the starts are one.
SAME = 0.02


def starts_of(start: Start, starts: Any, seed: int) -> np.ndarray:
    """Starts (N, P). starts: how many, random ones within `ranges_of`, the first that of the problem; or the numbers
    themselves, (N, P), which must lie within the bounds. DesignError for others."""
    if isinstance(starts, int | np.integer) and not isinstance(starts, bool):
        if not 1 <= starts <= MOST_STARTS:
            raise DesignError(f"starts must be at least 1 and at most {MOST_STARTS}, got {starts}")
        low, high = ranges_of(start)
        chosen = np.random.default_rng(seed).uniform(low, high, (int(starts), len(low)))
        chosen[0] = start.numbers
        return chosen
    given = np.asarray(starts, float)
    if given.ndim != 2 or given.shape[1] != len(start.numbers) or not len(given) or not np.all(np.isfinite(given)):
        raise DesignError(
            f"starts must be a number, or an array of {len(start.numbers)} finite numbers for each start, in the order "
            f"{', '.join(place.label for place in start.posed.places)}; got the shape {given.shape}"
        )
    if np.any(given < start.low) or np.any(given > start.high):
        raise DesignError("starts: some lie outside the bounds of the variables")
    return given


def ranges_of(start: Start) -> tuple[np.ndarray, np.ndarray]:
    """Least and most of random starts, (P,): the bounds where both are finite; about the start elsewhere, within what
    bound there is, curvatures about 0."""
    radius = float(with_pupil(start.lens)[1].entrance.diameter) / 2
    centre = np.array(
        [0.0 if place.kind == "curvature" else n for place, n in zip(start.posed.places, start.numbers, strict=True)]
    )
    half = np.array([_half(place, n, radius) for place, n in zip(start.posed.places, start.numbers, strict=True)])
    bounded = np.isfinite(start.low) & np.isfinite(start.high)
    # about the nearest number within a bound that leaves the middle out
    centre = np.clip(centre, start.low, start.high)
    low = np.where(bounded, start.low, np.maximum(centre - half, start.low))
    high = np.where(bounded, start.high, np.minimum(centre + half, start.high))
    return low, high


def distinct(found: Iterable[Minimum], start: Start) -> list[Minimum]:
    """The best first; of those that are the same lens the best."""
    low, high = ranges_of(start)
    kept: list[Minimum] = []
    ended = [minimum for minimum in found if np.isfinite(minimum.merit)]
    for each in sorted(ended, key=lambda minimum: minimum.merit):
        apart = (np.max(np.abs(each.numbers - other.numbers) / (high - low)) for other in kept)
        if all(distance > SAME for distance in apart):
            kept.append(each)
    return kept


def _half(place: Place, number: float, radius: float) -> float:
    """Half the range of a number without bounds."""
    match place.kind:
        case "curvature":
            return CURVED / radius
        case "thickness":
            return PART * max(abs(number), radius)
        case "decenter":
            return 0.1 * radius
        case "asphere":
            return 0.01 * radius ** (1 - place.part)
        case _:
            return WIDE[place.kind]
