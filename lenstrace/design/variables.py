"""What a design may change: kinds of numbers, on some surfaces, within bounds."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import Any, ClassVar

import numpy as np

from lenstrace.design.places import AXES, Place
from lenstrace.errors import DesignError, PrescriptionError
from lenstrace.optics.media import AIR
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rules import number_of

# Where glasses lie on the map of nd and vd.
GLASSES = {"index": (1.3, 2.2), "abbe": (10.0, 110.0)}

Surfaces = int | str | Sequence[int]
Bounds = tuple[float | None, float | None]


@dataclasses.dataclass(frozen=True)
class Variable:
    """Numbers that may change.

    surfaces: a number, a list of them, or a word of `words`.      bounds: (least, most), None for none.
    kind:     see `Place`.
    """

    surfaces: Surfaces
    bounds: Bounds | None = dataclasses.field(default=None, kw_only=True)
    kind: ClassVar[str] = ""
    words: ClassVar[tuple[str, ...]] = ("all", "last")

    @property
    def parts(self) -> tuple[int, ...]:
        """See `Place.part`; DesignError for what is none."""
        return (0,)


@dataclasses.dataclass(frozen=True)
class Curvature(Variable):
    """Curvatures, 1/mm, planes among them; "all": of every surface that bends light."""

    surfaces: Surfaces = "all"
    kind = "curvature"


@dataclasses.dataclass(frozen=True)
class Thickness(Variable):
    """Thicknesses, mm, each from its surface to the next; "all", or those of "glass" or "air", the last among them;
    "last" alone reaches to the image. Without bounds a gap keeps its sign, but for the last."""

    kind = "thickness"
    words = ("all", "last", "glass", "air")


@dataclasses.dataclass(frozen=True)
class Conic(Variable):
    """Conic constants."""

    kind = "conic"


@dataclasses.dataclass(frozen=True)
class Asphere(Variable):
    """Coefficients of r^p, mm^(1 - p), for some powers p; a surface without them gets them, 0 at first."""

    powers: Sequence[int] = (4, 6)
    kind = "asphere"

    @property
    def parts(self) -> tuple[int, ...]:
        """The powers."""
        powers = [self.powers] if isinstance(self.powers, int) else list(self.powers)
        if not powers or any(isinstance(p, bool) or not isinstance(p, int) or p < 1 for p in powers):
            raise DesignError(f"asphere: powers must be whole numbers such as [4, 6], got {self.powers!r}")
        return tuple(powers)


@dataclasses.dataclass(frozen=True)
class Index(Variable):
    """The index at the d line of the media behind some surfaces. A catalogue's glass becomes a model glass (nd, vd),
    see `AbbeModel`, with nd from 1.3 to 2.2 where no bounds are given; a medium of one index keeps one."""

    kind = "index"
    words = ("all", "glass")


@dataclasses.dataclass(frozen=True)
class Abbe(Variable):
    """The Abbe number vd of model glasses behind some surfaces, as `Index`; from 10 to 110 without bounds."""

    kind = "abbe"
    words = ("all", "glass")


@dataclasses.dataclass(frozen=True)
class Decenter(Variable):
    """Decentres across the axis, mm; axes "x", "y" or "xy"."""

    axes: str = "y"
    kind = "decenter"

    @property
    def parts(self) -> tuple[int, ...]:
        """Places of the axes."""
        return _axes(self.kind, self.axes, "xy")


@dataclasses.dataclass(frozen=True)
class Tilt(Variable):
    """Tilts, degrees; axes some of "xyz"."""

    axes: str = "x"
    kind = "tilt"

    @property
    def parts(self) -> tuple[int, ...]:
        """Places of the axes."""
        return _axes(self.kind, self.axes, "xyz")


def places_of(lens: Lens, variable: Variable) -> Iterator[Place]:
    """Every number that a variable names. DesignError for surfaces that are none."""
    parts = variable.parts
    for surface in surfaces_of(lens, variable.kind, variable.surfaces, variable.words):
        for part in parts:
            yield Place(variable.kind, surface, part)


def surfaces_of(lens: Lens, what: str, surfaces: Surfaces, words: tuple[str, ...]) -> list[int]:
    """The numbers of surfaces that were given as a number, a list, or one of some words; DesignError for others."""
    if isinstance(surfaces, str):
        if surfaces not in words:
            raise DesignError(f"{what}: surfaces must be numbers, or one of {', '.join(words)}; got {surfaces!r}")
        numbers = np.arange(1, len(lens) + 1)
        glass = np.array([row.medium is not AIR and not row.mirror for row in lens])
        match surfaces:
            case "last":
                return [len(lens)]
            case "all" if what in ("curvature", "conic", "asphere", "decenter", "tilt"):
                found = numbers[lens.system.bends]
            case "all" if what == "thickness":
                found = numbers
            case "air":
                found = numbers[~glass]
            case _:
                found = numbers[glass]
        return found.tolist()
    given = list(surfaces) if isinstance(surfaces, Sequence | np.ndarray) else [surfaces]
    if any(isinstance(each, bool) or not isinstance(each, int | np.integer) for each in given):
        raise DesignError(f"{what}: surfaces must be whole numbers, got {surfaces!r}")
    try:
        return [number_of(int(each), len(lens)) for each in given]
    except PrescriptionError as error:
        raise DesignError(f"{what}: {error}") from None


def limits_by_default(place: Place, number: float, last: bool) -> tuple[float, float]:
    """Of a number without bounds: a gap keeps its sign, but for the last one, and a model glass stays among glasses."""
    if place.kind == "thickness" and not last and number != 0:
        return (0.0, math.inf) if number > 0 else (-math.inf, 0.0)
    low, high = GLASSES.get(place.kind, (-math.inf, math.inf))
    return (low, high) if low <= number <= high else (-math.inf, math.inf)


def limits_of(variable: Variable) -> tuple[float, float] | None:
    """Least and most, infinite where one of them is None; None without bounds. DesignError for limits that leave
    nothing."""
    if variable.bounds is None:
        return None
    try:
        low, high = variable.bounds
        low, high = -math.inf if low is None else float(low), math.inf if high is None else float(high)
    except (TypeError, ValueError):
        raise DesignError(f"{variable.kind}: bounds must be (least, most), got {variable.bounds!r}") from None
    if not low < high:
        raise DesignError(f"{variable.kind}: bounds must rise, got ({low:g}, {high:g}); leave the number out to fix it")
    return low, high


def _axes(kind: str, axes: Any, known: str) -> tuple[int, ...]:
    if not isinstance(axes, str) or not axes or not set(axes) <= set(known):
        raise DesignError(f"{kind}: axes must be some of {known!r}, got {axes!r}")
    return tuple(AXES.index(axis) for axis in axes)
