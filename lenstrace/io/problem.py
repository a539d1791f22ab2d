"""The section [optimize] of a prescription file: what may vary, what is tied, what is wanted.

    [optimize]
    vary = [ { kind = "curvature", surfaces = "all" }, { kind = "thickness", surfaces = [2, 4], bounds = [0.5, 10.0] } ]
    want = [ { kind = "spot_rms" }, { kind = "focal_length", target = 50.0, weight = 10.0 } ]
    tie = [ { kind = "pickup", what = "curvature", surface = 6, of = 1, scale = -1.0 } ]

A kind is the name of its class in `lenstrace.design`, in small letters; the other keys are its arguments. Lengths are
in mm.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping
from typing import Any

import tomlkit

from lenstrace import design
from lenstrace.design.problem import Problem
from lenstrace.errors import DesignError, LensTraceError
from lenstrace.io.kinds import named, near
from lenstrace.io.native import dumps, keys_in, read_with, write_whole
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens_from_keys

VARIABLES = (
    *(design.Curvature, design.Thickness, design.Conic, design.Asphere, design.Index, design.Abbe),
    *(design.Decenter, design.Tilt),
)
WANTS = (
    *(design.SpotRMS, design.WavefrontRMS, design.FocalLength, design.BackFocalLength, design.FNumber),
    *(design.Magnification, design.ParaxialHeight, design.ParaxialSlope, design.RayHeight, design.RayAngle),
    *(design.TransverseError, design.IncidenceAngle, design.Distortion, design.AxialColour, design.LateralColour),
    *(design.Petzval, design.SeidelSum, design.CentreThickness, design.EdgeThickness, design.TotalTrack),
)
TIES = (design.Pickup, design.CurvatureSolve, design.ThicknessSolve)
SECTION = {"vary": VARIABLES, "want": WANTS, "tie": TIES}
# Arguments that a want sets by itself when it is posed.
OWN = ("points", "counted", "fields", "waves", "halved")


def load_problem(path: str | os.PathLike[str]) -> Problem:
    """Read a lens and what its [optimize] says. DesignError, or another LensTraceError, says file, where, what, got."""

    def made(text: str) -> Problem:
        keys = keys_in(text)
        lens = lens_from_keys(keys)
        if "optimize" in keys and not isinstance(keys["optimize"], Mapping):
            raise DesignError("optimize must be one section, [optimize]")
        if "optimize" not in keys:
            raise DesignError("the file has no section [optimize]; write one, with vary = [...] and want = [...]")
        if keys.get("units", "mm") != "mm":
            raise DesignError(
                'optimize: its lengths are in mm; write the file with units = "mm" (`lenstrace.save` does)'
            )
        return problem_from_keys(lens, keys["optimize"])

    return read_with(path, made)


def problem_from_keys(lens: Lens, keys: Mapping[str, Any]) -> Problem:
    """The problem of a lens out of the keys of [optimize]."""
    for key in keys:
        if key not in SECTION:
            raise DesignError(f"optimize: unknown key {key!r}; {near(key, list(SECTION))}")
    said: dict[str, list[Any]] = {}
    for key, kinds in SECTION.items():
        entries = keys.get(key, [])
        if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
            raise DesignError(f"optimize: {key} must be a list of tables, such as {key} = [{{ kind = ... }}]")
        said[key] = [_made(f"optimize: {key} {i}", entry, kinds) for i, entry in enumerate(entries, 1)]
    try:
        return Problem(lens, **said)
    except LensTraceError as error:
        raise type(error)(f"optimize: {error}") from None


def save_problem(lens: Lens, problem_file: str | os.PathLike[str], path: str | os.PathLike[str]) -> None:
    """Write a lens, and the [optimize] of the file that its problem was read from. The file appears whole or not at
    all."""
    keys = read_with(problem_file, keys_in)
    document = tomlkit.parse(dumps(lens))
    document["optimize"] = _lines(keys["optimize"])
    write_whole(tomlkit.dumps(document), path)


def _made(where: str, entry: Mapping[str, Any], kinds: tuple[type, ...]) -> Any:
    """A variable, want or tie out of its keys."""
    names = named(kinds)
    name = entry.get("kind")
    if name not in names:
        raise DesignError(f"{where}: kind must be one of {', '.join(names)}; got {name!r}")
    known = {field.name: field for field in dataclasses.fields(names[name]) if field.name not in OWN}
    given = {key: value for key, value in entry.items() if key != "kind"}
    for key, value in given.items():
        if key not in known:
            raise DesignError(f"{where}, {name}: unknown key {key!r}; {near(key, list(known))}")
        _check_type(f"{where}, {name}: {key}", value, known[key].default)
        if key in ("field", "pupil") and isinstance(value, list):
            given[key] = tuple(value)
    missing = [key for key, field in known.items() if field.default is dataclasses.MISSING and key not in given]
    if missing:
        raise DesignError(f"{where}, {name}: {missing[0]} is missing; it must be given")
    return names[name](**given)


def _check_type(where: str, value: Any, default: Any) -> None:
    """DesignError for a word, a number or a flag where another of them is meant."""
    key = where.rpartition(" ")[2]
    if isinstance(default, bool):
        right, wanted = isinstance(value, bool), "true or false"
    elif (isinstance(default, str) and key not in ("surfaces",)) or key in ("what",):
        right, wanted = isinstance(value, str), "a word"
    elif key in ("surfaces", "surface", "of", "powers", "rings"):
        right, wanted = (
            _is_made_of(value, int) or (key == "surfaces" and isinstance(value, str)),
            "a surface, or several",
        )
        wanted = "a whole number" if key in ("surface", "of", "rings") else wanted
        right = right and (key in ("surfaces", "powers") or isinstance(value, int))
    else:
        right, wanted = _is_made_of(value, int | float), "a number, or a list of them"
    if not right:
        raise DesignError(f"{where} must be {wanted}, got {value!r}")


def _is_made_of(value: Any, kind: Any) -> bool:
    if isinstance(value, list):
        return bool(value) and all(_is_made_of(each, kind) for each in value)
    return isinstance(value, kind) and not isinstance(value, bool)


def _lines(keys: Mapping[str, Any]) -> Any:
    """A table whose lists have a line for each entry."""
    table = tomlkit.table()
    for key, entries in keys.items():
        lines = tomlkit.array().multiline(True)
        for entry in entries:
            inline = tomlkit.inline_table()
            inline.update(entry)
            lines.append(inline)
        table[key] = lines
    return table
