"""`lenstrace sensitivity DESIGN`: which error of construction hurts most."""

from __future__ import annotations

import argparse
import dataclasses
from typing import Any

from lenstrace.cli.output import add_common, number_text, print_json, print_table
from lenstrace.cli.spots import field_text
from lenstrace.design.sensitivity import Sensitivities, Tolerances, sensitivity
from lenstrace.io.native import load
from lenstrace.sequential.lens import Lens


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("sensitivity", help="what errors of radii, gaps, tilts and glasses do to the results")
    add_common(parser)
    units = {"radius": "a part", "flatness": "1/mm", "tilt": "degrees", "index": "1", "abbe": "a part"}
    for field in dataclasses.fields(Tolerances):
        said = f"error of it, {units.get(field.name, 'mm')} ({field.default:.3g})"
        parser.add_argument(f"--{field.name}", type=float, metavar="T", default=field.default, help=said)
    parser.add_argument("--no-refocus", action="store_true", help="leave the image surface where it is")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the sensitivities of a design."""
    lens = load(arguments.design)
    sizes = {field.name: getattr(arguments, field.name) for field in dataclasses.fields(Tolerances)}
    found = sensitivity(lens, Tolerances(**sizes), refocus=not arguments.no_refocus)
    if arguments.json:
        print_json(dataclasses.asdict(found))
        return
    _print(lens, found, arguments.design)


def _print(lens: Lens, found: Sensitivities, design: str) -> None:
    fields = [f"spot at {field_text(lens, f)} {lens.fields.unit}, mm" for f in range(len(lens.fields.y))]
    columns = ["", "tolerance", "focal length, mm", "back focal length, mm", *fields]
    rows = [
        [
            row.name,
            f"{row.tolerance:.4g} {row.unit}".strip(),
            *(f"{change:+.4g}" for change in (row.focal_length, row.back_focal_length)),
            *(f"+{change:.3e}" for change in row.spots),
        ]
        for row in found.rows
    ]
    rows.append(["as designed", "", *_figures(found.focal_length, found.back_focal_length, found.spots)])
    expected = found.expected_focal_length, found.expected_back_focal_length, found.expected_spots
    rows.append(["all together, expected", "", *_figures(*expected, sign="+- ")])
    focus = "refocused for each error" if found.refocused else "the image surface stays"
    print_table(f"{lens.name or design}: changes by errors of construction, {focus}", columns, rows)
    print(
        "spots: RMS, all wavelengths; the worse sign of each error. All together: independent errors, each as large as"
    )
    print("its tolerance on average; changes of focal lengths, and spots that are to be expected.")


def _figures(focal_length: float, back_focal_length: float, spots: Any, sign: str = "") -> list[str]:
    return [*(f"{sign}{number_text(a)}" for a in (focal_length, back_focal_length)), *(f"{a:.4e}" for a in spots)]
