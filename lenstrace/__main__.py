"""The command `lenstrace`."""

from __future__ import annotations

import argparse
import gc
import importlib
import sys
import warnings
from collections.abc import Sequence
from typing import NoReturn

import jax

from lenstrace import __version__
from lenstrace.cli.cache import keep_compiled_programs
from lenstrace.errors import AccuracyWarning, LensTraceError

COMMANDS = (
    *("report", "spots", "trace", "draw", "seidel", "fans", "field", "wavefront", "psf", "mtf", "focus", "sheet"),
    *("trade", "optimize", "sensitivity", "render", "demo"),
)
USAGE_ERROR, INTERRUPTED = 2, 130
# Of new objects, after which Python looks for rubbish: a command makes much that lasts and little that does not,
# and looking each 700 costs a tenth of its time.
NEW_OBJECTS = 50_000


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; 0, 2 after one line on standard error that says what is wrong, or 130 after Ctrl-C."""
    parser = _OneLineParser(
        prog="lenstrace",
        description="Trace lenses: first-order figures, rays, spots, aberrations, wavefronts, diffraction, drawings, "
        "optimization, pictures of scenes, demonstrations.",
    )
    parser.add_argument("--version", action="version", version=f"lenstrace {__version__}")
    if arguments is None:
        # a program of its own, not a call from Python; where its lines stand need not be told to the compiler
        gc.set_threshold(NEW_OBJECTS)
        jax.config.update("jax_traceback_in_locations_limit", 0)
    try:
        return _run(parser, arguments)
    except LensTraceError as error:
        print(f"lenstrace: {' '.join(str(error).split())}", file=sys.stderr)
        return USAGE_ERROR
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except KeyboardInterrupt:
        print("lenstrace: interrupted", file=sys.stderr)
        return INTERRUPTED


def _run(parser: argparse.ArgumentParser, arguments: Sequence[str] | None) -> int:
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    words = [_as_value(each) for each in (sys.argv[1:] if arguments is None else arguments)]
    # only the command that is asked for is imported; all of them where it is their list that is asked for
    for name in [word for word in words[:1] if word in COMMANDS] or COMMANDS:
        importlib.import_module(f"lenstrace.cli.{name}").add_parser(commands)
    parsed = parser.parse_args(words)
    keep_compiled_programs()
    with warnings.catch_warnings():
        # commands print them, as notes
        warnings.simplefilter("ignore", AccuracyWarning)
        parsed.run(parsed)
    return 0


class _OneLineParser(argparse.ArgumentParser):
    """Says what is wrong with the arguments in one line."""

    def error(self, message: str) -> NoReturn:
        """Exit with status 2."""
        self.exit(USAGE_ERROR, f"{self.prog}: {message}; see {self.prog} --help\n")


def _as_value(argument: str) -> str:
    """A negative number as argparse takes it: -1e-5 looks like an option to it, a word with a space does not."""
    try:
        return f" {argument}" if float(argument) < 0 else argument
    except ValueError:
        return argument


if __name__ == "__main__":
    sys.exit(main())
