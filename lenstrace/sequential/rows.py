"""One row of a prescription: a surface and what follows it, as a person reads and edits it."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import jax

from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.errors import PrescriptionError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.media import AIR, Medium
from lenstrace.optics.screens.screen import Screen
from lenstrace.sequential.row_keys import KEYS, row_fields

Number = float | jax.Array


@pytree
class Row:
    """A surface; numbers may be traced by JAX, and are what `jax.grad` of a function of a lens differentiates by.

    curvature:     1/mm, 0 for a plane.          conic: k.
    thickness:     mm along z to the next vertex, negative after an odd number of mirrors.
    medium:        what follows the surface; a mirror keeps the medium before it.
    coefficients:  asphere terms, mm^(1 - p), one for each of the static `powers` p.
    decenter:      mm, x and y.                  tilt: degrees, about x, y, z; None where nothing is written.
    aperture:      numbers of the aperture, mm (see `ApertureKind`).
    glass:         the glass as it was written, for the table and the file; None for an index given by numbers.
    screen:        a thin phase screen on the surface; None where there is none.
    is_break:      decentre and tilt move all that follows, not this surface alone.
    turned:        the tilt turns the axis by more than 90 degrees; kept while JAX traces the tilt.
    semi_diameter: mm, drawn only.
    """

    curvature: Number = 0.0
    thickness: Number = 0.0
    conic: Number = 0.0
    coefficients: tuple[Number, ...] = ()
    decenter: tuple[Number, Number] | None = None
    tilt: tuple[Number, Number, Number] | None = None
    aperture: tuple[Number, ...] = ()
    medium: Medium = AIR
    screen: Screen | None = None
    powers: tuple[int, ...] = static(default=())
    aperture_kind: ApertureKind = static(default=ApertureKind.NONE)
    glass: str | None = static(default=None)
    mirror: bool = static(default=False)
    stop: bool = static(default=False)
    is_break: bool = static(default=False)
    turned: bool = static(default=False)
    semi_diameter: float | None = static(default=None)
    name: str = static(default="")

    @property
    def radius(self) -> Number:
        """Radius of curvature in mm, inf for a plane."""
        return math.inf if is_zero(self.curvature) else 1 / self.curvature

    @property
    def asphere(self) -> dict[int, Number]:
        """The asphere terms, power of r to coefficient."""
        return dict(zip(self.powers, self.coefficients, strict=True))

    @property
    def material(self) -> str:
        """What the table says of the medium: a glass with the catalogue it was taken from."""
        if self.mirror or self.glass is None:
            return "mirror" if self.mirror else self.medium.name
        catalog = getattr(self.medium, "catalog", "")
        return self.glass if not catalog or ":" in self.glass else f"{self.glass} ({catalog})"

    @property
    def is_posed(self) -> bool:
        """True where a decentre or a tilt is written."""
        return self.decenter is not None or self.tilt is not None

    def replace(self, **changes: Any) -> Row:
        """A copy with some fields changed, by their names here or by the keys of the file: radius (mm), glass,
        index, abbe, asphere (a dict of power to coefficient), aperture (a dict such as {"circle": 9.5}), screen
        (a dict such as {"ideal_lens": 100.0}), break.
        PrescriptionError, MediumError or UnknownGlassError for what a surface cannot have."""
        fields = row_fields(changes)
        known = {field.name for field in dataclasses.fields(self)}
        for name in fields:
            if name not in known:
                raise PrescriptionError(f"a surface has no {name!r}; it has {', '.join(sorted({*known, *KEYS}))}")
        return dataclasses.replace(self, **fields)


def is_zero(value: Number) -> bool:
    """True for a number known to be 0; a traced number is not known."""
    return not is_traced(value) and bool(value == 0)
