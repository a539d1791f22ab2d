"""`lenstrace optimize DESIGN -o OUT.toml`: the lens that the section [optimize] of a design asks for."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console

from lenstrace.analysis.layout import layout
from lenstrace.cli.output import add_common, number_text, print_json, print_table
from lenstrace.cli.progress import progress
from lenstrace.design.optimize import optimize, optimize_from
from lenstrace.design.outcome import Minima, Optimized
from lenstrace.design.search import METHODS, Step
from lenstrace.errors import DesignError
from lenstrace.io.problem import load_problem, save_problem
from lenstrace.plotting.files import check_folder, check_target, save_figure
from lenstrace.plotting.optimize import optimize_figure


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("optimize", help="change the lens until what its [optimize] wants is best met")
    add_common(parser)
    parser.add_argument("-o", "--output", metavar="OUT", help="write the better lens, a prescription in TOML")
    parser.add_argument(
        "--plot", metavar="FILE", help="write the course, and the lens before and after (png, pdf, svg)"
    )
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--method", choices=METHODS, default=METHODS[0], help=f"of the search ({METHODS[0]})")
    how.add_argument("--starts", type=int, metavar="N", help="search from N random starts; the best lens is written")
    parser.add_argument(
        "--seconds", type=float, metavar="S", help="the best lens found in so many seconds; of --starts the best ends"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Optimize a design, and print every want before and after."""
    if arguments.plot:
        check_target(arguments.plot)
    if arguments.output:
        check_folder(arguments.output)
    problem = load_problem(arguments.design)
    minima = None
    if arguments.starts is None:
        with course() as report:
            found = optimize(problem, method=arguments.method, seconds=arguments.seconds, progress=report)
    else:
        with progress("searches") as count:
            minima = optimize_from(problem, arguments.starts, seconds=arguments.seconds, progress=count)
        if not minima.lenses and minima.interrupted:
            raise KeyboardInterrupt
        if not minima.lenses:
            raise DesignError("none of the searches came to a lens; give more starts, more seconds, or other bounds")
        found = minima[0]
    if arguments.output:
        save_problem(found.lens, arguments.design, arguments.output)
    if arguments.plot:
        drawings = layout(problem.lens), layout(found.lens)
        save_figure(optimize_figure(found, *drawings, problem.lens.name or arguments.design), arguments.plot)
    if arguments.json:
        print_json(outcome_keys(found) | ({} if minima is None else minima_keys(minima)))
    else:
        if minima is not None:
            _print_minima(minima)
        _print(found, problem.lens.name or arguments.design)
        for written in filter(None, (arguments.output, arguments.plot)):
            print(f"wrote {written}")
    if found.interrupted or (minima is not None and minima.interrupted):
        raise KeyboardInterrupt  # what was found by then has been printed and written


@contextmanager
def course() -> Iterator[Callable[[int, Step], None]]:
    """A function to call with each step; where there is a terminal a line shows them, and that programs are compiled
    before the first."""
    console = Console(stderr=True)
    with console.status("compiling") as status:

        def report(number: int, step: Step) -> None:
            status.update(f"step {number}, merit {step.best:.6g}, numbers moved by {step.change:.1e} of themselves")

        yield report


def outcome_keys(found: Optimized) -> dict[str, Any]:
    """The object that --json prints; merits are sums of squares of weighted residuals."""
    return {
        "merit_before": found.merit_before,
        "merit_after": found.merit_after,
        "improved": found.improved,
        "arrived": found.arrived,
        "message": found.message,
        "lost_rays": found.lost,
        "seconds": found.seconds,
        "compile_seconds": found.compile_seconds,
        "steps": found.steps,
        "wants": [
            {
                "want": term.want,
                "unit": term.unit,
                "target": term.target,
                "aim": term.aim,
                "before": term.before,
                "after": term.after,
                "merit_before": term.merit_before,
                "merit_after": term.merit_after,
            }
            for term in found.terms
        ],
        "variables": [
            {
                "variable": change.name,
                "unit": change.unit,
                "before": change.before,
                "after": change.after,
                "at_bound": change.at_bound or None,
            }
            for change in found.changes
        ],
    }


def minima_keys(minima: Minima) -> dict[str, Any]:
    """What --json adds for --starts; `minima` are the merits of the distinct ones."""
    merits = [each.merit_after for each in minima]
    return {"starts": minima.starts, "ended": minima.ended, "distinct": minima.distinct, "minima": merits}


def _print_minima(minima: Minima) -> None:
    ended = f"{minima.ended} of {minima.starts} searches ended, in {minima.seconds:.1f} s"
    print(f"{ended}; of the ends that were refined {minima.distinct} are distinct\n\n{minima.table()}\n")


def _print(found: Optimized, name: str) -> None:
    rows = [
        [
            _with_unit(term.want, term.unit),
            term.aim,
            number_text(term.before),
            number_text(term.after),
            f"{term.merit_before:.3e}",
            f"{term.merit_after:.3e}",
        ]
        for term in found.terms
    ]
    rows.append(["all", "", "", "", f"{found.merit_before:.7e}", f"{found.merit_after:.7e}"])
    print_table(f"{name}: wants", ["", "aim", "before", "after", "merit before", "merit after"], rows)
    columns = ["", "before", "after", "at its bound"]
    rows = [
        [_with_unit(each.name, each.unit), number_text(each.before, 9), number_text(each.after, 9), each.at_bound]
        for each in found.changes
    ]
    print_table("Numbers that may vary", columns, rows)
    effort = f"{found.steps} evaluations in {found.seconds:.2f} s, after {found.compile_seconds:.1f} s of compiling"
    print(f"{found.message}; {effort}")


def _with_unit(name: str, unit: str) -> str:
    return f"{name}, {unit}" if unit else name
