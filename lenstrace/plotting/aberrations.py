"""Third-order aberrations as bars: what every surface adds to the Seidel sums, and their totals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lenstrace.analysis.third_order import Seidel

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# The palette of Okabe & Ito (2008), safe for the colour-blind; a sum, its symbol and its colour.
BARS = (
    ("spherical", "$S_I$ spherical aberration", "#0072B2"),
    ("coma", "$S_{II}$ coma", "#D55E00"),
    ("astigmatism", "$S_{III}$ astigmatism", "#009E73"),
    ("petzval", "$S_{IV}$ Petzval", "#CC79A7"),
    ("distortion", "$S_V$ distortion", "#E69F00"),
    ("axial_colour", "$C_I$ axial colour", "#56B4E9"),
    ("lateral_colour", "$C_{II}$ lateral colour", "#000000"),
)
BARS_WITHOUT_COLOUR = 5
UM_PER_MM = 1000.0
# Sums larger than this, in mm, are drawn in mm; all below the other, in mm, is rounding.
LARGE, SMALLEST = 1.0, 1e-9
# Width of a group of bars, the distance between groups being 1.
GROUP = 0.84
# Inches: a group, what labels and legend need beside them, the least and the largest width, the height.
PER_GROUP, BESIDE, LEAST, LARGEST, HEIGHT = 0.6, 3.0, 7.0, 16.0, 4.2


def plot_seidel(result: Seidel, axes: Axes | None = None) -> Axes:
    """Draw the Seidel sums of the surfaces that add to them, by their numbers, and the totals; returns the axes.

    Without axes a figure is made through pyplot. Colour is left out where there is none.
    """
    names, values = _values(result)
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.figure(figsize=_size(len(names)), layout="constrained").add_subplot()
    largest = float(np.abs(values).max())
    unit, scale = ("mm", 1.0) if largest > LARGE else ("µm", UM_PER_MM)
    shown = [bar for bar in range(len(BARS)) if bar < BARS_WITHOUT_COLOUR or np.abs(values[bar]).max() > SMALLEST]
    width, places = GROUP / len(shown), np.arange(len(names))
    axes.axvspan(len(names) - 1.5, len(names) - 0.5, color="#F0F0F0", zorder=0)
    for order, bar in enumerate(shown):
        _, label, colour = BARS[bar]
        shift = (order + 0.5) * width - GROUP / 2
        axes.bar(places + shift, values[bar] * scale, width, color=colour, label=label, zorder=2)
    axes.axhline(0, color="#34495E", linewidth=0.8, zorder=3)
    axes.set_xticks(places, names)
    axes.set_xlim(-0.6, len(names) - 0.4)
    if largest <= SMALLEST:
        axes.set_ylim(-1, 1)
    axes.set_xlabel("surface")
    axes.set_ylabel(f"Seidel sum, {unit}")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, frameon=False, fontsize="small")
    return axes


def seidel_figure(result: Seidel, title: str = "") -> Figure:
    """A figure of the sums alone, without pyplot's global state."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=_size(len(_values(result)[0])), layout="constrained")
    plot_seidel(result, figure.add_subplot()).set_title(title, parse_math=False)
    return figure


def _values(result: Seidel) -> tuple[list[str], np.ndarray]:
    """Names of the groups, and the sums, (bars, groups), mm; surfaces without any are left out."""
    surfaces = np.array([np.asarray(getattr(result.surfaces, name)) for name, _, _ in BARS])
    kept = np.flatnonzero(surfaces.any(0))
    totals = surfaces.sum(1, keepdims=True)
    return [*(str(i + 1) for i in kept), "total"], np.hstack([surfaces[:, kept], totals])


def _size(groups: int) -> tuple[float, float]:
    return min(max(BESIDE + PER_GROUP * groups, LEAST), LARGEST), HEIGHT
