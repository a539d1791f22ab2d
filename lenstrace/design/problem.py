"""The problem of a design: a lens, what may change, what is tied, and what is wanted."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.symmetry import is_mirrored
from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.design.places import Place, prepared, read, written
from lenstrace.design.ties import CurvatureSolve, Pickup, ThicknessSolve, Tie, check_ties, tied
from lenstrace.design.variables import Variable, limits_by_default, limits_of, places_of
from lenstrace.design.wants import Want, sized
from lenstrace.errors import DesignError
from lenstrace.optics.made_media import Sampled
from lenstrace.optics.media import AIR
from lenstrace.sequential.lens import Lens

# Relative change of a tied number, when it is found again, that is rounding.
TIED = 1e-7
# A tied number beyond this is none: an image at infinity, but for rounding.
FARTHEST = 1e12


@dataclasses.dataclass(frozen=True)
class Problem:
    """What an optimization is to do.

    lens:  the start.
    vary:  variables: Curvature, Thickness, Conic, Asphere, Index, Abbe, Decenter, Tilt.
    want:  SpotRMS, WavefrontRMS, FocalLength, EdgeThickness, Custom, ...; the merit is the sum of the squares of their
           weighted residuals.
    tie:   numbers that follow from others: Pickup, CurvatureSolve, ThicknessSolve; in the order they are to be taken.

    DesignError for a problem that cannot be posed.
    """

    lens: Lens
    vary: Sequence[Variable]
    want: Sequence[Want]
    tie: Sequence[Tie] = ()

    def __post_init__(self) -> None:
        """Refuse what can be refused without tracing a ray."""
        if not isinstance(self.lens, Lens):
            raise DesignError(f"lens must be a lenstrace.Lens, got {type(self.lens).__name__}")
        if is_traced(self.lens):
            raise DesignError("JAX is tracing the numbers of the lens, and a search looks at them; call it outside")
        for name, each in (("vary", self.vary), ("want", self.want), ("tie", self.tie)):
            if not isinstance(each, Sequence) or isinstance(each, str):
                raise DesignError(f"{name} must be a list, got {each!r}")
        if not self.vary:
            raise DesignError("vary: nothing may change; name a variable, such as Curvature('all')")
        if not self.want:
            raise DesignError("want: nothing is wanted; name a want, such as SpotRMS()")
        for each in self.vary:
            if not isinstance(each, Variable):
                raise DesignError(f"vary: {each!r} is no variable; they are Curvature, Thickness, Conic, Asphere, ...")
        for each in self.want:
            if not isinstance(each, Want):
                raise DesignError(f"want: {each!r} is no want; they are SpotRMS, FocalLength, TotalTrack, ...")
        for each in self.tie:
            if not isinstance(each, Pickup | CurvatureSolve | ThicknessSolve):
                raise DesignError(f"tie: {each!r} is no tie; they are Pickup, CurvatureSolve, ThicknessSolve")
        _places(self)


@pytree
class Posed:
    """A problem as the search sees it: every leaf is a number.

    lens:    with room for every number that may change; glasses are their indices, so that another glass is another
             number, and no program is compiled anew for it.
    wants, ties: of the problem, `posed`.
    places:  of the P numbers that may change.
    """

    lens: Lens
    wants: tuple[Want, ...]
    ties: tuple[Tie, ...]
    places: tuple[Place, ...] = static()

    def lens_of(self, numbers: Any, lens: Lens | None = None) -> Lens:
        """The lens, or another one like it, with such numbers, P of them, at its places; JAX may trace them."""
        return tied(written(lens or self.lens, zip(self.places, numbers, strict=True)), self.ties)


@dataclasses.dataclass(frozen=True)
class Start:
    """Where a search begins: the lens with room for its numbers, the problem, the P numbers, and their bounds."""

    lens: Lens
    posed: Posed
    numbers: np.ndarray
    low: np.ndarray
    high: np.ndarray


def start_of(problem: Problem) -> Start:
    """The start of a problem; no ray is traced. DesignError where there is none."""
    bounds = _places(problem)
    lens = prepared(problem.lens, bounds).astype("float64")
    ties = tuple(problem.tie)
    lens = tied(lens, ties)
    _check_ties_hold(lens, ties)
    numbers = np.array([float(read(lens, place)) for place in bounds])
    limits = [
        given or limits_by_default(place, number, place.surface == len(lens))
        for (place, given), number in zip(bounds.items(), numbers, strict=True)
    ]
    low, high = np.array(limits).T
    for place, number, least, most in zip(bounds, numbers, low, high, strict=True):
        if not least <= number <= most:
            unit = f" {place.unit}" if place.unit else ""
            raise DesignError(
                f"{place.label}: the start, {number:g}{unit}, lies outside its bounds ({least:g}, {most:g}); "
                "widen them, or begin within"
            )
    sides = [place for place in bounds if (place.kind, place.part) in (("decenter", 0), ("tilt", 1), ("tilt", 2))]
    mirrored = is_mirrored(lens) and not sides
    wants = tuple(sized(want.posed(lens, mirrored), lens) for want in problem.want)
    um = tuple(dict.fromkeys((*lens.wavelengths.um, *(um for want in wants for um in want.um))))
    return Start(lens, Posed(_sampled(lens, um), wants, ties, tuple(bounds)), numbers, low, high)


def check(start: Start) -> None:
    """What has to be traced to be known: a pupil, and the figures that are wanted. LensTraceError."""
    with_pupil(start.lens)
    for want in start.posed.wants:
        want.check(start.lens)


def _sampled(lens: Lens, um: tuple[float, ...]) -> Lens:
    """With the indices of its catalogue glasses at some wavelengths in their place, and without what is only said."""

    def known(medium: Any) -> Any:
        fixed = not jax.tree.leaves(medium) and medium is not AIR
        return Sampled(tuple(float(medium.index(each)) for each in um), um) if fixed else medium

    rows = tuple(dataclasses.replace(row, medium=known(row.medium), glass=None) for row in lens.rows)
    return dataclasses.replace(
        lens, rows=rows, object_medium=known(lens.object_medium), name="", source="", published=()
    )


def _check_ties_hold(lens: Lens, ties: tuple[Tie, ...]) -> None:
    """DesignError where a tie has no solution, or one of them undoes another, so that they would not hold when taken
    again."""
    again = tied(lens, ties)
    for tie in ties:
        once, twice = float(read(lens, tie.place)), float(read(again, tie.place))
        if not abs(once) < FARTHEST:
            raise DesignError(f"{tie.place.label}: what ties it has no finite solution at the start")
        if abs(once - twice) > TIED * max(abs(once), abs(twice), TIED):
            raise DesignError(
                f"{tie.place.label}: a tie that is taken later changes what it follows from; write it after that one, "
                "or leave one of them out"
            )


def _places(problem: Problem) -> dict[Place, tuple[float, float] | None]:
    """Every number that may change, and its bounds. DesignError for one named twice, or tied."""
    found: dict[Place, tuple[float, float] | None] = {}
    for variable in problem.vary:
        for place in places_of(problem.lens, variable):
            if place in found:
                raise DesignError(f"{place.label} is named twice; keep one of the variables")
            found[place] = limits_of(variable)
    check_ties(problem.lens, tuple(problem.tie))
    for tie in problem.tie:
        if tie.place in found:
            raise DesignError(f"{tie.place.label} is tied, and cannot vary too; leave out one of the two")
    if not found:
        raise DesignError("vary: no surface has such a number; name surfaces by their numbers")
    return found
