"""Numbers of a lens that follow from others while it changes: pickups and solves."""

from __future__ import annotations

from typing import Any, Literal

import jax
import numpy as np

from lenstrace.analysis.conditions import with_pupil
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.design.places import Place, read, written
from lenstrace.design.view import paraxial_rays
from lenstrace.errors import DesignError
from lenstrace.optics.vectors import safe_divide
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens

Kind = Literal["curvature", "thickness", "conic"]


@pytree
class Pickup:
    """A curvature, thickness or conic that is scale times that of another surface, plus offset: -1 is symmetry.

    >>> Pickup("curvature", 6, of=1, scale=-1).place.label
    'curvature 6'
    """

    what: Kind = static()
    surface: int = static()
    of: int = static()
    scale: Any = 1.0
    offset: Any = 0.0

    @property
    def place(self) -> Place:
        """What is tied."""
        return Place(self.what, self.surface)

    def check(self, lens: Lens) -> None:
        """DesignError for a number or a surface that is none, and for a pickup of itself."""
        if self.what not in ("curvature", "thickness", "conic"):
            raise DesignError(f"pickup: what must be curvature, thickness or conic, got {self.what!r}")
        for surface in (self.surface, self.of):
            _check_surface(f"pickup of {self.what}", surface, len(lens))
        for key in ("scale", "offset"):
            _check_one("pickup", key, getattr(self, key))
        if self.surface == self.of:
            raise DesignError(f"pickup: {self.place.label} cannot follow itself; name another surface")

    def applied(self, lens: Lens) -> Lens:
        """The lens with the number that follows."""
        value = self.scale * read(lens, Place(self.what, self.of)) + self.offset
        return written(lens, [(self.place, value)])


@pytree
class CurvatureSolve:
    """The curvature of a surface that gives the lens a focal length (mm), or an f-number; one of the two.

    Power is linear in every curvature, so there is one such curvature wherever light meets the surface off the axis.
    """

    surface: int = static()
    focal_length: Any = None
    f_number: Any = None

    @property
    def place(self) -> Place:
        """What is tied."""
        return Place("curvature", self.surface)

    def check(self, lens: Lens) -> None:
        """DesignError for a surface that is none or does not bend, or without one of the two targets."""
        _check_surface("curvature solve", self.surface, len(lens))
        if (self.focal_length is None) == (self.f_number is None):
            raise DesignError("curvature solve: give focal_length or f_number, one of the two")
        _check_one("curvature solve", "focal_length or f_number", self.focal_length or self.f_number)
        if self.f_number is not None and lens.aperture.kind != "entrance_pupil_diameter":
            raise DesignError("curvature solve: f_number needs an aperture given as entrance_pupil_diameter")
        if not lens.system.bends[self.surface - 1]:
            raise DesignError(f"curvature solve: surface {self.surface} does not bend light; name one that does")

    def applied(self, lens: Lens) -> Lens:
        """The lens with that curvature."""

        def power(curvature: float) -> tuple[jax.Array, Lens]:
            changed = written(lens, [(self.place, curvature)])
            return paraxial.first_order(changed.system.at(changed.system.primary)).power, changed

        (none, _), (one, _) = power(0.0), power(1.0)
        system = lens.system.at(lens.system.primary)
        length = self.focal_length
        if length is None:
            # a lens that gathers light: behind an odd number of mirrors its focal length is negative
            length = self.f_number * system.stop_size * system.orientation[-1]
        wanted = paraxial.signed_index(system)[-1] / length
        return written(lens, [(self.place, safe_divide(wanted - none, one - none))])


@pytree
class ThicknessSolve:
    """The thickness behind a surface at which the marginal ray, or the chief ray of the largest field, has a height at
    the next surface, mm. Behind the last surface, with height 0 of the marginal ray, it is the paraxial image."""

    surface: int = static()
    height: Any = 0.0
    ray: Literal["marginal", "chief"] = static(default="marginal")

    @property
    def place(self) -> Place:
        """What is tied."""
        return Place("thickness", self.surface)

    def check(self, lens: Lens) -> None:
        """DesignError for a surface or a ray that is none, or a ray that runs parallel to the axis there."""
        _check_surface("thickness solve", self.surface, len(lens))
        if self.ray not in ("marginal", "chief"):
            raise DesignError(f"thickness solve: ray must be marginal or chief, got {self.ray!r}")
        _check_one("thickness solve", "height", self.height)
        if self.surface < lens.stop and self.ray == "chief":
            raise DesignError(
                f"thickness solve: before the stop, surface {lens.stop}, the chief ray follows from the gap"
            )

    def applied(self, lens: Lens) -> Lens:
        """The lens with that thickness."""
        system, front = with_pupil(lens)
        primary = system.at(system.primary)
        heights, before, behind = paraxial_rays(primary, system.fields, front.scale)
        place = 0 if self.ray == "marginal" else 1
        last = self.surface == system.surfaces
        slope = (behind[place] if last else before[place, self.surface]) / paraxial.signed_index(primary)[self.surface]
        return written(lens, [(self.place, safe_divide(self.height - heights[place, self.surface - 1], slope))])


Tie = Pickup | CurvatureSolve | ThicknessSolve


def check_ties(lens: Lens, ties: tuple[Tie, ...]) -> None:
    """DesignError for the first tie that makes no sense."""
    for tie in ties:
        tie.check(lens)
    places = [tie.place for tie in ties]
    for place in places:
        if places.count(place) > 1:
            raise DesignError(f"{place.label} is tied twice; keep one of the two")
    # a pickup of a pickup must come after it
    for i, tie in enumerate(ties):
        if isinstance(tie, Pickup) and (source := Place(tie.what, tie.of)) in places[i:]:
            raise DesignError(
                f"{tie.place.label} follows {source.label}, which is tied after it; write ties in the order in which "
                "they are taken, without a circle"
            )


def tied(lens: Lens, ties: tuple[Tie, ...]) -> Lens:
    """The lens with the numbers that follow, one after the other; JAX may trace them."""
    if not ties or is_traced((lens, ties)):
        return _applied(lens, ties)
    found = jax.device_get(_compiled(lens, ties))
    return written(lens, [(tie.place, float(read(found, tie.place))) for tie in ties])


def _applied(lens: Lens, ties: tuple[Tie, ...]) -> Lens:
    for tie in ties:
        lens = tie.applied(lens)
    return lens


_compiled = compiled(_applied)


def _check_one(what: str, key: str, value: Any) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not np.isfinite(value):
        raise DesignError(f"{what}: {key} must be one finite number, got {value!r}")


def _check_surface(what: str, surface: int, count: int) -> None:
    if isinstance(surface, bool) or not isinstance(surface, int) or not 1 <= surface <= count:
        raise DesignError(f"{what}: surface must be a number from 1 to {count}, got {surface!r}")
