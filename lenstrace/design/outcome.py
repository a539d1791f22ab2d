"""What came out of an optimization: the lens, how it got there, and every want before and after."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

from lenstrace.design.search import Step
from lenstrace.sequential.lens import Lens


@dataclasses.dataclass(frozen=True)
class Term:
    """One term of one want, before and after.

    want, unit: its name; the unit of its values.        aim: what is wanted, in words: "50", "at least 1".
    target:     a number where it is one target, else None.
    before, after:              its value.
    merit_before, merit_after:  what it adds to the merit.
    """

    want: str
    unit: str
    aim: str
    target: float | None
    before: float
    after: float
    merit_before: float
    merit_after: float


@dataclasses.dataclass(frozen=True)
class Change:
    """One number of the lens, before and after; at_bound: "", "least" or "most"."""

    name: str
    unit: str
    before: float
    after: float
    at_bound: str


@dataclasses.dataclass(frozen=True)
class Optimized:
    """A lens that was searched for.

    lens:     the best one, a lens like any other.
    history:  every evaluation of the search.
    terms:    of all wants.         changes: of all numbers that might.
    merit_before, merit_after:  sums of squares of all weighted residuals.
    improved: the merit has become less. A start that cannot be improved is reported as such: False.
    arrived:  the search came to a minimum, and did not stop before.
    message:  how it ended, in words.
    lost:     rays that are lost there, of those that count.
    interrupted:  by Ctrl-C; the lens is the best so far.
    seconds:  that the search took; compile_seconds: that it waited for its programs before.
    """

    lens: Lens
    history: tuple[Step, ...]
    terms: tuple[Term, ...]
    changes: tuple[Change, ...]
    merit_before: float
    merit_after: float
    improved: bool
    arrived: bool
    message: str
    lost: int
    interrupted: bool
    seconds: float
    compile_seconds: float

    @property
    def steps(self) -> int:
        """Evaluations of residuals and their derivatives."""
        return len(self.history)

    def table(self) -> str:
        """Every term, its value before and after, and what it adds to the merit, as text."""
        head = ("want", "aim", "before", "after", "unit", "merit before", "merit after")
        rows = [
            (t.want, t.aim, *map(_number, (t.before, t.after)), t.unit, *map(_part, (t.merit_before, t.merit_after)))
            for t in self.terms
        ]
        total = ("merit", "", "", "", "", f"{self.merit_before:.7e}", f"{self.merit_after:.7e}")
        return aligned([head, *rows, total], left=(0, 1, 4))

    def __repr__(self) -> str:
        return f"{self.message}: merit {self.merit_before:.7g} -> {self.merit_after:.7g}\n{self.table()}"


@dataclasses.dataclass(frozen=True)
class Minima:
    """Lenses that searches from many starts came to, best first.

    lenses:    the best distinct ones.      distinct: how many there were among the ends that were refined,
               without those that lose rays.
    ended:     searches that came to an end, of `starts`; fewer after Ctrl-C.
    seconds:   for all of it, compilation too.      interrupted: by Ctrl-C.
    """

    lenses: tuple[Optimized, ...]
    distinct: int
    ended: int
    starts: int
    seconds: float
    interrupted: bool

    def table(self) -> str:
        """A line for each lens, as text."""
        rows = [
            (str(i), f"{each.merit_after:.6e}", f"{sum(float(row.thickness) for row in each.lens):.4f}", str(each.lost))
            for i, each in enumerate(self.lenses, 1)
        ]
        return aligned([("", "merit", "total track, mm", "rays lost"), *rows], left=())

    def __repr__(self) -> str:
        ended = f"{self.ended} of {self.starts} searches, {self.distinct} distinct minima among those refined"
        return f"{ended}\n{self.table()}"

    def __iter__(self) -> Iterator[Optimized]:
        return iter(self.lenses)

    def __len__(self) -> int:
        return len(self.lenses)

    def __getitem__(self, place: int) -> Optimized:
        return self.lenses[place]


def _number(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else "lost" if math.isnan(value) else "infinity"


def _part(value: float) -> str:
    return f"{value:.3e}"


def aligned(rows: list[tuple[str, ...]], left: tuple[int, ...]) -> str:
    """Rows of words in columns, some of them to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(
            text.ljust(width) if place in left else text.rjust(width)
            for place, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
