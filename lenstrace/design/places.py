"""Where a number that a design may change stands in a lens: how it is named, read and written."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from lenstrace.errors import DesignError, LensTraceError
from lenstrace.optics.media import LINE_C, LINE_D, LINE_F, AbbeModel, Air, Constant
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rows import Row

AXES = ("x", "y", "z")


class Place(NamedTuple):
    """One number of a row.

    kind:     curvature, thickness, conic, asphere, index (nd of a model glass, or the one index of a medium), abbe
              (vd), decenter, tilt.
    surface:  1 ... S.
    part:     the power of an asphere term; the axis (0, 1, 2) of a decentre or tilt; 0 elsewhere.
    """

    kind: str
    surface: int
    part: int = 0

    @property
    def unit(self) -> str:
        """Of the number; empty for a pure one."""
        fixed = {"curvature": "1/mm", "thickness": "mm", "decenter": "mm", "tilt": "deg"}
        return f"mm^{1 - self.part}" if self.kind == "asphere" else fixed.get(self.kind, "")

    @property
    def label(self) -> str:
        """In words: "curvature 3", "asphere 4 of 2", "tilt x of 5"."""
        match self.kind:
            case "asphere":
                return f"asphere {self.part} of {self.surface}"
            case "decenter" | "tilt":
                return f"{self.kind} {AXES[self.part]} of {self.surface}"
            case _:
                return f"{self.kind} {self.surface}"


def prepared(lens: Lens, places: Iterable[Place]) -> Lens:
    """The same lens with room for every place: an asphere term 0, a decentre or tilt of 0, a model glass in place of a
    catalogue's. DesignError where there can be none; it names the surface."""
    rows = list(lens.rows)
    for place in places:
        row = rows[place.surface - 1]
        try:
            rows[place.surface - 1] = _with_room(row, place)
        except LensTraceError as error:
            raise DesignError(f"{place.label}: {error}") from None
    return dataclasses.replace(lens, rows=tuple(rows))


def read(lens: Lens, place: Place) -> Any:
    """The number; of a lens that is prepared for it."""
    row = lens.rows[place.surface - 1]
    match place.kind:
        case "asphere":
            return row.asphere[place.part]
        case "decenter" | "tilt":
            return getattr(row, place.kind)[place.part]
        case "index":
            return row.medium.n if isinstance(row.medium, Constant) else row.medium.nd  # pyright: ignore
        case "abbe":
            return row.medium.vd  # pyright: ignore[reportAttributeAccessIssue]
        case _:
            return getattr(row, place.kind)


def written(lens: Lens, changes: Iterable[tuple[Place, Any]]) -> Lens:
    """The lens with other numbers at some places; nothing is checked, JAX may trace them."""
    rows = list(lens.rows)
    for place, value in changes:
        rows[place.surface - 1] = _with_number(rows[place.surface - 1], place, value)
    return dataclasses.replace(lens, rows=tuple(rows))


def _with_number(row: Row, place: Place, value: Any) -> Row:
    match place.kind:
        case "asphere":
            at = row.powers.index(place.part)
            return dataclasses.replace(row, coefficients=(*row.coefficients[:at], value, *row.coefficients[at + 1 :]))
        case "decenter" | "tilt":
            old = getattr(row, place.kind)
            return dataclasses.replace(row, **{place.kind: (*old[: place.part], value, *old[place.part + 1 :])})
        case "index" if isinstance(row.medium, Constant):
            return dataclasses.replace(row, medium=Constant(value))
        case "index":
            return dataclasses.replace(row, medium=dataclasses.replace(row.medium, nd=value))  # pyright: ignore
        case "abbe":
            return dataclasses.replace(row, medium=dataclasses.replace(row.medium, vd=value))  # pyright: ignore
        case _:
            return dataclasses.replace(row, **{place.kind: value})


def _with_room(row: Row, place: Place) -> Row:
    match place.kind:
        case "asphere":
            return row if place.part in row.powers else row.replace(asphere={**row.asphere, place.part: 0.0})
        case "decenter":
            return row if row.decenter is not None else row.replace(decenter=(0.0, 0.0))
        case "tilt":
            return row if row.tilt is not None else row.replace(tilt=(0.0, 0.0, 0.0))
        case "index" | "abbe":
            return dataclasses.replace(row, medium=_model(row, place.kind), glass=None)
        case _:
            return row


def _model(row: Row, kind: str) -> AbbeModel | Constant:
    """The medium of a row by numbers that may change."""
    medium = row.medium
    if row.mirror or isinstance(medium, Air):
        raise DesignError("air or a mirror is behind this surface; name a surface with glass behind it")
    if isinstance(medium, AbbeModel) or (isinstance(medium, Constant) and kind == "index"):
        return medium
    if isinstance(medium, Constant):
        raise DesignError("one index has no dispersion to vary; give the row abbe = { nd = ..., vd = ... }")
    d, f, c = (float(each) for each in medium.index(np.array([LINE_D, LINE_F, LINE_C])))
    return AbbeModel(d, (d - 1) / (f - c))
