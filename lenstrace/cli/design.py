"""The lens that a command is asked about: the design, and whether its semi-diameters stop rays."""

from __future__ import annotations

import argparse

from lenstrace.cli.output import add_common
from lenstrace.io.native import load
from lenstrace.sequential.lens import Lens


def add_design(parser: argparse.ArgumentParser) -> None:
    """The common arguments, and --clip."""
    add_common(parser)
    parser.add_argument("--clip", action="store_true", help="semi-diameters stop rays, as apertures do")


def load_design(arguments: argparse.Namespace) -> Lens:
    """The lens that the arguments of `add_design` name."""
    lens = load(arguments.design)
    return lens.replace(clip_at_semi_diameters=True) if arguments.clip else lens
