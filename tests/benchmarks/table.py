"""What a section found: lines with a value, its spread and its target, to be printed or written as JSON."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tests.benchmarks.paired import ratio


@dataclass(frozen=True)
class Line:
    """One figure. quartiles: of the same unit; at_most, at_least: the target, None where there is none."""

    what: str
    value: float
    unit: str
    quartiles: tuple[float, float] | None = None
    at_most: float | None = None
    at_least: float | None = None

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None without one."""
        if self.at_most is None and self.at_least is None:
            return None
        return (self.at_most is None or self.value <= self.at_most) and (
            self.at_least is None or self.value >= self.at_least
        )

    @property
    def target(self) -> str:
        """In words.

        >>> Line("call", 1.2, "times", at_most=1.5).target
        'at most 1.5: met'
        """
        if self.met is None:
            return ""
        limit = f"at most {self.at_most:g}" if self.at_most is not None else f"at least {self.at_least:g}"
        return f"{limit}: {'met' if self.met else 'MISSED'}"


@dataclass
class Table:
    """The lines of a section and what has to be said with them."""

    title: str
    lines: list[Line] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def time(self, what: str, values: np.ndarray, unit: str, *, at_most: float | None = None) -> None:
        """A median of times: it belongs to this machine."""
        low, high = np.percentile(values, [25, 75])
        self.lines.append(Line(what, float(np.median(values)), unit, (float(low), float(high)), at_most))

    def value(
        self, what: str, number: float, unit: str, *, at_most: float | None = None, at_least: float | None = None
    ) -> None:
        """A figure that is no time."""
        self.lines.append(Line(what, number, unit, None, at_most, at_least))

    def compare(
        self,
        what: str,
        above: np.ndarray,
        below: np.ndarray,
        *,
        at_most: float | None = None,
        at_least: float | None = None,
    ) -> None:
        """A ratio of two medians of paired times."""
        value, quartiles = ratio(above, below)
        self.lines.append(Line(what, value, "times", quartiles, at_most, at_least))

    def text(self) -> str:
        """As printed."""
        rows = [("", "value", "unit", "quartiles", "target")]
        for line in self.lines:
            spread = "" if line.quartiles is None else "{:.3g} - {:.3g}".format(*line.quartiles)
            rows.append((line.what, f"{line.value:.3g}", line.unit, spread, line.target))
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        body = [
            f"  {row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]:<{widths[2]}}  {row[3]:<{widths[3]}}  {row[4]}"
            for row in rows
        ]
        return "\n".join([self.title, *(line.rstrip() for line in body), *(f"  ({note})" for note in self.notes)])

    def as_json(self) -> dict[str, Any]:
        """As written to a file."""
        return {
            "title": self.title,
            "lines": [{**vars(line), "met": line.met} for line in self.lines],
            "notes": self.notes,
        }
