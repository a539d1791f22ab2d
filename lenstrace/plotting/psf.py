"""Point spreads, one panel a field, all to one scale; and encircled energy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lenstrace.analysis.encircled import EncircledEnergy
from lenstrace.analysis.psf import Psf
from lenstrace.plotting.colours import colours
from lenstrace.plotting.layout import field_text
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

COLOURS = "magma"
UM_PER_MM = 1000.0
# The faintest light that logarithmic colours tell from none, of the densest.
FAINTEST = 1e-4
# Panels show what is denser than this part of the densest, and never fewer pixels to a side of the middle.
SHOWN, LEAST_PIXELS = 5e-3, 8
# Panels side by side; inches of a panel, of the colour bar, and of the curves of encircled energy.
COLUMNS, PANEL, BAR, CURVES = 4, (2.7, 3.1), 1.0, 3.2


def plot_psf(
    psf: Psf, lens: Lens, axes: Sequence[Axes] | None = None, *, logarithmic: bool = False
) -> tuple[Axes, ...]:
    """Draw the point spreads of all wavelengths, densities over that of each field's densest point.

    axes:  one for each field; without them a figure is made through pyplot. Returns them.
    Panels are cut to where light is. Titles give the densest point over that of a perfect lens.
    """
    from matplotlib.colors import LogNorm, Normalize

    if axes is None:
        from matplotlib import pyplot

        count = len(lens.fields.y)
        axes = psf_axes(pyplot.figure(figsize=psf_size(count), layout="constrained"), count)
    density, position = np.asarray(psf.polychromatic), np.asarray(psf.position)
    highest = np.max(density, (-2, -1))
    relative = density / np.where(highest > 0, highest, 1)[:, None, None]
    # a field without light is nan, and its panel empty
    lit = np.max(np.nan_to_num(relative), 0) > SHOWN
    far = np.abs(position)[np.any(lit, 0) | np.any(lit, 1)]
    pixel = float(position[1] - position[0])
    half = max(float(np.max(far, initial=0)) * 1.1, LEAST_PIXELS * pixel) * UM_PER_MM
    edges = (float(position[0]) - pixel / 2) * UM_PER_MM, (float(position[-1]) + pixel / 2) * UM_PER_MM
    half = min(half, edges[1])
    norm = LogNorm(FAINTEST, 1) if logarithmic else Normalize(0, 1)
    image = None
    for f, panel in enumerate(axes):
        image = panel.imshow(
            np.maximum(relative[f], FAINTEST) if logarithmic else relative[f],
            origin="lower",
            extent=(*edges, *edges),
            cmap=COLOURS,
            norm=norm,
            interpolation="nearest",
        )
        panel.set(xlim=(-half, half), ylim=(-half, half))
        panel.set_xlabel("x, µm")
        panel.set_ylabel("y, µm")
        field = field_text(float(lens.fields.x[f]), float(lens.fields.y[f]), lens.fields.unit)
        light = np.isfinite(highest[f])
        peak = f"peak {highest[f] / psf.polychromatic_peak[f]:.3g} of perfect" if light else "no ray arrives"
        panel.set_title(f"{field}\n{peak}", fontsize="medium")
        panel.tick_params(labelsize="small")
    if image is not None:
        bar = axes[0].figure.colorbar(image, ax=list(axes), shrink=0.8)
        bar.set_label("density over the densest of the field")
    return tuple(axes)


def plot_encircled(energy: EncircledEnergy, lens: Lens, axes: Axes | None = None) -> Axes:
    """The part of the light in circles, a colour for each field; dotted, all on the window. Returns the axes."""
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.figure(layout="constrained").add_subplot()
    radius = np.asarray(energy.radius) * UM_PER_MM
    for f, colour in enumerate(colours(len(lens.fields.y))):
        if not np.isfinite(energy.within[f]):
            continue
        field = field_text(float(lens.fields.x[f]), float(lens.fields.y[f]), lens.fields.unit)
        axes.plot(radius, np.asarray(energy.circle)[f], color=colour, linewidth=1.5, label=field)
        axes.axhline(float(energy.within[f]), color=colour, linestyle=":", linewidth=0.8)
    axes.set(xlim=(0, float(radius.max())), ylim=(0, 1.03), xlabel="radius, µm", ylabel="part of the light")
    axes.set_title("Encircled energy, all wavelengths", fontsize="medium")
    axes.legend(frameon=False, fontsize="small", loc="lower right")
    return axes


def psf_figure(psf: Psf, energy: EncircledEnergy, lens: Lens) -> Figure:
    """Point spreads above, encircled energy below, without pyplot's global state."""
    from matplotlib.figure import Figure

    count = len(lens.fields.y)
    width, height = psf_size(count)
    figure = Figure(figsize=(width, height + CURVES), layout="constrained")
    grid = figure.add_gridspec(2, 1, height_ratios=[height, CURVES])
    above, below = (figure.add_subfigure(grid[place]) for place in range(2))
    plot_psf(psf, lens, psf_axes(above, count))
    plot_encircled(energy, lens, below.add_subplot())
    if lens.name:
        figure.suptitle(lens.name, parse_math=False)
    return figure


def psf_size(count: int) -> tuple[float, float]:
    """Width and height in inches of the panels of so many fields."""
    return max(PANEL[0] * min(count, COLUMNS) + BAR, 5.0), PANEL[1] * -(-count // COLUMNS)


def psf_axes(figure: Figure | SubFigure, count: int) -> list[Axes]:
    """Panels for so many fields, in rows from the left."""
    columns = min(count, COLUMNS)
    return [figure.add_subplot(-(-count // columns), columns, place + 1) for place in range(count)]
