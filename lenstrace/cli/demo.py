"""`lenstrace demo [NAME [--OPTION VALUE ...]]`: phenomena as pictures, and as numbers that agree with theory."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from typing import Any

from lenstrace.cli.output import print_json, print_table
from lenstrace.cli.progress import progress
from lenstrace.errors import AccuracyError, OptionError
from lenstrace.io.native import load
from lenstrace.phenomena.catalogue import GROUPS, PLACES, find, summary
from lenstrace.phenomena.demonstration import Demonstration
from lenstrace.phenomena.options import Argument, arguments_of, takes_lens
from lenstrace.plotting.demonstration import demonstration_figure
from lenstrace.plotting.files import check_target, save_figure, save_pages

ALL = "all"
COLUMNS = ("measured", "theory", "difference", "")


def add_parser(commands: Any) -> None:
    """Register the command, with a parser of its own for every demonstration."""
    parser = commands.add_parser("demo", help="demonstrations that check themselves: list them, or run one or all")
    parser.set_defaults(run=_list)
    names = parser.add_subparsers(metavar="NAME", title="demonstrations", parser_class=type(parser))
    for name in PLACES:
        of_one = names.add_parser(name, help=summary(name), description=f"{summary(name)}.")
        function = find(name)
        if takes_lens(function):
            of_one.add_argument("design", metavar="DESIGN", nargs="?", help="a prescription in TOML (one of its own)")
        for argument in arguments_of(function):
            _add_option(of_one, argument)
        _add_output(of_one, "write the picture (png, pdf or svg)")
        of_one.set_defaults(run=_run_one, name=name)
    of_all = names.add_parser(ALL, help="run them all: one table")
    _add_output(of_all, "write all pictures, a page each (pdf)")
    of_all.set_defaults(run=_run_all)


def _add_output(parser: argparse.ArgumentParser, what: str) -> None:
    parser.add_argument("-o", "--output", metavar="FILE", help=what)
    parser.add_argument("--json", action="store_true", help="print the rows as JSON, numbers in full precision")


def _add_option(parser: argparse.ArgumentParser, argument: Argument) -> None:
    option = argument.option
    values = argument.default if argument.several else [argument.default]
    default = " ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in values)
    details = [option.unit, option.allowed, f"default {default}"]
    parser.add_argument(
        f"--{argument.name.replace('_', '-')}",
        type=argument.kind,
        nargs="+" if argument.several else None,
        metavar=argument.name.upper(),
        help=f"{option.meaning} ({'; '.join(each for each in details if each)})",
    )


def _list(_: argparse.Namespace) -> None:
    """Print the names."""
    for title, names in GROUPS.values():
        print_table(title, ["", ""], [[name, summary(name)] for name in names])
    print("lenstrace demo NAME [-o FILE] runs one; lenstrace demo NAME --help explains its options")


def _run_one(arguments: argparse.Namespace) -> None:
    if arguments.output:
        check_target(arguments.output)
    name, function = arguments.name, find(arguments.name)
    given: dict[str, Any] = {}
    for argument in arguments_of(function):
        value = getattr(arguments, argument.name)
        if value is not None:
            given[argument.name] = tuple(value) if argument.several else value
    if takes_lens(function) and arguments.design:
        given["lens"] = load(arguments.design)
    found = function(**given)
    if arguments.json:
        print_json(_keys(name, found))
    else:
        print_table(f"{name}: {found.setting}", ["", "", *COLUMNS], _lines(found))
    if arguments.output:
        save_figure(demonstration_figure(found), arguments.output)
        if not arguments.json:
            print(f"wrote {arguments.output}")
    _complain({name: found})


def _run_all(arguments: argparse.Namespace) -> None:
    if arguments.output:
        check_target(arguments.output)
        if not arguments.output.lower().endswith(".pdf"):
            raise OptionError(f"{arguments.output}: the pictures of all demonstrations make one pdf, a page each")
    found: dict[str, Demonstration] = {}
    try:
        with progress("demonstrations") as report:
            for done, name in enumerate(PLACES):
                report(done, len(PLACES))
                found[name] = find(name)()
    finally:
        # after Ctrl-C, what there is
        if arguments.json:
            print_json([_keys(*each) for each in found.items()])
        else:
            lines = [[name, *line] for name, each in found.items() for line in _lines(each)]
            print_table("Demonstrations, with the options they have by default", ["", "", "", *COLUMNS], lines)
    if arguments.output:
        save_pages((demonstration_figure(each) for each in found.values()), arguments.output)
    _complain(found)


def _keys(name: str, found: Demonstration) -> dict[str, Any]:
    """What --json prints of one."""
    rows = [
        {
            "quantity": row.quantity,
            "unit": row.unit,
            "measured": row.measured,
            "theory": row.theory,
            "difference": row.difference,
            "within": row.tolerance,
            "agrees": row.agrees,
        }
        for row in found.rows
    ]
    return {"demo": name, "rows": rows}


def _lines(found: Demonstration) -> list[list[str]]:
    return [[row.quantity, row.unit, *row.texts, "" if row.agrees else "DIFFERS"] for row in found.rows]


def _complain(found: Mapping[str, Demonstration]) -> None:
    """AccuracyError for the first quantity that does not agree with theory."""
    for name, each in found.items():
        for row in each.rows:
            if not row.agrees:
                measured, theory, difference = row.texts
                raise AccuracyError(
                    f"{name}: {row.quantity} is {measured} {row.unit}, by theory {theory}: they differ by {difference}"
                )
