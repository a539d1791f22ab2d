"""The grammar of the native file: which keys stand where, of what type; what is wrong, in one line."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Strict, Tag, ValidationError

from lenstrace.errors import PrescriptionError

Number = Annotated[float, Strict()]
Flag = Annotated[bool, Strict()]
Text = Annotated[str, Strict()]
Numbers = Annotated[list[Number], BeforeValidator(lambda v: v.tolist() if hasattr(v, "tolist") else v)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid")


class IndexTable(_Section):
    """index = { um = [...], n = [...] }"""

    um: Numbers
    n: Numbers


class AbbeKeys(_Section):
    """abbe = { nd = 1.62, vd = 60.3 }"""

    nd: Number
    vd: Number


class ApertureOfRow(_Section):
    """aperture = { circle = 9.5 }, or one of the others; lengths in the units of the file."""

    circle: Number | None = None
    annulus: Numbers | None = None
    rectangle: Numbers | None = None
    obscuration: Number | None = None


class GratingKeys(_Section):
    """grating = { period = 0.002, order = 1, angle = 90 }: a length; a whole number; degrees from x toward y."""

    period: Number
    order: Number = 1.0
    angle: Number = 0.0


class ZernikeKeys(_Section):
    """zernike = { radius = 10, order = "noll", terms = { 4 = 1e-4 } }: lengths; the numbers of the terms."""

    radius: Number
    order: Literal["noll", "fringe", "ansi"] = "noll"
    terms: dict[Any, Number]


class GridKeys(_Section):
    """grid = { half_width = [5, 5], path = [[...], ...] }: lengths; rows of equal y, from the lowest up."""

    half_width: Numbers
    path: list[Numbers]


class ScreenOfRow(_Section):
    """screen = { ideal_lens = 100 }, or one of the others; lengths in the units of the file."""

    ideal_lens: Number | None = None
    quadratic_lens: Number | None = None
    grating: GratingKeys | None = None
    zernike: ZernikeKeys | None = None
    grid: GridKeys | None = None
    point_mass: Number | None = None


IndexKeys = Annotated[
    Annotated[Number, Tag("number")] | Annotated[IndexTable, Tag("table")],
    Discriminator(lambda value: "table" if isinstance(value, Mapping) else "number"),
]


class RowKeys(_Section):
    """One line of `surfaces`."""

    radius: Number | None = None
    curvature: Number | None = None
    thickness: Number = 0.0
    conic: Number = 0.0
    asphere: dict[Any, Number] | None = None
    glass: Text | None = None
    index: IndexKeys | None = None
    abbe: AbbeKeys | None = None
    mirror: Flag = False
    stop: Flag = False
    semi_diameter: Number | None = None
    aperture: ApertureOfRow | None = None
    screen: ScreenOfRow | None = None
    decenter: Numbers | None = None
    tilt: Numbers | None = None
    # `break` is a word of Python
    model_config = ConfigDict(extra="forbid", alias_generator=lambda name: "break" if name == "is_break" else name)
    is_break: Flag = False
    name: Text = ""


class ImageKeys(_Section):
    """[image]"""

    radius: Number | None = None
    curvature: Number | None = None
    conic: Number = 0.0
    asphere: dict[Any, Number] | None = None
    semi_diameter: Number | None = None


class ApertureKeys(_Section):
    """[aperture], exactly one key."""

    entrance_pupil_diameter: Number | None = None
    image_f_number: Number | None = None
    object_na: Number | None = None
    stop_semi_diameter: Number | None = None


class FieldKeys(_Section):
    """[fields]"""

    kind: Literal["angle", "object_height", "image_height"] = "angle"
    x: Numbers | None = None
    y: Numbers | None = None


class WavelengthKeys(_Section):
    """[wavelengths]"""

    um: Numbers
    weights: Numbers | None = None
    primary: Number | None = None


class LensKeys(_Section):
    """[lens]"""

    object_distance: Number = math.inf
    object_glass: Text | None = None
    object_index: IndexKeys | None = None
    ray_aiming: Flag = False
    clip_at_semi_diameters: Flag = False
    surfaces: list[RowKeys]


class PublishedKeys(_Section):
    """[published]: what the source, a closed form or other programs say, at the primary wavelength; lengths in
    units of the file. tolerance: relative, of all figures."""

    focal_length: Number | None = None
    back_focal_length: Number | None = None
    front_focal_length: Number | None = None
    f_number: Number | None = None
    magnification: Number | None = None
    angular_magnification: Number | None = None
    largest_spot: Number | None = None
    tolerance: Number = 1e-9


class Prescription(_Section):
    """The whole file."""

    name: Text = ""
    source: Text = ""
    units: Literal["mm", "cm", "m", "in"] = "mm"
    aperture: ApertureKeys
    fields: FieldKeys
    wavelengths: WavelengthKeys
    lens: LensKeys
    image: ImageKeys = ImageKeys()
    published: PublishedKeys | None = None
    # read by who optimizes, see `io/problem.py`
    optimize: Any = None


def checked(keys: Mapping[str, Any]) -> Prescription:
    """The keys of a file, as `tomllib` reads them, each in its place and of its type; else PrescriptionError."""
    try:
        return Prescription.model_validate(keys)
    except ValidationError as error:
        raise PrescriptionError(_explained(error)) from None


_TAGS = {"number", "table"}
_SECTIONS = {
    "aperture": ApertureKeys,
    "fields": FieldKeys,
    "wavelengths": WavelengthKeys,
    "lens": LensKeys,
    "image": ImageKeys,
    "published": PublishedKeys,
    "surfaces": RowKeys,
}


def _explained(error: ValidationError) -> str:
    """The first complaint of pydantic in one line: where, what, got, what to do."""
    # an unknown key is often the reason why another one is missing
    first = min(error.errors(include_url=False), key=lambda each: each["type"] != "extra_forbidden")
    places = [place for place in first["loc"] if place not in _TAGS]
    words: list[str] = []
    for place in places:
        if not isinstance(place, int):
            words.append(str(place))
        elif words[-1:] == ["surfaces"]:
            words = [f"surface {place + 1}"]
        else:
            words.append(f"value {place + 1}")
    key = words.pop() if words else "file"
    prefix = "".join(f"{word}: " for word in words)
    if first["type"] == "extra_forbidden":
        keys = [field.alias or name for name, field in _keys_at(places[:-1]).model_fields.items()]
        near = difflib.get_close_matches(str(key), keys, 1, 0.5)
        advice = f"did you mean {near[0]!r}?" if near else f"known here: {', '.join(keys)}"
        return f"{prefix}unknown key {key!r}; {advice}"
    if first["type"] == "missing":
        return f"{prefix}{key} is missing; it must be given"
    message = first["msg"][0].lower() + first["msg"][1:]
    return f"{prefix}{key}: {message}, got {first['input']!r}"


def _keys_at(places: Sequence[Any]) -> type[BaseModel]:
    """The section of the grammar that stands at a place in the file."""
    screens = {"screen": ScreenOfRow, "grating": GratingKeys, "zernike": ZernikeKeys, "grid": GridKeys}
    models = {**_SECTIONS, **screens, "index": IndexTable, "object_index": IndexTable, "abbe": AbbeKeys}
    names = [str(place) for place in places if not isinstance(place, int)]
    if not names:
        return Prescription
    return ApertureOfRow if names[-1] == "aperture" and "surfaces" in names else models[names[-1]]
