"""The native prescription file: TOML, read and written; what is read again is the same to the last bit."""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import tomlkit
from tomlkit.items import InlineTable

from lenstrace.errors import LensTraceError, PrescriptionError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.media import AbbeModel, Air, Constant, Table
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens_from_keys
from lenstrace.sequential.rows import Row
from lenstrace.sequential.screen_keys import keys_of

Made = TypeVar("Made")


def load(path: str | os.PathLike[str]) -> Lens:
    """Read a lens. PrescriptionError (or another LensTraceError) says file, row, what, got, what to do."""
    return read_with(path, loads)


def loads(text: str) -> Lens:
    """A lens out of the text of a file."""
    return lens_from_keys(keys_in(text))


def read_with(path: str | os.PathLike[str], made: Callable[[str], Made]) -> Made:
    """What is made out of the text of a file; its errors, and those of reading it, name the file."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a text file"
        raise PrescriptionError(f"{path}: cannot be read: {reason}") from None
    try:
        return made(text)
    except LensTraceError as error:
        raise type(error)(f"{path}: {error}") from None


def keys_in(text: str) -> dict[str, Any]:
    """The keys of a file; PrescriptionError for what is no TOML."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise PrescriptionError(f"not valid TOML: {error}") from None


def save(lens: Lens, path: str | os.PathLike[str]) -> None:
    """Write a lens, in mm. The file appears whole or not at all."""
    write_whole(dumps(lens), path)


def write_whole(text: str, path: str | os.PathLike[str]) -> None:
    """Write a file that appears whole or not at all; PrescriptionError where it cannot be written."""
    target = Path(path).resolve()  # a link is written through, not replaced
    partial = target.with_name(f".{target.name}.partial")
    try:
        partial.write_text(text, encoding="utf-8")
        partial.replace(target)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise PrescriptionError(f"{path}: cannot be written: {error.strerror}") from None


def dumps(lens: Lens) -> str:
    """The text of a lens's file, lengths in mm."""
    document = tomlkit.document()
    document["name"] = lens.name
    if lens.source:
        document["source"] = lens.source
    document["aperture"] = {lens.aperture.kind: float(lens.aperture.value)}
    fields: dict[str, Any] = {"kind": lens.fields.kind}
    scale = 1.0 if lens.fields.kind == "angle" else lens.fields.scale
    if any(lens.fields.x):
        fields["x"] = [float(x) * scale for x in lens.fields.x]
    document["fields"] = fields | {"y": [float(y) * scale for y in lens.fields.y]}
    waves = lens.wavelengths
    document["wavelengths"] = {
        "um": list(waves.um),
        "weights": [float(weight) for weight in waves.weights],
        "primary": waves.um[waves.primary],
    }
    section = tomlkit.table()
    section["object_distance"] = math.inf if lens.object_distance is None else float(lens.object_distance)
    section.update(
        {f"object_{key}": value for key, value in _medium_keys(lens.object_glass, lens.object_medium).items()}
    )
    section["ray_aiming"] = lens.ray_aiming
    if lens.clip_at_semi_diameters:
        section["clip_at_semi_diameters"] = True
    surfaces = tomlkit.array().multiline(True)
    for row in lens.rows:
        surfaces.append(_inline(_row_keys(row)))
    section["surfaces"] = surfaces
    document["lens"] = section
    image = {key: value for key, value in _row_keys(lens.image).items() if key != "thickness"}
    if image:
        document["image"] = image
    if lens.published:
        document["published"] = dict(lens.published)
    return tomlkit.dumps(document)


def _row_keys(row: Row) -> dict[str, Any]:
    """The keys of a row, without those that say nothing."""
    keys: dict[str, Any] = {}
    if row.curvature != 0:
        radius = shortest_inverse(float(row.curvature), lambda r: 1 / r, 1 / float(row.curvature))
        keys |= {"curvature": float(row.curvature)} if radius is None else {"radius": radius}
    keys["thickness"] = float(row.thickness)
    if row.conic != 0:
        keys["conic"] = float(row.conic)
    if row.powers:
        keys["asphere"] = {str(power): float(value) for power, value in row.asphere.items()}
    if not row.mirror:
        keys |= _medium_keys(row.glass, row.medium)
    keys |= {key: True for key, said in (("mirror", row.mirror), ("stop", row.stop), ("break", row.is_break)) if said}
    if row.semi_diameter is not None:
        keys["semi_diameter"] = row.semi_diameter
    if row.aperture_kind is not ApertureKind.NONE:
        numbers = [float(number) for number in row.aperture]
        keys["aperture"] = {row.aperture_kind.value: numbers if len(numbers) > 1 else numbers[0]}
    if row.screen is not None:
        keys["screen"] = keys_of(row.screen)
    for name, values in (("decenter", row.decenter), ("tilt", row.tilt)):
        if values is not None:
            keys[name] = [float(value) for value in values]
    if row.name:
        keys["name"] = row.name
    return keys


def _medium_keys(name: str | None, medium: Any) -> dict[str, Any]:
    if name is not None:
        return {"glass": name}
    match medium:
        case Constant():
            return {"index": float(medium.n)}
        case Table():
            return {"index": {"um": list(medium.um), "n": list(medium.n)}}
        case AbbeModel():
            return {"abbe": {"nd": float(medium.nd), "vd": float(medium.vd)}}
        case Air():
            return {}
        case _:
            raise PrescriptionError(f"the medium {medium.name} stands in no catalogue; give it as an index to save it")


def _inline(keys: dict[str, Any]) -> InlineTable:
    table = tomlkit.inline_table()
    for key, value in keys.items():
        table[key] = _inline(value) if isinstance(value, dict) else value
    return table


def shortest_inverse(value: float, forward: Callable[[float], float], near: float) -> float | None:
    """The number with the shortest decimal form that `forward` takes to exactly `value`; None if there is none.

    near: the inverse to within a few units in the last place.
    """
    candidates = [near]
    for direction in (math.inf, -math.inf):
        step = near
        for _ in range(4):
            step = math.nextafter(step, direction)
            candidates.append(step)
    exact = [candidate for candidate in candidates if forward(candidate) == value]
    return min(exact, key=lambda candidate: len(repr(candidate)), default=None)
