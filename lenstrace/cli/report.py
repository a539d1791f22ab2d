"""`lenstrace report DESIGN`: first-order figures, the Newtonian check and spot sizes of a lens."""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

from lenstrace.analysis.cardinal import Overview, first_order, overview
from lenstrace.analysis.layout import layout
from lenstrace.analysis.newton import NewtonCheck, newton_check
from lenstrace.analysis.published import published_figures
from lenstrace.analysis.spot_figures import Spots
from lenstrace.analysis.spots import spots
from lenstrace.cli.output import add_common, number_text, print_json, print_table
from lenstrace.cli.spots import polychromatic_rows
from lenstrace.errors import ImageError, LostRaysError
from lenstrace.io.native import load
from lenstrace.plotting.files import save_figure
from lenstrace.plotting.report import figure_of
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.paraxial import FirstOrder

FIGURES = (
    ("focal_length", "focal length f'", "mm"),
    ("object_focal_length", "object focal length f", "mm"),
    ("power", "power", "1/mm"),
    ("back_focal_length", "back focal length", "mm"),
    ("front_focal_length", "front focal length", "mm"),
    ("front_principal_plane", "principal plane H", "mm"),
    ("rear_principal_plane", "principal plane H'", "mm"),
    ("front_focal_point", "focal point F", "mm"),
    ("rear_focal_point", "focal point F'", "mm"),
    ("front_nodal_point", "nodal point N", "mm"),
    ("rear_nodal_point", "nodal point N'", "mm"),
)


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("report", help="first-order figures, Newton's equation and spot sizes")
    add_common(parser)
    parser.add_argument("--plot", metavar="FILE", help="write layout and spot diagram (png, pdf or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the report of a design."""
    lens = load(arguments.design)
    points, whole = first_order(lens), overview(lens)
    try:
        newton = newton_check(lens)
    except ImageError:
        newton = None
    sizes, no_spots = None, ""
    if arguments.plot or not arguments.json:
        try:
            sizes = spots(lens)
        except (ImageError, LostRaysError) as error:
            no_spots = str(error)
    if arguments.plot:
        save_figure(figure_of(lens, layout(lens), sizes), arguments.plot)
    if arguments.json:
        print_json(report_keys(lens, points, whole, newton))
        return
    print(lens, end="\n\n")
    _print_first_order(lens, points)
    _print_overview(lens, whole)
    if any(row.is_posed for row in lens):
        print("Tilts and decentres do not count in these figures; real rays see them.\n")
    _print_published(lens)
    _print_newton(newton)
    _print_spots(lens, sizes, no_spots)
    if arguments.plot:
        print(f"wrote {arguments.plot}")


def report_keys(lens: Lens, points: FirstOrder, whole: Overview, newton: NewtonCheck | None) -> dict[str, Any]:
    """The object that --json prints."""
    waves = lens.wavelengths
    return {
        "name": lens.name,
        "primary_um": waves.um[waves.primary],
        "wavelengths_um": list(waves.um),
        "first_order": [
            {"wavelength_um": um} | {key: getattr(points, key)[i] for key, _, _ in FIGURES}
            for i, um in enumerate(waves.um)
        ],
        "magnification": whole.magnification,
        "f_number": whole.f_number,
        "entrance_pupil": _pupil_keys(whole.entrance_pupil),
        "exit_pupil": _pupil_keys(whole.exit_pupil),
        "total_track": whole.total_track,
        "newton": [] if newton is None else _newton_rows(newton),
    }


def _pupil_keys(pupil: Any) -> dict[str, Any]:
    return {"position": pupil.position, "diameter": pupil.diameter}


def _newton_rows(newton: NewtonCheck) -> list[dict[str, Any]]:
    """One entry for the paraxial ray of each conjugate, one for each real ray, whose height and slope stand with it."""

    def row(kind: str, conjugate: int, x_image: Any, residual: Any) -> dict[str, Any]:
        x_object = newton.x_object[conjugate]
        return {
            "kind": kind,
            "magnification": newton.magnification[conjugate],
            "x_object": x_object,
            "x_image": x_image,
            "product": x_object * x_image,
            "expected": newton.expected,
            "residual": residual,
        }

    rows = []
    for i, slope in enumerate(np.asarray(newton.slope)):
        rows.append(row("paraxial", i, newton.x_image[i], newton.residual[i]))
        for j, height in enumerate(np.asarray(newton.heights)):
            real = row("real", i, newton.real_x_image[j, i], newton.real_residual[j, i])
            rows.append(real | {"height": height, "slope": slope})
    return rows


def _print_first_order(lens: Lens, points: FirstOrder) -> None:
    rows = [
        [f"{label}, {unit}", *(number_text(value, 9) for value in np.asarray(getattr(points, key)))]
        for key, label, unit in FIGURES
    ]
    waves = [f"{um:g} um" for um in lens.wavelengths.um]
    print_table("First order (H, F, N from the first vertex; H', F', N' from the last that bends)", ["", *waves], rows)


def _print_overview(lens: Lens, whole: Overview) -> None:
    rows = [
        ["F-number", number_text(whole.f_number)],
        ["entrance pupil, mm from the first vertex", number_text(whole.entrance_pupil.position)],
        ["entrance pupil diameter, mm", number_text(whole.entrance_pupil.diameter)],
        ["exit pupil, mm from the image surface", number_text(whole.exit_pupil.position)],
        ["exit pupil diameter, mm", number_text(whole.exit_pupil.diameter)],
        ["total track, mm", number_text(whole.total_track)],
    ]
    if whole.magnification is not None:
        rows.insert(1, ["magnification", number_text(whole.magnification)])
    primary = lens.wavelengths.um[lens.wavelengths.primary]
    print_table(f"At the primary wavelength, {primary:g} um", ["", ""], rows)


def _print_published(lens: Lens) -> None:
    figures = published_figures(lens)
    if figures:
        rows = [
            [
                each.name.replace("_", " "),
                number_text(each.published),
                number_text(each.computed),
                "yes" if each.agrees else "NO",
            ]
            for each in figures
        ]
        tolerance = dict(lens.published)["tolerance"]
        title = f"As published, lengths in mm; agreement to {tolerance:.0e} of the figure"
        print_table(title, ["", "published", "computed", "agrees"], rows)


def _print_newton(newton: NewtonCheck | None) -> None:
    if newton is None:
        print("Newton's equation: no focal points, the lens is afocal (power 0)\n")
        return
    heights = [f"real ray, h = {float(height):.3g} mm" for height in np.asarray(newton.heights)]
    rows = [
        [
            f"{float(newton.magnification[i]):g}",
            number_text(newton.x_object[i]),
            number_text(newton.x_image[i]),
            f"{float(newton.residual[i]):.1e}",
            *(f"{float(value):.1e}" for value in np.asarray(newton.real_residual[:, i])),
            f"{float(newton.slope[i]):.3f}",
        ]
        for i in range(newton.magnification.shape[0])
    ]
    columns = ["magnification", "X, mm", "X', mm", "paraxial", *heights, "slope"]
    title = f"Newton's equation X X' = f f' = {number_text(newton.expected)} mm^2: relative residuals"
    print_table(f"{title}; the slope d log residual / d log h tends to 2", columns, rows)


def _print_spots(lens: Lens, result: Spots | None, reason: str) -> None:
    if result is None:
        print(f"Spots: {reason}")
        return
    title = f"Spots, hexapolar, {result.rays} rays for each field and wavelength, all wavelengths pooled"
    print_table(title, *polychromatic_rows(lens, result))
