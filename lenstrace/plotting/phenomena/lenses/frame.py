"""The drawing of a lens in a panel that is nearly square, with room for a legend above it."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.analysis.layout import Layout
from lenstrace.plotting.layout import plot_layout

TALL = 0.33  # of the width of the picture: half its height, at least
BELOW, ABOVE = 1.2, 1.7  # of the half height of the lens, at least


def plot_lens(layout: Layout, shown: tuple[float, float], axes: Axes) -> Axes:
    """A layout without rays, from z to z, mm."""
    plot_layout(layout, axes)
    height = max(surface.semi_diameter for surface in layout.surfaces if surface.bends)
    tall = TALL * (shown[1] - shown[0])
    axes.set(xlim=shown, ylim=(-max(BELOW * height, tall), max(ABOVE * height, tall)))
    return axes
