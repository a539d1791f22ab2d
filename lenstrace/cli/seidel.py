"""`lenstrace seidel DESIGN`: third-order aberrations, surface by surface."""

from __future__ import annotations

import argparse
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.aberrations import seidel
from lenstrace.analysis.third_order import Seidel, Sums
from lenstrace.cli.output import add_common, number_text, print_json, print_table
from lenstrace.io.native import load
from lenstrace.plotting.aberrations import seidel_figure
from lenstrace.plotting.files import save_figure
from lenstrace.sequential.lens import Lens

SYMBOLS = {
    "spherical": "S_I",
    "coma": "S_II",
    "astigmatism": "S_III",
    "petzval": "S_IV",
    "distortion": "S_V",
    "axial_colour": "C_I",
    "lateral_colour": "C_II",
}
DIGITS = 9
# Smaller parts of the largest of them are rounding.
ROUNDING = 1e-13


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("seidel", help="third-order aberrations of every surface and of the lens")
    add_common(parser)
    parser.add_argument("--field", type=float, help="distance from the axis, in the unit of the fields (the largest)")
    parser.add_argument("--plot", metavar="FILE", help="write a bar chart of the Seidel sums (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the third-order aberrations of a design."""
    lens = load(arguments.design)
    result = jax.device_get(seidel(lens, field=arguments.field))
    if arguments.plot:
        save_figure(seidel_figure(result, lens.name), arguments.plot)
    if arguments.json:
        print_json(seidel_keys(lens, result))
        return
    print(_conditions(lens, result), end="\n\n")
    columns = ["surface", *(f"{symbol}, mm" for symbol in SYMBOLS.values())]
    rows = [[str(number), *row] for number, row in enumerate(_rows(result.surfaces), 1)]
    print_table("Seidel sums (Welford)", columns, [*rows, ["total", *_rows(result.total)[0]]])
    aspheric = [[str(number), *row] for number, row in enumerate(_rows(result.aspheric_part), 1) if _counts(row)]
    if aspheric:
        print_table("Of them conics and asphere terms", columns[:6], [row[:6] for row in aspheric])
    _print_figures(result)
    if any(row.is_posed for row in lens):
        print("Tilts and decentres do not count in these figures; real rays see them.")
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def seidel_keys(lens: Lens, result: Seidel) -> dict[str, Any]:
    """The object that --json prints; lengths in mm, `waves` in primary wavelengths."""
    waves = lens.wavelengths
    parts = {"spherical_part": result.spherical_part, "aspheric_part": result.aspheric_part}
    return {
        "name": lens.name,
        "primary_um": waves.um[waves.primary],
        "colour_um": [min(waves.um), max(waves.um)],
        "field": _field(lens, result),
        "surfaces": [
            {"surface": i + 1}
            | _symbols(result.surfaces, i)
            | {name: _symbols(part, i) for name, part in parts.items()}
            | {"marginal_height": result.marginal_height[i], "chief_height": result.chief_height[i]}
            for i in range(len(lens))
        ],
        "total": {symbol: getattr(result.total, name) for name, symbol in SYMBOLS.items()},
        "transverse": result.transverse()._asdict(),
        "longitudinal": result.longitudinal()._asdict(),
        "waves": result.waves()._asdict(),
        "lagrange_invariant": result.lagrange_invariant,
        "petzval_radius": result.petzval_radius,
    }


def _symbols(sums: Sums, surface: int) -> dict[str, Any]:
    return {symbol: getattr(sums, name)[surface] for name, symbol in SYMBOLS.items()}


def _field(lens: Lens, result: Seidel) -> float:
    """In the unit of the lens's fields."""
    return float(result.field) / lens.fields.scale


def _conditions(lens: Lens, result: Seidel) -> str:
    waves = lens.wavelengths
    ends = f"; colour from {min(waves.um):g} to {max(waves.um):g} um" if len(waves.um) > 1 else ""
    where = f"{waves.um[waves.primary]:g} um, full aperture, field {_field(lens, result):g} {lens.fields.unit}"
    return f"{lens.name or 'Lens'}: third-order aberrations at {where}{ends}"


def _rows(sums: Sums) -> list[list[str]]:
    """Numbers of a table, one row for each surface."""
    values = np.array([np.atleast_1d(np.asarray(getattr(sums, name))) for name in SYMBOLS])
    floor = ROUNDING * max(1.0, float(np.abs(values).max()))
    return [[_text(value, floor) for value in row] for row in values.T]


def _text(value: Any, floor: float) -> str:
    """What is only rounding is 0 to a reader."""
    return number_text(None if value is None else 0.0 if abs(value) < floor else value, DIGITS)


def _counts(row: list[str]) -> bool:
    return any(float(text) for text in row)


def _print_figures(result: Seidel) -> None:
    """Transverse, longitudinal and wave figures, and what the Petzval surface is."""
    across, along, waves = result.transverse(), result.longitudinal(), result.waves()
    if np.isnan(result.image_slope):
        print("The image is at infinity: there are no transverse and longitudinal figures.\n")
    else:
        # an error of a sum, as large as it is on the image
        floor = ROUNDING * max(1.0, float(1 / np.abs(result.image_slope)))
        rows = [
            [name.replace("_", " "), _text(value, floor), _text(getattr(along, name, None), floor)]
            for name, value in across._asdict().items()
        ]
        print_table("At the paraxial image", ["", "transverse, mm", "longitudinal, mm"], rows)
    floor = ROUNDING / float(result.wavelength)
    print_table("Wave aberration, primary wavelengths", list(waves._fields), [[_text(each, floor) for each in waves]])
    print(f"Lagrange invariant, mm: {number_text(result.lagrange_invariant, DIGITS)}")
    print(f"Petzval radius, mm: {number_text(result.petzval_radius)}\n")
