"""`lenstrace spots DESIGN`: spot sizes per field and wavelength."""

from __future__ import annotations

import argparse
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.spot_figures import SpotErrors, Spots, loss_text
from lenstrace.analysis.spots import spots
from lenstrace.analysis.vignetting import Vignetting, vignetting
from lenstrace.cli.design import add_design, load_design
from lenstrace.cli.output import number_text, print_json, print_table
from lenstrace.errors import RayError
from lenstrace.plotting.files import save_figure
from lenstrace.plotting.spots import spots_figure
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import PATTERNS

EDGES = ("top", "bottom", "right", "left")


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("spots", help="spot sizes per field and wavelength")
    add_design(parser)
    parser.add_argument("--rings", type=int, help="rings of the hexapolar pattern, or the density of the others (6)")
    parser.add_argument("--pattern", choices=PATTERNS, help="how the pupil is sampled (hexapolar)")
    parser.add_argument(
        "--tolerance",
        type=float,
        metavar="T",
        help="relative error of each RMS: rays are chosen by need, and errors estimated",
    )
    parser.add_argument(
        "--vignetting", action="store_true", help="find the part of the pupil that each field fills, and sample that"
    )
    parser.add_argument("--plot", metavar="FILE", help="write the spot diagram (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the spots of a design."""
    lens = load_design(arguments)
    if arguments.tolerance is not None and (arguments.vignetting or arguments.pattern or arguments.rings is not None):
        raise RayError("--tolerance chooses the rays by itself: leave out --pattern, --rings and --vignetting")
    filled = vignetting(lens) if arguments.vignetting else None
    pattern, rings = arguments.pattern or "hexapolar", 6 if arguments.rings is None else arguments.rings
    result = jax.device_get(spots(lens, pattern=pattern, rings=rings, vignetting=filled, tolerance=arguments.tolerance))
    if arguments.plot:
        save_figure(spots_figure(result, lens), arguments.plot)
    if arguments.json:
        print_json(spots_keys(lens, result) | vignetting_keys(lens, filled))
        return
    if filled is not None:
        print_table("Pupil that arrives, in units of its radius", *_vignetting_rows(lens, filled))
    how = f"{pattern} pattern" if result.error is None else f"two gaussian rules of {result.error.rings} rings"
    title = f"{lens.name or arguments.design}: {how}, {result.rays} rays for each spot"
    print_table(title, *_rows(lens, result))
    print_table("All wavelengths pooled by weight", *polychromatic_rows(lens, result))
    if result.error is not None:
        print(f"tolerance {result.error.tolerance:g}: {_reached(result.error)}")
        print("errors are estimates, against the integral over the open pupil")
    for place, text in _losses(lens, result):
        print(f"lost, {place}: {text}")
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def _reached(error: SpotErrors) -> str:
    if error.reached:
        return "reached by every spot"
    if error.rounded:
        return "NOT reached by every spot: what is left is rounding, which more rays do not lessen"
    return f"NOT reached by every spot with {error.rings} rings"


def spots_keys(lens: Lens, result: Spots) -> dict[str, Any]:
    """The object that --json prints."""
    single = [
        {
            "field": [lens.fields.x[f], lens.fields.y[f]],
            "wavelength_um": um,
            "rays": result.rays,
            "lost": result.lost[f, w],
            "losses": [
                {"surface": surface, "status": status.name, "count": count}
                for (surface, status), count in result.losses(f, w).items()
            ],
            "centroid": [result.centroid_x[f, w], result.centroid_y[f, w]],
            "chief": [result.chief_x[f, w], result.chief_y[f, w]],
            "rms_centroid": result.rms_centroid[f, w],
            "rms_chief": result.rms_chief[f, w],
            "largest": result.largest[f, w],
        }
        for f in range(len(lens.fields.y))
        for w, um in enumerate(lens.wavelengths.um)
    ]
    together = [
        {
            "field": [lens.fields.x[f], lens.fields.y[f]],
            "rms_centroid": result.polychromatic.rms_centroid[f],
            "rms_primary_chief": result.polychromatic.rms_primary_chief[f],
        }
        for f in range(len(lens.fields.y))
    ]
    if result.error is None:
        return {"spots": single, "polychromatic": together}
    waves = len(lens.wavelengths.um)
    for place, spot in enumerate(single):
        spot["rms_centroid_error"] = result.error.rms_centroid[divmod(place, waves)]
        spot["open"] = result.error.open[divmod(place, waves)]
    for f, spot in enumerate(together):
        spot["rms_centroid_error"] = result.error.polychromatic[f]
    accuracy = {name: getattr(result.error, name) for name in ("tolerance", "reached", "rounded", "rings")}
    return {"spots": single, "polychromatic": together, "accuracy": accuracy}


def vignetting_keys(lens: Lens, filled: Vignetting | None) -> dict[str, Any]:
    """What --json adds for --vignetting."""
    if filled is None:
        return {}
    return {
        "vignetting": [
            {"field": [lens.fields.x[f], lens.fields.y[f]], **{edge: getattr(filled, edge)[f] for edge in EDGES}}
            for f in range(len(lens.fields.y))
        ]
    }


def polychromatic_rows(lens: Lens, result: Spots) -> tuple[list[str], list[list[str]]]:
    """Columns and rows of the table of all wavelengths together, one row a field."""
    columns = [
        f"field, {lens.fields.unit}",
        "rays",
        "lost",
        "RMS about centroid, mm",
        "RMS about primary chief ray, mm",
    ]
    waves = len(lens.wavelengths.um)
    if result.error is not None:
        columns.append("error, mm")
    rows = [
        [
            field_text(lens, f),
            str(result.rays * waves),
            str(int(np.asarray(result.lost)[f].sum())),
            number_text(result.polychromatic.rms_centroid[f], 9),
            number_text(result.polychromatic.rms_primary_chief[f], 9),
            *([] if result.error is None else [f"{result.error.polychromatic[f]:.1e}"]),
        ]
        for f in range(len(lens.fields.y))
    ]
    return columns, rows


def field_text(lens: Lens, field: int) -> str:
    """A field as a person writes it: y, or (x, y)."""
    x, y = float(lens.fields.x[field]), float(lens.fields.y[field])
    return f"{y:g}" if not any(map(float, lens.fields.x)) else f"({x:g}, {y:g})"


def _rows(lens: Lens, result: Spots) -> tuple[list[str], list[list[str]]]:
    columns = [
        f"field, {lens.fields.unit}",
        "um",
        "rays",
        "lost",
        "centroid x, mm",
        "centroid y, mm",
        "chief x, mm",
    ]
    columns += ["chief y, mm", "RMS about centroid, mm", "RMS about chief, mm", "largest, mm"]
    if result.error is not None:
        columns += ["error of RMS, mm", "open"]
    figures = ("centroid_x", "centroid_y", "chief_x", "chief_y", "rms_centroid", "rms_chief", "largest")
    arrays = [np.asarray(getattr(result, name)) for name in figures]
    # a centroid that is 0 but for rounding is 0 to a reader
    floor = 1e-12 * max(1.0, float(np.abs(np.asarray(result.centroid_y)).max()))
    rows = [
        [
            field_text(lens, f),
            f"{um:g}",
            str(result.rays),
            str(int(result.lost[f, w])),
            *(number_text(0.0 if abs(array[f, w]) < floor else array[f, w], 9) for array in arrays),
            *_accuracy_cells(result, f, w),
        ]
        for f in range(len(lens.fields.y))
        for w, um in enumerate(lens.wavelengths.um)
    ]
    return columns, rows


def _accuracy_cells(result: Spots, field: int, wave: int) -> list[str]:
    if result.error is None:
        return []
    return [f"{result.error.rms_centroid[field, wave]:.1e}", number_text(result.error.open[field, wave])]


def _vignetting_rows(lens: Lens, filled: Vignetting) -> tuple[list[str], list[list[str]]]:
    rows = [
        [field_text(lens, f), *(number_text(getattr(filled, edge)[f]) for edge in EDGES)]
        for f in range(len(lens.fields.y))
    ]
    return [f"field, {lens.fields.unit}", *EDGES], rows


def _losses(lens: Lens, result: Spots) -> list[tuple[str, str]]:
    """Where rays were lost: place and words."""
    return [
        (f"field {field_text(lens, f)} {lens.fields.unit}, {um:g} um", loss_text(result.losses(f, w)))
        for f in range(len(lens.fields.y))
        for w, um in enumerate(lens.wavelengths.um)
        if int(result.lost[f, w])
    ]
