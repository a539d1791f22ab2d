"""White light spread by a prism, in true colours; and deviation against the angle of incidence."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.bending.prism import Prism
from lenstrace.plotting.colours import GLASS, PALETTE

NIGHT = "#101010"


def plot_rays(prism: Prism, axes: Axes) -> Axes:
    """The course of the colours, on a dark ground, in sides of the prism."""
    axes.set_facecolor(NIGHT)
    y, z = prism.course
    axes.fill(prism.corners[1], prism.corners[0], facecolor="#26313B", edgecolor=GLASS, linewidth=1.2)
    # inside the colours lie upon each other
    axes.plot(z[:2, 0], y[:2, 0], color="white", linewidth=2)
    axes.fill([*z[1:3, 0], z[2, -1]], [*y[1:3, 0], y[2, -1]], color="white", linewidth=1.5)
    for place, colour in enumerate(prism.colours[:-1]):
        corners = [(row, column) for column in (place, place + 1) for row in ((2, 3), (3, 2))[column - place]]
        rows, columns = zip(*corners, strict=True)
        axes.fill(z[rows, columns], y[rows, columns], color=colour, linewidth=0.8)
    axes.set(xlabel="z, sides of the prism", ylabel="y, sides of the prism")
    axes.set(aspect="equal", title=f"White light on {prism.glass}, at {math.degrees(prism.white):.4g}°")
    axes.margins(0.05)
    return axes


def plot_deviation(prism: Prism, axes: Axes) -> Axes:
    """Curves of all colours of the glass, and of the index, in degrees."""
    across, up = np.degrees(prism.incidence), np.degrees(prism.deviation)
    for place, colour in enumerate(prism.colours, 1):
        axes.plot(across[:, place], up[:, place], color=colour, linewidth=1.6)
    middle = len(prism.colours) // 2
    axes.plot([], [], color=prism.colours[middle], linewidth=4, label=f"{prism.glass}, 0.40 to 0.70 µm")
    axes.plot(across[:, 0], up[:, 0], color=PALETTE[5], linewidth=1.5, label=f"n = {prism.index:g}")
    least = np.degrees(prism.least)
    axes.plot(*least, "o", color=PALETTE[5], markersize=6, label=f"least: {least[1]:.4f}° at {least[0]:.4f}°")
    axes.set(xlabel="angle of incidence, degrees", ylabel="deviation, degrees", title="Deviation")
    axes.set_xlim(right=90)
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    return axes


PANELS = (plot_rays, plot_deviation)
