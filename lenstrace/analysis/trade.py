"""The trade of a lens: what each way to answer a question about it costs, and how far it is from the truth."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from lenstrace.accuracy.convergence import check_tolerance
from lenstrace.accuracy.trade import Progress, Setting, Trade
from lenstrace.accuracy.trade import trade as trade_settings
from lenstrace.analysis.settings.pupil import opd_settings, opd_truth, spot_settings, spot_truth
from lenstrace.analysis.settings.rays import chief_settings, chief_truth, focal_settings, focal_truth
from lenstrace.errors import AccuracyError, RayError
from lenstrace.sequential.document import Fields
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rules import check_field


@dataclasses.dataclass(frozen=True)
class Question:
    """A quantity that is traded: its unit, what it is, and where truth and settings come from.

    truth:      of a lens with one field: the value, how far it may be off, and the error by rounding that any
                float64 answer may have; all in the unit.
    settings:   every sensible way to find it; `how` is a function that does.
    """

    unit: str
    text: str
    truth: Callable[[Lens], tuple[float, float, float]]
    settings: Callable[[Lens], list[Setting]]


QUANTITIES = {
    "spot": Question("mm", "RMS spot about the centroid, wavelengths pooled by weight", spot_truth, spot_settings),
    "focal_length": Question("mm", "focal length at the primary wavelength", focal_truth, focal_settings),
    "opd": Question(
        "waves", "RMS optical path difference about the chief ray, primary wavelength", opd_truth, opd_settings
    ),
    "chief_height": Question(
        "mm", "height of the chief ray at the image, primary wavelength", chief_truth, chief_settings
    ),
}


@dataclasses.dataclass(frozen=True)
class LensTrade:
    """What a question about a lens costs under each setting.

    quantity:     its key in QUANTITIES, with `text` and `unit`.
    field:        x and y, in the unit of the lens's fields; None for a quantity without one.
    truth_error:  how far the truth itself may be off.
    trade:        the outcomes.
    """

    quantity: str
    text: str
    unit: str
    field: tuple[float, float] | None
    truth_error: float
    trade: Trade

    def described(self, field_unit: str) -> str:
        """The question in words."""
        if self.field is None:
            return self.text
        x, y = self.field
        return f"{self.text}, field {f'({x:g}, {y:g})' if x else f'{y:g}'} {field_unit}"


def trade(
    lens: Lens,
    quantity: str = "spot",
    *,
    field: float | tuple[float, float] | None = None,
    tolerance: float | None = None,
    progress: Progress | None = None,
) -> LensTrade:
    """Ask a question about a lens under every sensible setting: precision, model, sampling, Newton's steps, symmetry.

    quantity:   "spot", "opd", "chief_height" or "focal_length".
    field:      y, or (x, y), in the unit of the lens's fields; the largest one by default. Not for a focal length.
    tolerance:  relative error allowed; the fastest setting within it is `trade.chosen`.
    progress:   called with the number of settings asked so far, and of all.

    Every answer is one call from Python, with arrays in memory, compiled before; medians of calls in turn. Rays are
    counted for each wavelength; so that few programs are compiled, 64, 256, 1024 or 4096 are traced, some for nothing.
    The truth is the integral over the open pupil, converged to 1e-10, or the judge's ray in 50 digits. Settings that do
    not apply to the lens are left out. AccuracyError for an unknown quantity, a bad tolerance, or a field where none
    counts; else the errors of the question.
    """
    if quantity not in QUANTITIES:
        raise AccuracyError(f"unknown quantity {quantity!r}; one of {', '.join(QUANTITIES)}")
    if quantity == "focal_length" and field is not None:
        raise AccuracyError("a focal length has no field: it is of rays near the axis; leave the field out")
    if tolerance is not None:
        check_tolerance(tolerance)
    question = QUANTITIES[quantity]
    place = _field(lens, field)
    one = lens.replace(fields=Fields((place[0],), (place[1],), lens.fields.kind))
    truth, truth_error, floor = question.truth(one)
    if not np.isfinite(truth):
        raise AccuracyError(f"the {question.text} of this lens is {truth:g}: there is nothing to be accurate about")
    found = trade_settings(_answer, question.settings(one), truth, tolerance=tolerance, floor=floor, progress=progress)
    shown = None if quantity == "focal_length" else place
    return LensTrade(quantity, question.text, question.unit, shown, truth_error, found)


def _answer(how: Callable[[], Any]) -> Any:
    return how()


def _field(lens: Lens, field: float | tuple[float, float] | None) -> tuple[float, float]:
    """The field asked for, else the one farthest from the axis."""
    if field is not None:
        try:
            x, y = map(float, field if isinstance(field, tuple) else (0.0, field))
        except (TypeError, ValueError):
            raise RayError(f"field must be a number y or a pair (x, y), got {field!r}") from None
        check_field(lens, np.asarray(x), np.asarray(y))
        return x, y
    x, y = np.asarray(lens.fields.x, float), np.asarray(lens.fields.y, float)
    farthest = int(np.argmax(np.hypot(x, y)))
    return float(x[farthest]), float(y[farthest])
