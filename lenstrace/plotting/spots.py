"""Spot diagrams: where the rays of each field meet the image, one panel a field, all to one scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lenstrace.analysis.spot_figures import Spots
from lenstrace.plotting.colours import colours
from lenstrace.plotting.layout import field_text
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

# From the palette of Okabe & Ito (2008), safe for the colour-blind, in the order of the spectrum.
SPECTRUM = ("#0072B2", "#56B4E9", "#009E73", "#E69F00", "#D55E00")
MARKERS = "o^sDvP*X"
UM_PER_MM = 1000.0
# Spots larger than this, in mm, are drawn in mm; a scale never shows less than the other, in mm.
LARGE, SMALLEST = 1.0, 1e-5
# Panels side by side; inches of a panel, and of the legend beside them.
COLUMNS, PANEL, LEGEND = 5, (2.4, 2.9), 1.5


def plot_spots(spots: Spots, lens: Lens, axes: Sequence[Axes] | None = None) -> tuple[Axes, ...]:
    """Draw the spots of a lens about their primary chief rays, or about the centroid where that ray is lost.

    axes:  one for each field; without them a figure is made through pyplot. Returns them.
    Lost rays are not drawn. The title of a panel gives the RMS radius of all wavelengths about the centroid.
    """
    if axes is None:
        from matplotlib import pyplot

        count = len(lens.fields.y)
        axes = spot_axes(pyplot.figure(figsize=spots_size(count), layout="constrained"), count)
    x, y = _about_chief(spots, lens)
    half = max(float(np.nanmax(np.abs([x, y]))), SMALLEST)
    unit, scale = ("mm", 1.0) if half > LARGE else ("µm", UM_PER_MM)
    rms = np.asarray(spots.polychromatic.rms_centroid) * scale
    styles = wavelength_styles(lens.wavelengths.um)
    for f, panel in enumerate(axes):
        for w, um in enumerate(lens.wavelengths.um):
            colour, marker = styles[w]
            panel.plot(
                x[f, w] * scale,
                y[f, w] * scale,
                linestyle="none",
                marker=marker,
                markersize=2.6,
                markeredgewidth=0,
                color=colour,
                label=f"{um:g} µm",
            )
        panel.set_aspect("equal")
        panel.set(xlim=(-1.1 * half * scale, 1.1 * half * scale), ylim=(-1.1 * half * scale, 1.1 * half * scale))
        panel.set_xlabel(f"x, {unit}")
        panel.set_ylabel(f"y, {unit}")
        field = field_text(float(lens.fields.x[f]), float(lens.fields.y[f]), lens.fields.unit)
        panel.set_title(f"{field}\nRMS {rms[f]:.3g} {unit}", fontsize="medium")
        panel.tick_params(labelsize="small")
    axes[min(len(axes), COLUMNS) - 1].legend(
        loc="upper left",
        bbox_to_anchor=(1.03, 1.0),
        borderaxespad=0.0,
        frameon=False,
        fontsize="small",
        markerscale=2,
        handletextpad=0.2,
    )
    return tuple(axes)


def spots_figure(spots: Spots, lens: Lens) -> Figure:
    """A figure of the spots alone, without pyplot's global state."""
    from matplotlib.figure import Figure

    count = len(lens.fields.y)
    figure = Figure(figsize=spots_size(count), layout="constrained")
    plot_spots(spots, lens, spot_axes(figure, count))
    if lens.name:
        figure.suptitle(lens.name, parse_math=False)
    return figure


def spots_size(count: int) -> tuple[float, float]:
    """Width and height in inches of the panels of so many fields."""
    return PANEL[0] * min(count, COLUMNS) + LEGEND, PANEL[1] * -(-count // COLUMNS)


def spot_axes(figure: Figure | SubFigure, count: int) -> list[Axes]:
    """Panels for so many fields, in rows from the left."""
    columns = min(count, COLUMNS)
    rows = -(-count // columns)
    return [figure.add_subplot(rows, columns, place + 1) for place in range(count)]


def _about_chief(spots: Spots, lens: Lens) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of the rays, (F, W, N) in mm; nan for a lost ray."""
    primary = lens.wavelengths.primary
    alive = np.asarray(spots.failure) == 0
    together = spots.polychromatic
    found = []
    for rays, chief, centroid in (
        (spots.x, spots.chief_x, together.centroid_x),
        (spots.y, spots.chief_y, together.centroid_y),
    ):
        chief = np.asarray(chief)[:, primary]
        origin = np.where(np.isnan(chief), np.asarray(centroid), chief)
        found.append(np.where(alive, np.asarray(rays) - origin[:, None, None], np.nan))
    return found[0], found[1]


def wavelength_styles(wavelengths: Sequence[float]) -> list[tuple[str, str]]:
    """Colour and marker of each wavelength, blue to red as they rise."""
    count = len(wavelengths)
    ordered = colours(count)
    if count <= len(SPECTRUM):
        ordered = [SPECTRUM[round(place)] for place in np.linspace(0, len(SPECTRUM) - 1, count)]
    rank = np.argsort(np.argsort(wavelengths))
    return [(ordered[place], MARKERS[place % len(MARKERS)]) for place in rank]
