"""`lenstrace fans DESIGN`: transverse aberration and optical path difference across the pupil."""

from __future__ import annotations

import argparse
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.conditions import image_is_far
from lenstrace.analysis.fans import POINTS, Fan, Fans, fans
from lenstrace.analysis.path_difference import REFERENCES
from lenstrace.cli.design import add_design, load_design
from lenstrace.cli.output import number_text, print_json, print_table
from lenstrace.cli.spots import field_text
from lenstrace.plotting.fans import fans_figure, unit_of
from lenstrace.plotting.files import save_figure
from lenstrace.sequential.lens import Lens

# Points of the pupil that the tables show: those of a fan that lie nearest.
SHOWN = (-1.0, -0.7, 0.0, 0.7, 1.0)
# Path differences below this, in waves, and aberrations below this, in mm or radians, are rounding.
ROUNDING = 1e-12


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("fans", help="ray fans: transverse aberration and path difference across the pupil")
    add_design(parser)
    parser.add_argument("--points", type=int, default=POINTS, help=f"of each fan, an odd number ({POINTS})")
    parser.add_argument(
        "--reference",
        choices=REFERENCES,
        default="primary",
        help="the image point that rays are compared with (primary)",
    )
    parser.add_argument("--plot", metavar="FILE", help="write the fans (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the ray fans of a design."""
    lens = load_design(arguments)
    result = jax.device_get(fans(lens, points=arguments.points, reference=arguments.reference))
    if arguments.plot:
        save_figure(fans_figure(result, lens), arguments.plot)
    if arguments.json:
        print_json(fans_keys(lens, result, arguments.reference))
        return
    print(f"{lens.name or arguments.design}: ray fans, reference {arguments.reference}", end="\n\n")
    places = _places(result.pupil)
    unit, scale = unit_of([result.tangential.y, result.sagittal.x], angles=image_is_far(lens))
    names = ("Tangential fan", "ey", "py"), ("Sagittal fan", "ex", "px")
    values = result.tangential.y, result.sagittal.x
    for (title, symbol, pupil), across, fan in zip(names, values, (result.tangential, result.sagittal), strict=True):
        _print(lens, result.pupil[places], f"{title}: {symbol}, {unit}", pupil, across[..., places] * scale, scale)
        _print(lens, result.pupil[places], f"{title}: path difference, waves", pupil, fan.opd[..., places], 1.0)
    lost = [int(np.isnan(fan.opd).sum()) for fan in (result.tangential, result.sagittal)]
    if any(lost):
        print(f"lost: {lost[0]} tangential and {lost[1]} sagittal rays of {result.tangential.opd.size} each")
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def fans_keys(lens: Lens, result: Fans, reference: str) -> dict[str, Any]:
    """The object that --json prints; aberrations in mm, of an afocal lens in radians, path differences in waves."""
    far = image_is_far(lens)
    return {
        "reference": reference,
        "unit": "rad" if far else "mm",
        "pupil": result.pupil,
        "fans": [
            {
                "field": [lens.fields.x[f], lens.fields.y[f]],
                "wavelength_um": um,
                "tangential": _fan_keys(result.tangential, f, w),
                "sagittal": _fan_keys(result.sagittal, f, w),
            }
            for f in range(len(lens.fields.y))
            for w, um in enumerate(lens.wavelengths.um)
        ],
    }


def _fan_keys(fan: Fan, field: int, wavelength: int) -> dict[str, Any]:
    return {name: getattr(fan, name)[field, wavelength] for name in ("x", "y", "opd")}


def _places(pupil: np.ndarray) -> list[int]:
    """Of the points that are shown, each once."""
    return list(dict.fromkeys(int(np.argmin(np.abs(pupil - point))) for point in SHOWN))


def _print(lens: Lens, points: np.ndarray, title: str, pupil: str, values: np.ndarray, scale: float) -> None:
    """A table of values (F, W, points)."""
    columns = [f"field, {lens.fields.unit}", "um", *(f"{pupil} {point:g}" for point in points)]
    rows = [
        [
            field_text(lens, f),
            f"{um:g}",
            *(number_text(0.0 if abs(value) < ROUNDING * scale else value) for value in values[f, w]),
        ]
        for f in range(len(lens.fields.y))
        for w, um in enumerate(lens.wavelengths.um)
    ]
    print_table(title, columns, rows)
