"""`lenstrace trade DESIGN`: what each way to answer a question costs, and how far it is from the truth."""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

from lenstrace.accuracy.trade import Outcome
from lenstrace.analysis.extremes.judging import Extreme, extremes
from lenstrace.analysis.trade import QUANTITIES, LensTrade, trade
from lenstrace.cli.output import number_text, print_json, print_table
from lenstrace.cli.progress import progress
from lenstrace.errors import AccuracyError
from lenstrace.io.native import load
from lenstrace.plotting.files import check_target, save_figure
from lenstrace.plotting.trade import trade_figure


def add_parser(commands: Any) -> None:
    """Register the command."""
    parser = commands.add_parser("trade", help="accuracy against time under every setting; the extremes")
    parser.add_argument("design", metavar="DESIGN", nargs="?", help="a prescription in TOML")
    parser.add_argument("--quantity", choices=tuple(QUANTITIES), help="what is asked (spot)")
    parser.add_argument(
        "--field", type=float, metavar="Y", help="in the unit of the design's fields (the one farthest from the axis)"
    )
    parser.add_argument(
        "--tolerance", type=float, metavar="T", help="relative error allowed; names the fastest setting within it"
    )
    parser.add_argument("--plot", metavar="FILE", help="write error against time (png, pdf or svg)")
    parser.add_argument(
        "--extremes", action="store_true", help="instead: backward errors at the extremes, float32 and float64"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object, numbers in full precision")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the trade of a design, or the errors at the extremes."""
    if arguments.extremes:
        _run_extremes(arguments)
        return
    if arguments.design is None:
        raise AccuracyError("trade needs a DESIGN, a prescription in TOML; or --extremes")
    if arguments.plot:
        check_target(arguments.plot)
    lens = load(arguments.design)
    with progress("settings") as report:
        found = trade(
            lens, arguments.quantity or "spot", field=arguments.field, tolerance=arguments.tolerance, progress=report
        )
    title = f"{lens.name or arguments.design}: {found.described(lens.fields.unit)}"
    if arguments.plot:
        save_figure(trade_figure(found, lens.name or arguments.design, lens.fields.unit), arguments.plot)
    if arguments.json:
        print_json(trade_keys(found))
    else:
        _print(found, title)
        if arguments.plot:
            print(f"wrote {arguments.plot}")
    if not found.trade.complete:
        raise KeyboardInterrupt  # what was found by then has been printed


def _print(found: LensTrade, title: str) -> None:
    print_table(title, *_rows(found.trade.outcomes, found.unit))
    print_table("No other setting is both faster and more accurate", *_rows(found.trade.front, found.unit))
    print("\n".join(_remarks(found)))


def trade_keys(found: LensTrade) -> dict[str, Any]:
    """The object that --json prints; the field is its y, or x and y where it has an x."""
    field = None if found.field is None else found.field if found.field[0] else found.field[1]
    return {
        "quantity": found.quantity,
        "unit": found.unit,
        "field": field,
        "truth": found.trade.truth,
        "truth_error": found.truth_error,
        "tolerance": found.trade.tolerance,
        "complete": found.trade.complete,
        "settings": [_keys(each) for each in found.trade.outcomes],
        "chosen": None if found.trade.chosen is None else _keys(found.trade.chosen),
    }


def _keys(outcome: Outcome) -> dict[str, Any]:
    return {
        "setting": outcome.setting.name,
        "value": outcome.value,
        "error": outcome.error,
        "relative_error": outcome.relative_error,
        "seconds": outcome.seconds,
        "first_seconds": outcome.first_seconds,
        "rays": outcome.setting.rays,
        "pareto": outcome.pareto,
    }


def _rows(outcomes: Sequence[Outcome], unit: str) -> tuple[list[str], list[list[str]]]:
    columns = ["front", "setting", "rays", f"value, {unit}", f"error, {unit}", "relative error"]
    rows = [
        [
            "*" if each.pareto else "",
            each.setting.name,
            str(each.setting.rays),
            number_text(each.value, 9),
            f"{each.error:.1e}",
            f"{each.relative_error:.1e}",
            f"{each.seconds * 1e3:.3f}",
            f"{each.first_seconds:.2f}",
        ]
        for each in outcomes
    ]
    return [*columns, "time, ms", "compiling, s"], rows


def _remarks(found: LensTrade) -> Iterator[str]:
    """What is to be said below the table."""
    trade = found.trade
    yield f"truth: {trade.truth:.15g} {found.unit}, known to {found.truth_error:.1e} {found.unit}"
    if not trade.complete:
        yield "interrupted: not all settings were asked and timed"
    if trade.tolerance is None:
        return
    if trade.chosen is None and not trade.complete:
        yield f"no setting asked so far has a relative error of at most {trade.tolerance:g}"
        return
    if trade.chosen is None:
        yield f"no setting has a relative error of at most {trade.tolerance:g}"
        return
    chosen = trade.chosen
    within = ", or of rounding" if chosen.relative_error > trade.tolerance else ""
    yield (
        f"fastest within a relative error of {trade.tolerance:g}{within}: {chosen.setting.name}, "
        f"{chosen.seconds * 1e3:.3f} ms, relative error {chosen.relative_error:.1e}"
    )


def _run_extremes(arguments: argparse.Namespace) -> None:
    given = [
        name for name in ("design", "quantity", "field", "tolerance", "plot") if getattr(arguments, name) is not None
    ]
    if given:
        raise AccuracyError(
            f"--extremes goes with --json alone: it has lenses of its own; leave out {', '.join(given)}"
        )
    with progress("extremes") as report:
        found = extremes(lambda done, total, _: report(done, total))
    if arguments.json:
        print_json({"extremes": [dataclasses.asdict(each) for each in found]})
        return
    columns = ["extreme", "surfaces", "rays"]
    for precision in ("float32", "float64"):
        columns += [f"{precision}: C", "C a surface", "C gradient", "judged"]
    rows = [_extreme_row(each) for each in found]
    print_table("Backward errors at the extremes, in units of eps", [*columns, "statuses", "finite", "exact"], rows)
    print("C: worst |computed - true| / (eps (scale + condition number x input)) against the judge in 50 digits;")
    print(
        "a surface: divided by the surfaces crossed; gradient: the same of the derivatives of a result, of so many rays"
    )
    print("judged, all that arrive; - where none does;")
    print(
        "statuses: all as the judge's, or as of numbers moved by 16 eps; finite: results and gradients, lost rays too;"
    )
    print("exact: scaled lenses agree to the last bit, an afocal lens has power 0 and an infinite focal length")


def _extreme_row(each: Extreme) -> list[str]:
    row = [each.name, str(each.surfaces), str(each.rays)]
    both = each.float32, each.float64
    for errors in both:
        gradient = "-" if errors.gradient is None else f"{errors.gradient:.1f}"
        row += [f"{max(errors.course, errors.launch):.1f}", f"{errors.surface:.2f}", gradient, str(errors.gradients)]
    exact = "-" if each.exact is None else _yes(each.exact)
    finite = all(errors.finite and errors.gradients_finite for errors in both)
    return [*row, _yes(all(errors.statuses for errors in both)), _yes(finite), exact]


def _yes(value: bool) -> str:
    return "yes" if value else "NO"
