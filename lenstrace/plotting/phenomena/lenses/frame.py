"""A panel that is nearly square, for a lens and its rays, with room for a legend above it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE

TALL = 0.33  # of the width of the picture: half its height, at least
BELOW, ABOVE = 1.2, 1.7  # of the half height of the lens, at least


def frame(axes: Axes, shown: tuple[float, float], height: float) -> Axes:
    """From z to z, mm, a lens of that half height on the axis; one millimetre as long on both."""
    tall = TALL * (shown[1] - shown[0])
    axes.set_aspect("equal")
    axes.set(
        xlabel="z, mm",
        ylabel="y, mm",
        xlim=shown,
        ylim=(-max(BELOW * height, tall), max(ABOVE * height, tall)),
    )
    return axes


def plot_glass(axes: Axes, outline: np.ndarray) -> Axes:
    """A lens and the optical axis; outline: (N, 2) of (z, y), mm."""
    axes.fill(*outline.T, facecolor=GLASS, edgecolor=OUTLINE, linewidth=0.9, zorder=0.5)
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    return axes
