"""What errors of construction are, and what they do: the results of `sensitivity`."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from lenstrace.design.outcome import aligned
from lenstrace.errors import DesignError


@dataclasses.dataclass(frozen=True)
class Tolerances:
    """Errors that a shop keeps to, the same for every surface; 0 leaves a kind out. Defaults: a commercial grade.

    radius:    of the radius of curvature, as a part of it.        flatness: of surfaces so long in radius
               that it counts more, as a sag at the edge of the light, mm.
    thickness: mm.      decenter: of a surface, along y, mm.       tilt: of a surface, about x, degrees.
    index:     of all indices of a glass.                          abbe: of its Abbe number, as a part of it.
    """

    radius: float = 1e-3
    flatness: float = 5e-5
    thickness: float = 0.05
    decenter: float = 0.02
    tilt: float = 1 / 60
    index: float = 5e-4
    abbe: float = 5e-3

    def __post_init__(self) -> None:
        """DesignError for what is no error."""
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if (
                isinstance(value, bool)
                or not isinstance(value, int | float)
                or not (math.isfinite(value) and value >= 0)
            ):
                raise DesignError(f"tolerance {field.name} must be a number, 0 or more, got {value!r}")


@dataclasses.dataclass(frozen=True)
class Sensitivity:
    """What an error of one number does.

    name, unit, tolerance:  of the number.
    focal_length, back_focal_length:  changes, mm, for an error of + the tolerance.
    spots:  (F,), by how much the RMS spot of each field, all wavelengths together, becomes larger, mm, for the worse
            sign of the error.
    """

    name: str
    unit: str
    tolerance: float
    focal_length: float
    back_focal_length: float
    spots: np.ndarray

    @property
    def worst(self) -> float:
        """Of the spots, mm."""
        return float(np.max(self.spots))


@dataclasses.dataclass(frozen=True)
class Sensitivities:
    """Of all numbers of a lens, what hurts most first.

    rows:           one for each number.
    focal_length, back_focal_length, spots: of the lens as designed; mm, spots (F,).
    expected_focal_length, expected_back_focal_length: root of the sum of the squares of all changes, mm.
    expected_spots: (F,), mm, RMS spots on average over lenses whose errors are independent, each of the size of its
                    tolerance.
    refocused:      the image distance is adjusted for each lens.
    fields:         in words.
    """

    rows: tuple[Sensitivity, ...]
    focal_length: float
    back_focal_length: float
    spots: np.ndarray
    expected_focal_length: float
    expected_back_focal_length: float
    expected_spots: np.ndarray
    refocused: bool
    fields: tuple[str, ...] = ()

    def table(self) -> str:
        """A line for each number, what hurts most first, and the lens as designed and as expected, as text."""
        spots = [f"spot at {field}, mm" for field in self.fields]
        head = ("", "tolerance", "focal length, mm", "back focal length, mm", *spots)
        rows = [
            (
                row.name,
                f"{row.tolerance:.4g} {row.unit}".strip(),
                *(f"{change:+.4g}" for change in (row.focal_length, row.back_focal_length)),
                *(f"+{change:.3e}" for change in row.spots),
            )
            for row in self.rows
        ]
        lengths = f"{self.focal_length:.6f}", f"{self.back_focal_length:.6f}"
        changes = f"+- {self.expected_focal_length:.6f}", f"+- {self.expected_back_focal_length:.6f}"
        rows.append(("as designed", "", *lengths, *(f"{spot:.4e}" for spot in self.spots)))
        rows.append(("all together, expected", "", *changes, *(f"{spot:.4e}" for spot in self.expected_spots)))
        return aligned([head, *rows], left=(0,))
