"""`lenstrace field DESIGN`: foci, distortion, colour, illumination and angles of incidence against field."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

import numpy as np

from lenstrace.analysis.answers import answers
from lenstrace.analysis.colour import (
    AxialColour,
    LateralColour,
    LongitudinalAberration,
    axial_colour,
    lateral_colour,
    longitudinal_aberration,
)
from lenstrace.analysis.distortion import Distortion, distortion, distortion_grid
from lenstrace.analysis.field_curvature import FieldCurvature, field_curvature
from lenstrace.analysis.illumination import Illumination, IncidenceAngles, incidence_angles, relative_illumination
from lenstrace.cli.design import add_design, load_design
from lenstrace.cli.output import number_text, print_json, print_table
from lenstrace.errors import ImageError
from lenstrace.plotting.field import field_figure
from lenstrace.plotting.files import save_figure
from lenstrace.sequential.lens import Lens

Table = tuple[str, list[str], list[list[str]]]
# A curve over wavelength has this many points; a table of it shows as many as there are wavelengths.
WAVELENGTHS = 101
# Angles below this, in degrees, are rounding.
ROUNDING = 1e-9


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("field", help="field curvature, distortion, colour, illumination by field")
    parser.description = (
        "Field curvature, distortion, colour, illumination and angles of incidence against field. Illumination is the "
        "projected solid angle of the light of one object point at the image, over that on the axis: the relative "
        "illumination of an image in focus, not the flux per area of one that is out of focus."
    )
    add_design(parser)
    parser.add_argument(
        "--points",
        type=int,
        default=21,
        help="fields from 0 to the largest, and heights in the pupil; half as many for illumination and angles (21)",
    )
    parser.add_argument("--plot", metavar="FILE", help="write the curves (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the analyses against field of a design."""
    lens = load_design(arguments)
    points, half = arguments.points, (arguments.points + 1) // 2
    asked: dict[str, Callable[[], Any]] = {
        "field_curvature": lambda: field_curvature(lens, points=points),
        "distortion": lambda: distortion(lens, points=points),
        "lateral_colour": lambda: lateral_colour(lens, points=points),
        "longitudinal_aberration": lambda: longitudinal_aberration(lens, points=points),
        "axial_colour": lambda: axial_colour(lens, points=WAVELENGTHS),
        "illumination": lambda: relative_illumination(lens, points=half),
        "incidence": lambda: incidence_angles(lens, points=half),
    }
    if arguments.plot:
        asked["grid"] = lambda: distortion_grid(lens)
    found, missing = answers(asked, ImageError)
    if arguments.plot:
        save_figure(field_figure(lens, list(found.values())), arguments.plot)
    if arguments.json:
        print_json(field_keys(lens, found, missing))
        return
    print(f"{lens.name or arguments.design}: fields from the axis to the largest\n")
    for result in found.values():
        for title, columns, rows in tables(lens, result):
            print_table(title, columns, rows)
    for line in _notes(lens, found, missing):
        print(line)
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def field_keys(lens: Lens, found: dict[str, Any], missing: dict[str, str]) -> dict[str, Any]:
    """The object that --json prints: for each result its fields, as the documentation of its class says."""
    keys = {name: dict(vars(result)) for name, result in found.items()}
    if "incidence" in keys:
        keys["incidence"]["largest"] = found["incidence"].largest
    return {"field_unit": lens.fields.unit, "wavelengths_um": list(lens.wavelengths.um), **keys, "missing": missing}


def tables(lens: Lens, result: Any) -> list[Table]:
    """Title, columns and rows of the tables of a result; none for a grid."""
    field = f"field, {lens.fields.unit}"
    waves = [f"{um:g} um" for um in lens.wavelengths.um]
    match result:
        case FieldCurvature():
            both = np.stack([result.tangential, result.sagittal], -1).reshape(len(result.field), -1)
            columns = [field, *(f"{side} {wave}" for wave in waves for side in ("T", "S"))]
            petzval = [[wave, number_text(r)] for wave, r in zip(waves, result.petzval_radius, strict=True)]
            return [
                ("Tangential (T) and sagittal (S) foci from the image surface, mm", columns, _rows(result.field, both)),
                ("Petzval radius, mm", ["", ""], petzval),
            ]
        case Distortion():
            reference, named = ("paraxial height", True) if lens.fields.kind == "angle" else ("slope x height", False)
            columns = [field, "chief height, mm", f"{reference}, mm", "distortion, %"]
            values = [result.height, result.reference, result.percent]
            if named or np.isfinite(result.f_theta_percent).any():
                columns += ["slope x theta, mm", "f theta distortion, %"]
                values += [result.f_theta_reference, result.f_theta_percent]
            return [
                (f"Distortion, {waves[lens.wavelengths.primary]}", columns, _rows(result.field, np.stack(values, -1)))
            ]
        case LateralColour() if len(waves) > 1:
            return [
                ("Lateral colour: chief heights from primary, mm", [field, *waves], _rows(result.field, result.height))
            ]
        case LongitudinalAberration():
            title = "Longitudinal aberration: axial crossings from the image surface, mm"
            return [(title, ["pupil height", *waves], _rows(result.pupil, result.z))]
        case AxialColour() if len(waves) > 1:
            rows = _rows(np.asarray(lens.wavelengths.um), np.stack([result.focus, result.shift], -1))
            return [("Axial colour: paraxial foci, mm", ["um", "from image surface", "from primary"], rows)]
        case Illumination():
            columns = [field, "part of the pupil", "solid angle, sr", "over that of the axis"]
            values = np.stack([result.fraction, result.solid_angle, result.relative], -1)
            return [
                (
                    f"Solid angle of the light of one object point at the image, {waves[lens.wavelengths.primary]}",
                    columns,
                    _rows(result.field, values),
                )
            ]
        case IncidenceAngles():
            return [_incidence(lens, result)]
        case _:
            return []


def _notes(lens: Lens, found: dict[str, Any], missing: dict[str, str]) -> list[str]:
    """What a reader should know about what is not there."""
    causes: dict[str, list[str]] = {}
    for name, why in missing.items():
        cause = why.split(" needs ")[-1]
        causes.setdefault(f"needs {cause}" if cause != why else why, []).append(name.replace("_", " "))
    notes = [f"no {', '.join(names)}: {cause}" for cause, names in causes.items()]
    if not any(map(float, (*lens.fields.x, *lens.fields.y))):
        notes.append("the lens has the field 0 alone; add fields to see what changes over them")
    if len(lens.wavelengths.um) == 1:
        notes.append("the lens has one wavelength: no colour")
    light = found.get("illumination")
    if light is not None and not np.isfinite(light.relative).any():
        why = "no ray of the axial point arrives" if not light.fraction[0] else "it needs an image at a finite distance"
        notes.append(f"no relative illumination: {why}")
    return notes


def _rows(first: Any, values: Any) -> list[list[str]]:
    """A column of plain numbers, then those of `values` (P, C); what is rounding beside the largest is 0."""
    values = np.asarray(values)
    finite = np.abs(values[np.isfinite(values)])
    floor = 1e-12 * max(1.0, float(finite.max(initial=0.0)))
    shown = np.where(np.abs(values) < floor, 0.0, values)
    return [[f"{float(each):.6g}", *map(number_text, row)] for each, row in zip(np.asarray(first), shown, strict=True)]


def _incidence(lens: Lens, result: IncidenceAngles) -> Table:
    """One row a surface; the largest angle of all with the ray it belongs to."""
    names = ("chief", "upper", "lower")
    angles = np.stack([result.chief, result.upper, result.lower])
    angles = np.where(angles < ROUNDING, 0.0, angles)
    rows = []
    for place in range(len(lens) + 1):
        here = angles[:, :, place]
        worst = "-"
        if np.isfinite(here).any():
            ray, field = np.unravel_index(np.nanargmax(here), here.shape)
            worst = f"{names[ray]}, field {result.field[field]:.6g}"
        shown = (here[1, 0], *here[:, -1], float(result.largest[place]))
        number = str(place + 1) if place < len(lens) else "image"
        rows.append([number, *(number_text(each, 4) for each in shown), worst])
    edge = f"{result.field[-1]:.6g} {lens.fields.unit}"
    columns = ["surface", "marginal, axis", *(f"{name}, {edge}" for name in names), "largest", "of the ray"]
    return f"Angles of incidence, deg, {lens.wavelengths.um[lens.wavelengths.primary]:g} um", columns, rows
