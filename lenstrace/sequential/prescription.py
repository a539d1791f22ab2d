"""From the keys of a prescription to a `Lens`: units, glasses, defaults."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import BaseModel

from lenstrace.errors import LensTraceError, PrescriptionError
from lenstrace.optics.media import AIR, Medium
from lenstrace.sequential.document import MM_PER_UNIT, Aperture, Fields, Wavelengths
from lenstrace.sequential.grammar import (
    FieldKeys,
    ImageKeys,
    LensKeys,
    PublishedKeys,
    RowKeys,
    WavelengthKeys,
    checked,
)
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.row_keys import medium_of
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
    clip_at_semi_diameters: bool = False,
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
        "clip_at_semi_diameters": clip_at_semi_diameters,
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
        image=_row(written.image, "image", unit),
        aperture=Aperture(value, kind),
        fields=_fields(written.fields, written.units),
        wavelengths=Wavelengths(
            tuple(waves.weights if waves.weights is not None else [1.0] * len(waves.um)),
            tuple(waves.um),
            _primary(waves),
        ),
        object_medium=_object_medium(written.lens),
        object_distance=None if written.lens.object_distance == math.inf else written.lens.object_distance * unit,
        object_glass=written.lens.object_glass,
        ray_aiming=written.lens.ray_aiming,
        clip_at_semi_diameters=written.lens.clip_at_semi_diameters,
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


def _row(row: RowKeys | ImageKeys, where: str, unit: float) -> Row:
    """A row out of its keys, scaled to mm."""
    keys = {name: _plain(getattr(row, name)) for name in row.model_fields_set}
    if keys.get("mirror") and {"glass", "index", "abbe"} & set(keys):
        raise PrescriptionError(f"{where}: a mirror keeps the medium before it; leave out its glass or index")
    for name in ("radius", "thickness", "semi_diameter"):
        if name in keys:
            keys[name] *= unit
    if "curvature" in keys:
        keys["curvature"] /= unit
    if "decenter" in keys:
        keys["decenter"] = [value * unit for value in keys["decenter"]]
    if "aperture" in keys:
        sizes = {key: np.multiply(value, unit).tolist() for key, value in keys["aperture"].items()}
        keys["aperture"] = sizes
    try:
        made = Row().replace(**keys)
    except LensTraceError as error:
        raise type(error)(f"{where}: {error}") from None
    in_mm = tuple(a * unit ** (1 - power) for power, a in made.asphere.items())
    screen = None if made.screen is None else made.screen.scaled(unit)
    return dataclasses.replace(made, coefficients=in_mm, screen=screen)


def _object_medium(keys: LensKeys) -> Medium:
    index = _plain(keys.object_index)
    if index is not None and keys.object_glass is not None:
        raise PrescriptionError("lens: both object_glass and object_index are given; write one of them")
    try:
        return AIR if index is None and keys.object_glass is None else medium_of(index, name=keys.object_glass)
    except LensTraceError as error:
        raise type(error)(f"object space: {error}") from None


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


def _plain(value: Any) -> Any:
    """A section as a dict, anything else as it is."""
    return value.model_dump(exclude_none=True) if isinstance(value, BaseModel) else value


def _only_key(section: BaseModel, where: str) -> tuple[str, Any]:
    given = section.model_dump(exclude_none=True)
    if len(given) != 1:
        got = " and ".join(given) or "none"
        raise PrescriptionError(f"{where}: exactly one of {', '.join(type(section).model_fields)} is needed, got {got}")
    return next(iter(given.items()))
