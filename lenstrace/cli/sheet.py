"""`lenstrace sheet DESIGN -o FILE`: one page about a lens."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from lenstrace.analysis.sheet import sheet
from lenstrace.cli.design import add_design, load_design
from lenstrace.cli.output import print_json
from lenstrace.plotting.files import check_format, save_figure
from lenstrace.plotting.sheet import sheet_figure


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("sheet", help="one page about a lens, to print")
    add_design(parser)
    parser.add_argument("-o", "--output", metavar="FILE", required=True, help="the page to write (pdf, png or svg)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Write the page of a design."""
    check_format(arguments.output)
    lens = load_design(arguments)
    page = sheet(lens, _tell if sys.stderr.isatty() else None)
    save_figure(sheet_figure(page), arguments.output)
    if arguments.json:
        print_json({"file": arguments.output, "shown": list(page.found), "missing": page.missing})
        return
    for name, why in page.missing.items():
        print(f"no {name.replace('_', ' ')}: {why}")
    print(f"wrote {arguments.output}")


def _tell(name: str) -> None:
    """What is being computed, on a line that the next one overwrites."""
    print(f"\r\033[K{name.replace('_', ' ')} ...", end="" if name != "mtf" else "\r", file=sys.stderr, flush=True)
