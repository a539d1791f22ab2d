"""What every command prints alike: JSON, numbers in columns, and the common arguments."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table


def add_common(parser: argparse.ArgumentParser) -> None:
    """The arguments every command has: the design and --json."""
    parser.add_argument("design", metavar="DESIGN", help="a prescription in TOML, such as designs/double_gauss.toml")
    parser.add_argument("--json", action="store_true", help="print one JSON object, numbers in full precision")


def print_json(value: dict[str, Any] | list[Any]) -> None:
    """One JSON object, or a list of them, on standard output; numbers that are not finite are null."""
    print(json.dumps(plain(value), allow_nan=False))


def plain(value: Any) -> Any:
    """Python numbers, lists and dicts out of arrays; None for what is not finite."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, (str, bool, int)) or value is None:
        return value
    array = np.asarray(value)
    if array.ndim:
        return [plain(item) for item in array.tolist()]
    number = array.item()
    return None if isinstance(number, float) and not math.isfinite(number) else number


def number_text(value: Any, digits: int = 6) -> str:
    """A number for a person: fixed digits after the point, or powers of ten where those would hide it."""
    if value is None:
        return "-"
    number = float(value)
    if not math.isfinite(number):
        return "infinity" if math.isinf(number) else "-"
    if number != 0 and (abs(number) < 10.0 ** (2 - digits) or abs(number) >= 1e7):
        return f"{number:.{digits}g}"
    text = f"{number:.{digits}f}"
    return text.removeprefix("-") if float(text) == 0 else text


def print_notes(notes: Sequence[str]) -> None:
    """What limits the accuracy of what was printed."""
    for note in notes:
        print(f"note: {note}")


def print_table(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """A table, labels to the left, numbers to the right, as wide as it needs to be."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), show_header=any(columns))
    for place, column in enumerate(columns):
        table.add_column(column, justify="right" if place or column else "left", no_wrap=True)
    for row in rows:
        table.add_row(*row)
    print(title)
    # wider than any terminal: a line that wraps is read more easily than a number that is cut
    Console(highlight=False, markup=False, width=400).print(table, crop=False)
    print()
