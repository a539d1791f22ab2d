"""`lenstrace trace DESIGN --field Y --pupil PX PY --wavelength UM`: one ray, a row for each surface."""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.cli.output import add_common, number_text, print_json, print_table
from lenstrace.io.native import load
from lenstrace.optics.rays import Ray, RayStatus

NUMBERS = ("x", "y", "z", "l", "m", "n", "opl")


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("trace", help="one ray, a row for each surface")
    add_common(parser)
    parser.add_argument(
        "--field", type=float, default=0.0, metavar="Y", help="field in the file's unit, degrees or mm (0)"
    )
    parser.add_argument(
        "--field-x", type=float, default=0.0, metavar="X", help="its x, of a field out of the y-z plane (0)"
    )
    parser.add_argument(
        "--pupil", type=float, nargs=2, default=[0.0, 0.0], metavar=("PX", "PY"),
        help="point of the pupil in units of its radius (0 0, the chief ray)",
    )  # fmt: skip
    parser.add_argument("--wavelength", type=float, metavar="UM", help="micrometres (the primary wavelength)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print one ray of a design."""
    lens = load(arguments.design)
    x, y = arguments.field_x, arguments.field
    ray = trace(lens, field=(x, y), pupil=tuple(arguments.pupil), wavelength=arguments.wavelength)
    rows = ray_rows(ray)
    if arguments.json:
        print_json({"surfaces": rows})
        return
    waves = lens.wavelengths
    wavelength = waves.um[waves.primary] if arguments.wavelength is None else arguments.wavelength
    px, py = arguments.pupil
    where = f"field ({x:g}, {y:g}) {lens.fields.unit}, pupil ({px:g}, {py:g}), {wavelength:g} um"
    title = f"{lens.name or arguments.design}: {where}"
    columns = ["surface", "x, mm", "y, mm", "z, mm", "l", "m", "n", "optical path, mm", "status"]
    print_table(
        title,
        columns,
        [[str(row["surface"]), *(number_text(row[key], 9) for key in NUMBERS), row["status"]] for row in rows],
    )


def ray_rows(ray: Ray) -> list[dict[str, Any]]:
    """One entry a surface; behind the one where the ray failed there are no numbers."""
    arrays = {name: np.asarray(getattr(ray, name)) for name in NUMBERS}
    status, failed_at = np.asarray(ray.status), np.asarray(ray.surface)
    lost = {int(RayStatus.MISSED), int(RayStatus.NOT_CONVERGED)}
    rows = []
    for surface in range(len(status)):
        reason = RayStatus(int(status[surface]))
        gone = reason and (surface > failed_at[surface] or int(reason) in lost)
        numbers = {name: None if gone else array[surface] for name, array in arrays.items()}
        rows.append({"surface": surface, **numbers, "status": reason.name})
    return rows
