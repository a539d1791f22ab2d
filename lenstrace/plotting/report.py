"""One picture of a lens: its layout above its spot diagrams."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lenstrace.analysis.layout import Layout
from lenstrace.analysis.spot_figures import Spots
from lenstrace.plotting.layout import figure_size, layout_figure, plot_layout
from lenstrace.plotting.spots import plot_spots, spot_axes, spots_size
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def figure_of(lens: Lens, layout: Layout, spots: Spots | None) -> Figure:
    """A figure with the layout on top and the spots below; the layout alone where there are no spots."""
    if spots is None:
        return layout_figure(layout)
    from matplotlib.figure import Figure

    count = len(lens.fields.y)
    (width, above), (spots_width, below) = figure_size(layout), spots_size(count)
    figure = Figure(figsize=(max(width, spots_width), above + below), layout="constrained")
    upper, lower = figure.subfigures(2, 1, height_ratios=[above, below], squeeze=False)[:, 0]
    plot_layout(layout, upper.add_subplot())
    plot_spots(spots, lens, spot_axes(lower, count))
    return figure
