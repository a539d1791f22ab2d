"""Rays from an aplanatic point, and the aberration of other points."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from lenstrace.phenomena.lenses.aplanatic_points import AplanaticPoints
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE


def plot_rays(found: AplanaticPoints, axes: Axes) -> Axes:
    """The rays, and dashed where they seem to come from, in mm from the centre."""
    axes.add_patch(Circle((0, 0), found.radius, facecolor=GLASS, edgecolor=OUTLINE))
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    axes.plot(found.ray_z, found.ray_y, color=PALETTE[0], linewidth=0.8)
    back = np.zeros_like(found.ray_z[1])
    axes.plot([back + found.image, found.ray_z[1]], [back, found.ray_y[1]], color=PALETTE[1], linewidth=0.5, ls="--")
    axes.plot(found.source, 0, "o", color=PALETTE[5], markersize=5, label="source, R / n")
    axes.plot(found.image, 0, "o", color=PALETTE[1], markersize=5, label="image, n R")
    axes.set(xlabel="z from the centre, mm", ylabel="y, mm", title="From inside a sphere")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left", fontsize="small")
    return axes


def plot_aberration(found: AplanaticPoints, axes: Axes) -> Axes:
    """Longitudinal aberration of a steep ray against the place of the source."""
    axes.axhline(0, color=AXIS, linewidth=0.7)
    axes.plot(found.places, found.aberration, color=PALETTE[0])
    for place, name in zip(found.perfect, ("vertex", "centre", "R / n"), strict=True):
        axes.plot(place, 0, "o", color=PALETTE[1], markersize=5)
        axes.annotate(name, (place, 0), xytext=(0, 8), textcoords="offset points", ha="center")
    axes.set(
        xlabel="source, z from the centre, mm",
        ylabel="crossing of a steep ray, mm off",
        title="Three places without spherical aberration",
        ylim=np.array([-1.0, 1.0]) * np.nanpercentile(abs(found.aberration), 80),
    )
    axes.grid(alpha=0.3)
    return axes


PANELS = (plot_rays, plot_aberration)
