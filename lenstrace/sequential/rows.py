"""One row of a prescription: a surface and what follows it, as a person reads and edits it."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import jax

from lenstrace.errors import PrescriptionError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.glasses import glass
from lenstrace.optics.media import AIR, Constant, Medium
from lenstrace.pytree import is_traced, pytree, static

Number = float | jax.Array
APERTURE_KEYS = ", ".join(kind.value for kind in ApertureKind if kind is not ApertureKind.NONE)


@pytree
class Row:
    """A surface; numbers may be traced by JAX, and are what `jax.grad` of a function of a lens differentiates by.

    curvature:     1/mm, 0 for a plane.          conic: k.
    thickness:     mm along z to the next vertex, negative after an odd number of mirrors.
    medium:        what follows the surface; a mirror keeps the medium before it.
    coefficients:  asphere terms, mm^(1 - p), one for each of the static `powers` p.
    decenter:      mm, x and y.                  tilt: degrees, about x, y, z.
    aperture:      numbers of the aperture, mm (see `ApertureKind`).
    glass:         the glass as it was written, for the table and the file; None for an index given by numbers.
    is_break:      decentre and tilt move all that follows, not this surface alone.
    semi_diameter: mm, drawn only.
    """

    curvature: Number = 0.0
    thickness: Number = 0.0
    conic: Number = 0.0
    coefficients: tuple[Number, ...] = ()
    decenter: tuple[Number, Number] = (0.0, 0.0)
    tilt: tuple[Number, Number, Number] = (0.0, 0.0, 0.0)
    aperture: tuple[Number, ...] = ()
    medium: Medium = AIR
    powers: tuple[int, ...] = static(default=())
    aperture_kind: ApertureKind = static(default=ApertureKind.NONE)
    glass: str | None = static(default=None)
    mirror: bool = static(default=False)
    stop: bool = static(default=False)
    is_break: bool = static(default=False)
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
        """What the table says of the medium."""
        return "mirror" if self.mirror else self.glass or self.medium.name

    @property
    def is_posed(self) -> bool:
        """True where a decentre or a tilt is written."""
        return not all(is_zero(value) for value in (*self.decenter, *self.tilt))

    def replace(self, **changes: Any) -> Row:
        """A copy with some fields changed, by their names here or by the keys of the file: radius (mm), glass,
        index, asphere (a dict of power to coefficient), aperture (a dict such as {"circle": 9.5}).
        PrescriptionError or UnknownGlassError for what a row cannot have."""
        return dataclasses.replace(self, **_fields_of(changes))


def _fields_of(changes: dict[str, Any]) -> dict[str, Any]:
    """Fields of a Row out of the words a user may change it by."""
    fields = dict(changes)
    if "radius" in fields:
        radius = fields.pop("radius")
        if is_zero(radius):
            raise PrescriptionError("radius must not be 0; a plane has radius inf, or curvature 0")
        fields["curvature"] = 1 / radius
    if "asphere" in fields:
        terms = sorted(fields.pop("asphere").items())
        fields["powers"] = tuple(int(power) for power, _ in terms)
        fields["coefficients"] = tuple(coefficient for _, coefficient in terms)
    if "glass" in fields:
        fields["medium"] = AIR if fields["glass"] is None else glass(fields["glass"])
    if "index" in fields:
        fields |= {"medium": Constant(fields.pop("index")), "glass": None}
    if isinstance(fields.get("aperture"), dict):
        (kind, numbers), *more = fields["aperture"].items() or [("none", ())]
        if more or kind not in {kind.value for kind in ApertureKind}:
            raise PrescriptionError(f"aperture takes one of {APERTURE_KEYS}, got {fields['aperture']}")
        fields["aperture_kind"] = ApertureKind(kind)
        fields["aperture"] = tuple(numbers) if isinstance(numbers, (list, tuple)) else (numbers,)
    known = {field.name for field in dataclasses.fields(Row)}
    for name in fields:
        if name not in known:
            choices = ", ".join(sorted(known | {"radius", "asphere", "index"}))
            raise PrescriptionError(f"a surface has no {name!r}; it has {choices}")
    return fields


def is_zero(value: Number) -> bool:
    """True for a number known to be 0; a traced number is not known."""
    return not is_traced(value) and bool(value == 0)
