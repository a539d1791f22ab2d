"""From the keys of a prescription to a `Lens`: units, glasses, defaults."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from lenstrace.errors import PrescriptionError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.glasses import glass
from lenstrace.optics.media import AIR, AbbeModel, Constant, Medium, Table
from lenstrace.sequential.document import MM_PER_UNIT, Aperture, Fields, Wavelengths
from lenstrace.sequential.grammar import (
    AbbeKeys,
    FieldKeys,
    IndexTable,
    PublishedKeys,
    RowKeys,
    WavelengthKeys,
    checked,
)
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rows import Row
from lenstrace.sequential.rules import check_lens

PUBLISHED_LENGTHS = ("focal_length", "back_focal_length", "front_focal_length", "largest_spot")


def lens(
    rows: Sequence[Mapping[str, Any]],
    aperture: Mapping[str, Any],
    fields: Mapping[str, Any] | Sequence[float],
    wavelengths: Mapping[str, Any] | Sequence[float],
    *,
    object_distance: float = math.inf,
    object_glass: str | None = None,
    object_index: float | Mapping[str, Any] | None = None,
    ray_aiming: bool = False,
    image: Mapping[str, Any] | None = None,
    name: str = "",
    source: str = "",
    units: str = "mm",
) -> Lens:
    """A lens written in place, with the keys of the native file.

    rows:         a dict for each surface: radius, thickness, glass, stop, ... in `units`.
    aperture:     one of entrance_pupil_diameter, image_f_number, object_na, stop_semi_diameter.
    fields:       {"kind": "angle", "y": [0, 10, 14]}, or just the list of angles in degrees.
    wavelengths:  {"um": [...], "weights": [...], "primary": ...}, or just the list in micrometres.

    Raises PrescriptionError, or UnknownGlassError; the message names the row.

    >>> singlet = lens([{"radius": 50, "thickness": 10, "index": 1.5, "stop": True},
    ...                 {"radius": -50, "thickness": 48.27}],
    ...                {"entrance_pupil_diameter": 10}, [0], [0.5876])
    >>> singlet[1].radius
    50.0
    """
    section: dict[str, Any] = {
        "object_distance": object_distance,
        "ray_aiming": ray_aiming,
        "surfaces": list(rows),
    }
    if object_glass is not None:
        section["object_glass"] = object_glass
    if object_index is not None:
        section["object_index"] = object_index
    return lens_from_keys(
        {
            "name": name,
            "source": source,
            "units": units,
            "aperture": aperture,
            "fields": fields if isinstance(fields, Mapping) else {"y": fields},
            "wavelengths": wavelengths if isinstance(wavelengths, Mapping) else {"um": wavelengths},
            "lens": section,
            "image": image or {},
        }
    )


def lens_from_keys(keys: Mapping[str, Any]) -> Lens:
    """A lens out of the keys of a file, as `tomllib` reads them. PrescriptionError names row and key."""
    written = checked(keys)
    unit = MM_PER_UNIT[written.units]
    kind, value = _only_key(written.aperture, "aperture")
    if kind in ("entrance_pupil_diameter", "stop_semi_diameter"):
        value *= unit
    waves = written.wavelengths
    made = Lens(
        rows=tuple(_row(row, f"surface {number}", unit) for number, row in enumerate(written.lens.surfaces, 1)),
        image=_row(RowKeys(**written.image.model_dump(exclude_none=True)), "image", unit),
        aperture=Aperture(value, kind),
        fields=_fields(written.fields, written.units),
        wavelengths=Wavelengths(
            tuple(waves.weights if waves.weights is not None else [1.0] * len(waves.um)),
            tuple(waves.um),
            _primary(waves),
        ),
        object_medium=_medium(written.lens.object_glass, written.lens.object_index, None, "object space"),
        object_distance=None if written.lens.object_distance == math.inf else written.lens.object_distance * unit,
        object_glass=written.lens.object_glass,
        ray_aiming=written.lens.ray_aiming,
        name=written.name,
        source=written.source,
        published=_published(written.published, unit),
    )
    check_lens(made)
    # evaluates the glasses, so that a wavelength they do not know is reported now and not at the first question
    _ = made.system
    return made


def _published(written: PublishedKeys | None, unit: float) -> tuple[tuple[str, float], ...]:
    """Names and values, lengths in mm."""
    given = {} if written is None else written.model_dump(exclude_none=True)
    return tuple((key, value * unit if key in PUBLISHED_LENGTHS else value) for key, value in given.items())


def _row(row: RowKeys, where: str, unit: float) -> Row:
    if row.radius is not None and row.curvature is not None:
        raise PrescriptionError(f"{where}: both radius and curvature are given; write one of them")
    if row.radius == 0:
        raise PrescriptionError(
            f"{where}: radius must not be 0, got {row.radius}; leave it out, or write inf, for a plane"
        )
    if row.mirror and (row.glass is not None or row.index is not None or row.abbe is not None):
        raise PrescriptionError(f"{where}: a mirror keeps the medium before it; leave out its glass or index")
    curvature = row.curvature if row.curvature is not None else (1 / row.radius if row.radius is not None else 0.0)
    asphere = {_power(power, where): value for power, value in (row.asphere or {}).items()}
    powers = tuple(sorted(asphere))
    kind, numbers = ApertureKind.NONE, []
    if row.aperture is not None:
        key, numbers = _only_key(row.aperture, f"{where}: aperture")
        kind = ApertureKind(key)
        numbers = numbers if isinstance(numbers, list) else [numbers]
        if kind in (ApertureKind.ANNULUS, ApertureKind.RECTANGLE):
            _check_length(numbers, 2, f"{where}: aperture {key}")
    decenter, tilt = row.decenter or [0.0, 0.0], row.tilt or [0.0, 0.0, 0.0]
    _check_length(decenter, 2, f"{where}: decenter")
    _check_length(tilt, 3, f"{where}: tilt")
    return Row(
        curvature=curvature / unit,
        thickness=row.thickness * unit,
        conic=row.conic,
        coefficients=tuple(asphere[power] * unit ** (1 - power) for power in powers),
        decenter=(decenter[0] * unit, decenter[1] * unit),
        tilt=(tilt[0], tilt[1], tilt[2]),
        aperture=tuple(number * unit for number in numbers),
        medium=AIR if row.mirror else _medium(row.glass, row.index, row.abbe, where),
        powers=powers,
        aperture_kind=kind,
        glass=row.glass,
        mirror=row.mirror,
        stop=row.stop,
        is_break=row.is_break,
        semi_diameter=None if row.semi_diameter is None else row.semi_diameter * unit,
        name=row.name,
    )


def _medium(name: str | None, index: float | IndexTable | None, abbe: AbbeKeys | None, where: str) -> Medium:
    if sum(value is not None for value in (name, index, abbe)) > 1:
        raise PrescriptionError(f"{where}: write one of glass, index and abbe, got more than one")
    try:
        if name is not None:
            return glass(name)
        if isinstance(index, IndexTable):
            return Table(tuple(index.um), tuple(index.n))
    except ValueError as error:
        raise type(error)(f"{where}: {error}") from None
    if index is not None:
        return Constant(index)
    return AIR if abbe is None else AbbeModel(abbe.nd, abbe.vd)


def _fields(fields: FieldKeys, unit: str) -> Fields:
    if fields.x is None and fields.y is None:
        raise PrescriptionError("fields: at least one is needed, got none; an axial lens has y = [0]")
    count = len(fields.y if fields.y is not None else fields.x or [])
    x, y = (values if values is not None else [0.0] * count for values in (fields.x, fields.y))
    return Fields(tuple(x), tuple(y), fields.kind, unit)


def _primary(waves: WavelengthKeys) -> int:
    if waves.primary is None:
        return len(waves.um) // 2
    if waves.primary not in waves.um:
        raise PrescriptionError(f"wavelengths: primary must be one of um = {waves.um}, got {waves.primary}")
    return waves.um.index(waves.primary)


def _power(key: Any, where: str) -> int:
    text = str(key)
    if not text.isdecimal() or int(text) < 1:
        raise PrescriptionError(f"{where}: asphere: a key is the power of r, a positive integer such as 4, got {key!r}")
    return int(text)


def _only_key(section: BaseModel, where: str) -> tuple[str, Any]:
    given = section.model_dump(exclude_none=True)
    if len(given) != 1:
        got = " and ".join(given) or "none"
        raise PrescriptionError(f"{where}: exactly one of {', '.join(type(section).model_fields)} is needed, got {got}")
    return next(iter(given.items()))


def _check_length(values: list[float], length: int, what: str) -> None:
    if len(values) != length:
        raise PrescriptionError(f"{what} takes {length} numbers, got {values}")
