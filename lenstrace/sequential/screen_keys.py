"""From the keys of a phase screen, as a file has them, to the screen, and back; lengths in mm."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import jax
import numpy as np

from lenstrace.errors import LensTraceError, PrescriptionError
from lenstrace.optics.screens.grating import Grating
from lenstrace.optics.screens.grid import GridScreen
from lenstrace.optics.screens.lenses import IdealLens, QuadraticLens
from lenstrace.optics.screens.point_mass import PointMass
from lenstrace.optics.screens.screen import Screen
from lenstrace.optics.screens.zernike import ZernikeScreen
from lenstrace.optics.zernike import zernike_index
from lenstrace.sequential.numbers_given import number, several

EXAMPLES = {
    "grating": '{"period": 0.002, "order": 1, "angle": 90}',
    "zernike": '{"radius": 10, "order": "noll", "terms": {4: 1e-4}}',
    "grid": '{"half_width": [5, 5], "path": [[...], ...]}',
}
KINDS = ("ideal_lens", "quadratic_lens", "point_mass", *EXAMPLES)


def screen_of(keys: Any) -> Screen:
    """The screen that one key names; a screen as it is. PrescriptionError for anything else."""
    if isinstance(keys, Screen):
        return keys
    if not isinstance(keys, Mapping):
        raise PrescriptionError(f'screen takes a mapping of one key, such as {{"ideal_lens": 100}}, got {keys!r}')
    if len(keys) != 1 or not set(keys) <= set(KINDS):
        raise PrescriptionError(f"screen takes one of {', '.join(KINDS)}, got {', '.join(map(str, keys)) or 'none'}")
    ((kind, value),) = keys.items()
    match kind:
        case "ideal_lens":
            return IdealLens(_number(value, kind))
        case "quadratic_lens":
            return QuadraticLens(_number(value, kind))
        case "point_mass":
            return PointMass(_number(value, kind))
    if not isinstance(value, Mapping):
        raise PrescriptionError(f"screen {kind} takes several keys, such as {EXAMPLES[kind]}, got {value!r}")
    match kind:
        case "grating":
            return _grating(value)
        case "zernike":
            return _zernike(value)
        case _:
            return _grid(value)


def keys_of(screen: Screen) -> dict[str, Any]:
    """The keys of a screen, as `screen_of` takes them, plain numbers."""
    match screen:
        case IdealLens():
            return {"ideal_lens": float(screen.focal_length)}
        case QuadraticLens():
            return {"quadratic_lens": float(screen.focal_length)}
        case PointMass():
            return {"point_mass": float(screen.schwarzschild_radius)}
        case Grating():
            numbers = {name: float(getattr(screen, name)) for name in ("period", "order", "angle")}
            return {"grating": numbers}
        case ZernikeScreen():
            terms = zip(map(str, screen.numbers), map(float, screen.coefficients), strict=True)
            return {"zernike": {"radius": float(screen.radius), "order": screen.order, "terms": dict(terms)}}
        case GridScreen():
            path = np.asarray(screen.values, float).tolist()
            return {"grid": {"half_width": [float(w) for w in screen.half_width], "path": path}}
    raise PrescriptionError(f"the screen {screen.label} has no keys in a file")


def _grating(keys: Mapping[str, Any]) -> Grating:
    _known(keys, "grating", ("period",), ("order", "angle"))
    return Grating(**{name: _number(value, f"grating {name}") for name, value in keys.items()})


def _zernike(keys: Mapping[str, Any]) -> ZernikeScreen:
    _known(keys, "zernike", ("radius", "terms"), ("order",))
    order, given = keys.get("order", "noll"), keys["terms"]
    if not isinstance(given, Mapping) or not all(str(number).isdecimal() for number in given):
        raise PrescriptionError(
            f"screen zernike: terms are numbers and coefficients, such as {{4: 1e-4}}, got {given!r}"
        )
    terms = {int(str(number)): _number(a, f"zernike term {number}") for number, a in given.items()}
    if len(terms) < len(given):
        raise PrescriptionError(f"screen zernike: a term is given twice; the terms are {', '.join(map(str, given))}")
    numbers = tuple(sorted(terms))
    try:
        for number in numbers:
            zernike_index(order, number)
    except LensTraceError as error:
        raise PrescriptionError(f"screen zernike: {error}") from None
    radius = _number(keys["radius"], "zernike radius")
    return ZernikeScreen(tuple(terms[number] for number in numbers), radius, numbers, order)


def _grid(keys: Mapping[str, Any]) -> GridScreen:
    _known(keys, "grid", ("half_width", "path"), ())
    path = keys["path"]
    try:
        values = path if isinstance(path, jax.Array) else np.array(path, float)
    except (TypeError, ValueError):
        raise PrescriptionError("screen grid: the path must be a table of numbers, every row as long") from None
    x, y = several(keys["half_width"], 2, "screen grid: half_width")
    return GridScreen(values, (x, y))


def _known(keys: Mapping[str, Any], kind: str, needed: tuple[str, ...], others: tuple[str, ...]) -> None:
    missing = [name for name in needed if name not in keys]
    unknown = [name for name in keys if name not in (*needed, *others)]
    if missing or unknown:
        got = f"unknown {', '.join(map(str, unknown))}" if unknown else f"without {', '.join(missing)}"
        raise PrescriptionError(f"screen {kind} takes {', '.join((*needed, *others))}; got it {got}")


def _number(value: Any, what: str) -> Any:
    return number(value, f"screen {what}")
