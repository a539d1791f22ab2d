"""Spots through focus: how large they are, what they look like, and one page of them with the spot curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import jax
import numpy as np

from lenstrace.analysis.focus import BestFocus, ThroughFocus
from lenstrace.analysis.spot_curves import SpotField, SpotSpectrum
from lenstrace.plotting.colours import colours
from lenstrace.plotting.spot_curves import (
    POLYCHROMATIC,
    field_texts,
    finished,
    new_axes,
    plot_spot_field,
    plot_spot_spectrum,
    size_unit,
)
from lenstrace.plotting.spots import SMALLEST, wavelength_styles
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

# Places through focus that are shown as spots, at most.
SHOWN = 5
# Inches: the width of a page, the height of the curves, of a row of spots, and of the legend above them.
WIDTH, CURVES, ROW, HEAD = 12.0, 3.6, 2.0, 0.7


def plot_through_focus(
    through: ThroughFocus, lens: Lens, axes: Axes | None = None, *, best: BestFocus | None = None
) -> Axes:
    """RMS spot against the shift of the image surface, a line for each field and a thicker one for all together.

    best:  its least RMS spot of all fields, and the paraxial focus, are drawn as upright lines.
    Returns the axes; without them a figure is made through pyplot.
    """
    axes = new_axes() if axes is None else axes
    shifts = np.asarray(through.shifts)
    sizes = np.asarray(through.spots.polychromatic.rms_centroid)
    unit, scale = size_unit(sizes)
    for f, (text, colour) in enumerate(zip(field_texts(lens), colours(sizes.shape[1]), strict=True)):
        axes.plot(shifts, sizes[:, f] * scale, color=colour, linewidth=1.3, label=text)
    if sizes.shape[1] > 1:
        axes.plot(shifts, np.asarray(through.rms) * scale, color=POLYCHROMATIC, linewidth=2.2, label="all fields")
    if best is not None:
        for focus, style, label in ((best.spot, "--", "least spot"), (best.paraxial, ":", "paraxial")):
            shift = float(focus.shift)
            if shifts.min() <= shift <= shifts.max():
                axes.axvline(shift, color="#7F7F7F", linestyle=style, linewidth=1.0, label=label)
    axes.set_xlabel("shift of the image, mm")
    return finished(axes, f"RMS spot, {unit}")


def plot_focus_spots(through: ThroughFocus, lens: Lens, axes: Sequence[Sequence[Axes]]) -> None:
    """Draw the spots through focus about the centroid of each, all to one scale.

    axes: a row for each field, of panels for as many of the shifts as fit, the first and the last among them.
    """
    chosen = np.linspace(0, len(np.asarray(through.shifts)) - 1, len(axes[0])).round().astype(int)
    spots = jax.tree.map(lambda a: np.asarray(a)[chosen], through.spots)
    alive = spots.failure == 0
    centroids = spots.polychromatic.centroid_x, spots.polychromatic.centroid_y
    x, y = (
        np.where(alive, rays - centre[..., None, None], np.nan)
        for rays, centre in zip((spots.x, spots.y), centroids, strict=True)
    )
    half = max(float(np.nanmax(np.abs([x, y]))), SMALLEST)
    unit, scale = size_unit(half)
    for f, (row, text) in enumerate(zip(axes, field_texts(lens), strict=True)):
        for k, panel in enumerate(row):
            for w, um in enumerate(lens.wavelengths.um):
                colour = wavelength_styles(lens.wavelengths.um)[w][0]
                place = (k, f, w)
                panel.plot(x[place] * scale, y[place] * scale, ".", color=colour, markersize=1.5, label=f"{um:g} µm")
            panel.set_aspect("equal")
            panel.set(xlim=(-1.1 * half * scale, 1.1 * half * scale), ylim=(-1.1 * half * scale, 1.1 * half * scale))
            panel.tick_params(labelsize="x-small", labelbottom=f == len(axes) - 1, labelleft=k == 0)
            if f == 0:
                panel.set_title(f"{float(np.asarray(through.shifts)[chosen[k]]):+.4g} mm", fontsize="small")
            if f == len(axes) - 1:
                panel.set_xlabel(f"x, {unit}", fontsize="small")
        row[0].set_ylabel(f"{text}\ny, {unit}", fontsize="small")


def focus_figure(
    through: ThroughFocus, best: BestFocus, field: SpotField, spectrum: SpotSpectrum, lens: Lens
) -> Figure:
    """A page: spots through focus, against field and against wavelength as curves, and below them the spots themselves;
    without pyplot's global state."""
    from matplotlib.figure import Figure

    count = len(lens.fields.y)
    below = HEAD + ROW * count
    figure = Figure(figsize=(WIDTH, CURVES + below), layout="constrained")
    upper, lower = figure.subfigures(2, 1, height_ratios=[CURVES, below], squeeze=False)[:, 0]
    first, second, third = upper.subplots(1, 3)
    plot_through_focus(through, lens, first, best=best).set_title("through focus")
    plot_spot_field(field, lens, second).set_title("against field")
    plot_spot_spectrum(spectrum, lens, third).set_title("against wavelength")
    panels = focus_axes(lower, count, min(SHOWN, len(np.asarray(through.shifts))))
    plot_focus_spots(through, lens, panels)
    handles, labels = panels[0][0].get_legend_handles_labels()
    lower.legend(handles, labels, loc="outside upper center", ncols=len(labels), fontsize="small", markerscale=5)
    if lens.name:
        figure.suptitle(lens.name, parse_math=False)
    return figure


def focus_axes(figure: Figure | SubFigure, fields: int, places: int) -> list[list[Axes]]:
    """Panels for `plot_focus_spots`: a row for each field, a column for each place."""
    return [list(row) for row in figure.subplots(fields, places, squeeze=False)]
