"""`lenstrace sensitivity DESIGN`: which error of construction hurts most."""

from __future__ import annotations

import argparse
import dataclasses
from typing import Any

from lenstrace.cli.output import add_common, print_json
from lenstrace.design.sensitivities import Tolerances
from lenstrace.design.sensitivity import sensitivity
from lenstrace.io.native import load


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("sensitivity", help="what errors of radii, gaps, tilts and glasses do to the results")
    add_common(parser)
    units = {"radius": "a part", "tilt": "degrees", "index": "1", "abbe": "a part"}
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
    focus = "refocused for each error" if found.refocused else "the image surface stays"
    print(f"{lens.name or arguments.design}: changes by errors of construction, {focus}\n\n{found.table()}\n")
    print("spots: RMS, all wavelengths; the worse sign of each error. All together: independent errors, each as large")
    print("as its tolerance on average; changes of focal lengths, and spots that are to be expected.")
