"""`lenstrace draw DESIGN -o FILE`: the layout of a lens as a picture."""

from __future__ import annotations

import argparse
from typing import Any

from lenstrace.analysis.layout import layout
from lenstrace.cli.output import add_common, print_json
from lenstrace.io.native import load
from lenstrace.plotting.files import save_figure
from lenstrace.plotting.layout import layout_figure


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("draw", help="draw the lens and its rays in the y-z plane")
    add_common(parser)
    parser.add_argument("-o", "--output", metavar="FILE", required=True, help="the picture to write (png, pdf or svg)")
    parser.add_argument("--rays", metavar="N", type=int, default=5, help="rays of each field, across the pupil (5)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Write the drawing of a design."""
    drawing = layout(load(arguments.design), rays_per_field=arguments.rays)
    save_figure(layout_figure(drawing), arguments.output)
    rays = sum(len(bundle.rays) for bundle in drawing.bundles)
    if arguments.json:
        print_json({"file": arguments.output, "fields": len(drawing.bundles), "rays": rays})
        return
    print(f"wrote {arguments.output}: {rays} rays of {len(drawing.bundles)} fields")
