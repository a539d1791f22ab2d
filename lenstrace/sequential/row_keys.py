"""From the words a person says of a surface (the keys of the file) to the fields of a `Row`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from lenstrace.compute.pytree import is_traced
from lenstrace.errors import PrescriptionError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.glasses import glass
from lenstrace.optics.media import AIR, AbbeModel, Constant, Medium, Table
from lenstrace.sequential.numbers_given import number, several
from lenstrace.sequential.screen_keys import screen_of

KEYS = ("radius", "asphere", "index", "abbe", "break")
APERTURES = {kind.value: kind for kind in ApertureKind if kind is not ApertureKind.NONE}
TWO_NUMBERS = (ApertureKind.ANNULUS, ApertureKind.RECTANGLE)
# Slack in deciding that a tilt turns the axis beyond 90 degrees: a right angle itself does not.
TURNED = -1e-9


def row_fields(changes: Mapping[str, Any]) -> dict[str, Any]:
    """Fields of a Row out of changes named by its fields or by the keys of the file; lengths in mm.

    Numbers become floats, unless JAX holds them. PrescriptionError, MediumError or UnknownGlassError for what a
    surface cannot have; the message does not say which surface.
    """
    fields = dict(changes)
    _only_one(fields, "radius", "curvature")
    _only_one(fields, "glass", "index", "abbe", "medium")
    if "radius" in fields:
        radius = number(fields.pop("radius"), "radius")
        if not is_traced(radius) and radius == 0:
            raise PrescriptionError("radius must not be 0; a plane has radius inf, or curvature 0")
        fields["curvature"] = 1 / radius
    for name in ("curvature", "thickness", "conic"):
        if name in fields:
            fields[name] = number(fields[name], name)
    if "asphere" in fields:
        terms = sorted(
            (_power(power), number(value, f"asphere term {power}")) for power, value in fields.pop("asphere").items()
        )
        fields |= {"powers": tuple(p for p, _ in terms), "coefficients": tuple(a for _, a in terms)}
    for name, length in (("decenter", 2), ("tilt", 3)):
        if fields.get(name) is not None:
            fields[name] = several(fields[name], length, name)
    if "break" in fields:
        fields["is_break"] = fields.pop("break")
    if fields.get("tilt") is not None and not is_traced(fields["tilt"]):
        fields["turned"] = bool(np.prod(np.cos(np.radians(np.array(fields["tilt"][:2], float)))) < TURNED)
    if "aperture" in fields:
        fields |= _aperture(fields["aperture"])
    if fields.get("screen") is not None:
        fields["screen"] = screen_of(fields["screen"])
    return fields | _medium(fields)


def medium_of(index: Any = None, abbe: Any = None, name: str | None = None) -> Medium:
    """The medium of one of index (a number, or a mapping of um and n), abbe (a mapping of nd and vd) and a name."""
    if name is not None:
        return glass(name)
    if isinstance(index, Mapping):
        return Table(tuple(index["um"]), tuple(index["n"]))
    if isinstance(abbe, Mapping):
        nd, vd = number(abbe["nd"], "nd"), number(abbe["vd"], "vd")
        if not is_traced(vd) and not (np.isfinite(vd) and vd > 0):
            raise PrescriptionError(f"abbe: vd must be positive, got {vd:g}")
        return AbbeModel(nd, vd)
    return Constant(number(index, "index"))


def _medium(fields: dict[str, Any]) -> dict[str, Any]:
    """The medium, and its name as it is written in a file."""
    name, index, abbe = fields.get("glass"), fields.pop("index", None), fields.pop("abbe", None)
    if name is not None:
        return {"medium": medium_of(name=name)}
    if index is not None or abbe is not None:
        return {"medium": medium_of(index, abbe), "glass": None}
    if "medium" in fields:
        catalog = getattr(fields["medium"], "catalog", "")
        return {"glass": f"{catalog}:{fields['medium'].name}" if catalog else None}
    return {"medium": AIR} if "glass" in fields else {}


def _aperture(value: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        return {"aperture": tuple(number(each, "aperture") for each in value)}
    if len(value) > 1 or not set(value) <= set(APERTURES):
        raise PrescriptionError(f"aperture takes one of {', '.join(APERTURES)}, got {dict(value)}")
    if not value:
        return {"aperture": (), "aperture_kind": ApertureKind.NONE}
    (key, sizes), kind = next(iter(value.items())), APERTURES[next(iter(value))]
    sizes = several(sizes, 2, f"aperture {key}") if kind in TWO_NUMBERS else (number(sizes, f"aperture {key}"),)
    return {"aperture": sizes, "aperture_kind": kind}


def _power(key: Any) -> int:
    text = str(key)
    if not text.isdecimal() or int(text) < 1:
        raise PrescriptionError(f"asphere: a key is the power of r, a positive integer such as 4, got {key!r}")
    return int(text)


def _only_one(fields: Mapping[str, Any], *names: str) -> None:
    given = [name for name in names if fields.get(name) is not None]
    if len(given) > 1:
        raise PrescriptionError(f"both {' and '.join(given)} are given; write one of {', '.join(names)}")
