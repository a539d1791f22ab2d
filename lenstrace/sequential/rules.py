"""What a lens must obey to be one: every broken rule is one clear line."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from lenstrace.compute.pytree import is_traced
from lenstrace.errors import PrescriptionError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.sequential.document import Document
from lenstrace.sequential.rows import Row

APERTURE_KINDS = ("entrance_pupil_diameter", "image_f_number", "object_na", "stop_semi_diameter")
FIELD_KINDS = ("angle", "object_height", "image_height")

# The far end of the infrared that lenses are made for, um. Beyond lie wavelengths meant in nanometres.
LONGEST_UM = 100.0


def check_lens(lens: Document) -> None:
    """PrescriptionError for the first rule that a lens breaks."""
    if not lens.rows:
        raise PrescriptionError("surfaces: a lens needs at least one row, got none")
    for number, row in enumerate(lens.rows, 1):
        check_row(row, f"surface {number}")
    check_row(lens.image, "image")
    stops = [number for number, row in enumerate(lens.rows, 1) if row.stop]
    if not stops:
        raise PrescriptionError("surfaces: no row is the stop; write stop = true on the one that limits the light")
    if len(stops) > 1:
        raise PrescriptionError(
            f"surfaces: rows {_listed(stops)} are all marked stop; a lens has one, keep one of them"
        )
    for name, value in lens.published:
        if not (math.isfinite(value) and (value > 0 or name != "tolerance")):
            raise PrescriptionError(f"published: {name} must be a finite number, a tolerance positive, got {value}")
    _check_object(lens)
    _check_fields(lens)
    _check_wavelengths(lens)


def check_row(row: Row, where: str) -> None:
    """PrescriptionError for the first rule that a row breaks; `where` names it in the message."""
    for name in ("curvature", "thickness", "conic"):
        _check_finite(getattr(row, name), f"{where}: {name}")
    for power, coefficient in zip(row.powers, row.coefficients, strict=True):
        if power < 1:
            raise PrescriptionError(f"{where}: asphere power must be a positive integer, got {power}")
        _check_finite(coefficient, f"{where}: asphere term {power}")
    for name in ("decenter", "tilt", "aperture"):
        for value in getattr(row, name) or ():
            _check_finite(value, f"{where}: {name}")
    if row.screen is not None and row.screen.mistake:
        raise PrescriptionError(f"{where}: screen {row.screen.mistake}")
    if row.semi_diameter is not None and not (math.isfinite(row.semi_diameter) and row.semi_diameter > 0):
        raise PrescriptionError(
            f"{where}: semi_diameter must be positive, got {row.semi_diameter}; leave it out for no limit"
        )
    if any(not is_traced(value) and value <= 0 for value in row.aperture):
        raise PrescriptionError(f"{where}: aperture must be positive, got {_listed(row.aperture)} mm")
    if row.aperture_kind is ApertureKind.ANNULUS and not is_traced(row.aperture) and row.aperture[0] >= row.aperture[1]:
        raise PrescriptionError(
            f"{where}: aperture annulus must be [inner, outer] radius with inner < outer, got {_listed(row.aperture)}"
        )


def number_of(surface: int, count: int) -> int:
    """The number itself if it is one of a surface, else PrescriptionError."""
    if not 1 <= surface <= count:
        raise PrescriptionError(f"surface {surface} does not exist; this lens has surfaces 1 to {count}")
    return surface


def _check_object(lens: Document) -> None:
    value, kind = lens.aperture.value, lens.aperture.kind
    if kind not in APERTURE_KINDS:
        raise PrescriptionError(f"aperture: unknown kind {kind!r}; one of {', '.join(APERTURE_KINDS)}")
    if not is_traced(value) and not (math.isfinite(value) and value > 0):
        raise PrescriptionError(f"aperture: {kind} must be positive, got {value}")
    distance = lens.object_distance
    if distance is not None and not is_traced(distance) and not (math.isfinite(distance) and distance > 0):
        raise PrescriptionError(
            f"lens: object_distance must be positive (from the object to the first vertex), got {distance} mm; "
            "leave it out for an object at infinity"
        )
    if kind == "object_na" and distance is None:
        raise PrescriptionError("aperture: object_na needs an object at a finite distance; give [lens] object_distance")


def _check_fields(lens: Document) -> None:
    fields = lens.fields
    if fields.kind not in FIELD_KINDS:
        raise PrescriptionError(f"fields: unknown kind {fields.kind!r}; one of {', '.join(FIELD_KINDS)}")
    if not fields.y:
        raise PrescriptionError("fields: at least one is needed, got none; an axial lens has y = [0]")
    if len(fields.x) != len(fields.y):
        raise PrescriptionError(f"fields: x has {len(fields.x)} values and y {len(fields.y)}; give as many of both")
    for value in (*fields.x, *fields.y):
        _check_finite(value, "fields: a value")
    if fields.kind == "object_height" and lens.object_distance is None:
        raise PrescriptionError(
            "fields: object_height needs an object at a finite distance; give [lens] object_distance, or kind angle"
        )
    for x, y in zip(fields.x, fields.y, strict=True):
        check_field(lens, x, y)


def check_field(lens: Document, x: Any, y: Any) -> None:
    """PrescriptionError for angles that are none; x and y in degrees, numbers or arrays."""
    if lens.fields.kind != "angle" or is_traced((x, y)):
        return
    limit = 180 if lens.object_distance is None else 90
    for a, b in zip(*(each.flat for each in np.broadcast_arrays(np.asarray(x), np.asarray(y))), strict=True):
        if max(abs(a), abs(b)) >= limit:
            raise PrescriptionError(f"fields: an angle must be below {limit} degrees, got ({a:g}, {b:g})")
        if max(abs(a), abs(b)) >= 90 and min(abs(a), abs(b)) > 0:
            raise PrescriptionError(
                f"fields: at 90 degrees and beyond a field lies in x or y alone, got ({a:g}, {b:g})"
            )


def _check_wavelengths(lens: Document) -> None:
    waves = lens.wavelengths
    if not waves.um:
        raise PrescriptionError("wavelengths: at least one is needed, got none")
    if len(waves.weights) != len(waves.um):
        raise PrescriptionError(
            f"wavelengths: {len(waves.weights)} weights for {len(waves.um)} wavelengths; give one for each"
        )
    for um in waves.um:
        check_wavelength(um)
    if len(set(waves.um)) != len(waves.um):
        raise PrescriptionError(f"wavelengths: each may stand once, got um = {list(waves.um)}")
    for weight in waves.weights:
        if not is_traced(weight) and not (math.isfinite(weight) and weight >= 0):
            raise PrescriptionError(f"wavelengths: weights must not be negative, got {weight}")
    if not is_traced(waves.weights) and not any(waves.weights):
        raise PrescriptionError("wavelengths: at least one weight must be positive, got only zeros")


def check_wavelength(um: float) -> None:
    """PrescriptionError for what is no wavelength in micrometres."""
    if not (math.isfinite(um) and um > 0):
        raise PrescriptionError(f"wavelengths: um must be positive, in micrometres, got {um:g}")
    if um > LONGEST_UM:
        raise PrescriptionError(
            f"wavelengths: {um:g} um is no light for lenses; if it is meant in nanometres, write {um / 1000:g}"
        )


def _check_finite(value: Any, what: str) -> None:
    if not is_traced(value) and not math.isfinite(value):
        raise PrescriptionError(f"{what} must be a finite number, got {value}")


def _listed(values: Any) -> str:
    return ", ".join(f"{value:g}" for value in values)
