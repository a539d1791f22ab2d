"""What a demonstration says: what is set up, what is measured, what theory says of it, and the difference."""

from __future__ import annotations

import dataclasses
import math
from typing import TypeVar, dataclass_transform

# Of a quantity for which nothing else is said.
RELATIVE_TOLERANCE = 1e-10

Data = TypeVar("Data")


@dataclasses.dataclass(frozen=True)
class Comparison:
    """One quantity, measured and by theory, both in `unit` ("" for a pure number).

    within: largest difference of the two that is agreement, in the same unit; None: 1e-10 of what theory says.
    """

    quantity: str
    unit: str
    measured: float
    theory: float
    within: float | None = None

    @property
    def difference(self) -> float:
        """Measured minus theory; 0 where both are the same infinity."""
        return 0.0 if self.measured == self.theory else float(self.measured) - float(self.theory)

    @property
    def tolerance(self) -> float:
        """The largest difference that is agreement: `within`, or what stands for it."""
        return RELATIVE_TOLERANCE * abs(float(self.theory)) if self.within is None else float(self.within)

    @property
    def texts(self) -> tuple[str, str, str]:
        """Measured, theory and difference for a reader."""
        return f"{self.measured + 0.0:.12g}", f"{self.theory + 0.0:.12g}", f"{self.difference + 0.0:.1e}"

    @property
    def agrees(self) -> bool:
        """True where the two differ by no more than they may; False where one of them is not a number."""
        return not math.isnan(self.difference) and bool(abs(self.difference) <= self.tolerance)


@dataclass_transform(frozen_default=True, kw_only_default=True, eq_default=False)
def result(cls: type[Data]) -> type[Data]:
    """Make `cls`, a `Demonstration`, a frozen dataclass whose fields are named where it is made; shown as its table."""
    return dataclasses.dataclass(frozen=True, kw_only=True, eq=False, repr=False)(cls)


@result
class Demonstration:
    """What every demonstration has; each adds what its picture shows.

    setting:  what is set up, in words, with units.
    rows:     measured and theory.
    """

    setting: str
    rows: tuple[Comparison, ...]

    @property
    def agrees(self) -> bool:
        """True where every row does."""
        return all(row.agrees for row in self.rows)

    def __repr__(self) -> str:
        return f"{self.setting}\n{text_table(self.rows)}"


def text_table(rows: tuple[Comparison, ...]) -> str:
    """Lines of text, one for each comparison, under a heading; a row that does not agree says so."""
    cells = [("quantity", "unit", "measured", "theory", "difference", "")]
    for row in rows:
        cells.append((row.quantity, row.unit, *row.texts, "" if row.agrees else "DIFFERS"))
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if place < 2 else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in cells
    )
