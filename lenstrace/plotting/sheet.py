"""One page about a lens, to print: layout, first-order table, fans, spots, field curvature, distortion, colour, MTF."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from lenstrace.analysis.sheet import Sheet
from lenstrace.plotting.fans import fan_axes, plot_fans
from lenstrace.plotting.field import (
    plot_distortion,
    plot_field_curvature,
    plot_lateral_colour,
    plot_longitudinal_aberration,
)
from lenstrace.plotting.layout import plot_layout
from lenstrace.plotting.mtf import plot_mtf
from lenstrace.plotting.spots import plot_spots, spot_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

# Inches: a page of A3, upright; the heights of its rows.
PAGE = (11.69, 16.54)
ROWS = (3.4, 2.1, 2.7, 3.2, 3.6)
FAN_ROW = 1.75
# Letters in a line of a panel that says why it is empty.
LINE = 38


def sheet_figure(sheet: Sheet) -> Figure:
    """The page, without pyplot's global state. What the lens does not have leaves a panel that says why."""
    from matplotlib.figure import Figure

    lens, count = sheet.lens, len(sheet.lens.fields.y)
    figure = Figure(figsize=PAGE, layout="constrained")
    figure.suptitle(lens.name or "lens", parse_math=False, fontsize="x-large")
    heights = [ROWS[0], FAN_ROW * count + 0.4, ROWS[2], ROWS[3], ROWS[4]]
    rows = figure.subfigures(5, 1, height_ratios=heights, squeeze=False)[:, 0]
    top, middle, spot_row, field_row, last = rows

    left, right = top.subfigures(1, 2, width_ratios=[7, 4])
    _panel(sheet, "layout", left, lambda result: _layout(result, left.add_subplot()))
    _table(sheet, right.add_subplot())
    _panel(sheet, "fans", middle, lambda result: plot_fans(result, lens, fan_axes(middle, count)))
    _panel(sheet, "spots", spot_row, lambda result: plot_spots(result, lens, spot_axes(spot_row, count)))
    drawn: dict[str, Callable[[Any, Any, Axes], Any]] = {
        "field_curvature": plot_field_curvature,
        "distortion": plot_distortion,
        "lateral_colour": plot_lateral_colour,
        "longitudinal_aberration": plot_longitudinal_aberration,
    }
    for part, (name, plot) in zip(field_row.subfigures(1, 4), drawn.items(), strict=True):
        _panel(sheet, name, part, lambda result, part=part, plot=plot: plot(result, lens, part.add_subplot()))
    _panel(sheet, "mtf", last, lambda result: plot_mtf(result, lens, last.add_subplot()))
    return figure


def _panel(sheet: Sheet, name: str, part: SubFigure, draw: Callable[[Any], Any]) -> None:
    """A result, or why there is none."""
    if name in sheet.found:
        draw(sheet.found[name])
        return
    text = textwrap.fill(f"no {name.replace('_', ' ')}: {sheet.missing[name]}", LINE)
    part.text(0.5, 0.5, text, ha="center", va="center", fontsize="small", parse_math=False)


def _layout(result: Any, axes: Axes) -> None:
    plot_layout(result, axes)
    axes.set_title("")


def _table(sheet: Sheet, axes: Axes) -> None:
    """First-order figures at the primary wavelength."""
    lens, whole = sheet.lens, sheet.found["overview"]
    primary = lens.wavelengths.primary
    points = sheet.found["first_order"]
    fields = ", ".join(f"{float(y):g}" for y in lens.fields.y)
    rows = [
        ("wavelengths, µm", ", ".join(f"{um:g}" for um in lens.wavelengths.um)),
        (f"fields in y, {lens.fields.unit}", fields),
        ("focal length, mm", _number(points.focal_length[primary])),
        ("back focal length, mm", _number(points.back_focal_length[primary])),
        ("front focal length, mm", _number(points.front_focal_length[primary])),
        ("F-number", _number(whole.f_number)),
        ("entrance pupil, mm from first vertex", _number(whole.entrance_pupil.position)),
        ("its diameter, mm", _number(whole.entrance_pupil.diameter)),
        ("exit pupil, mm from image", _number(whole.exit_pupil.position)),
        ("its diameter, mm", _number(whole.exit_pupil.diameter)),
        ("total track, mm", _number(whole.total_track)),
    ]
    if whole.magnification is not None:
        rows.insert(5, ("magnification", _number(whole.magnification)))
    axes.set_axis_off()
    title = f"First order at {lens.wavelengths.um[primary]:g} µm"
    axes.set_title(title, fontsize="medium", loc="left")
    table = axes.table(
        [list(row) for row in rows], colWidths=[0.62, 0.38], cellLoc="right", loc="upper left", edges="open"
    )
    table.auto_set_font_size(False)
    table.set_fontsize(9)
    table.scale(1, 1.25)
    for (_, column), cell in table.get_celld().items():
        if column == 0:
            cell.get_text().set_horizontalalignment("left")


def _number(value: Any) -> str:
    number = float(np.asarray(value))
    return f"{number:.6g}" if np.isfinite(number) else ("infinity" if np.isinf(number) else "-")
