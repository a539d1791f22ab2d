"""How the error of a view factor falls with the number of rays, and what it costs in time."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from lenstrace.phenomena.lines.view_factor import ViewFactor
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE
from lenstrace.plotting.trade import family_look, plot_outcomes

INSET = (0.0, 0.0, 0.44, 0.46)  # of the panel: left, bottom, width, height
ELEVATION, AZIMUTH = 18, -60  # degrees, of the view of the shapes
SCREEN, BLOCKED = "#8C8C8C", PALETTE[1]
LEAST = 1e-16  # smaller errors are drawn there


def plot_errors(found: ViewFactor, axes: Axes) -> Axes:
    """Errors against rays, with the slopes; in the corner the shapes and some rays, blocked ones in orange."""
    for family, law in (("random", found.random_law), ("sobol", found.sobol_law)):
        colour, marker = family_look(family)
        errors = law.errors / found.factor
        label = f"{family}, slope {law.slope:.2f}"
        axes.plot(law.counts, errors, marker, color=colour, markersize=5, label=label)
        # the straight line of that slope through the middle of the logarithms
        rays = np.log(law.counts)
        line = np.exp(np.log(errors).mean() + law.slope * (rays - rays.mean()))
        axes.plot(law.counts, line, color=colour, linewidth=1)
    colour, marker = family_look("gaussian")
    errors = np.maximum(found.gauss_errors / found.factor, LEAST)
    axes.plot(found.gauss_counts, errors, marker + "-", color=colour, markersize=5, linewidth=1, label="gaussian")
    axes.set(xscale="log", yscale="log")
    least, most = axes.get_ylim()
    # room for the shapes below and the legend above
    axes.set_ylim(max(least**2 / most, LEAST / 10), most * (most / least) ** 0.3)
    axes.set(xlabel="rays", ylabel="relative error", title=f"View factor {found.factor:.6g}: error against rays")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small", frameon=False, loc="upper right")
    _draw_shapes(found, axes.inset_axes(INSET, projection="3d"))
    return axes


def plot_cost(found: ViewFactor, axes: Axes) -> Axes:
    """Errors against time, one mark for each number of rays."""
    plot_outcomes(found.trade, "", axes)
    axes.set(title="Error against time")
    return axes


def _draw_shapes(found: ViewFactor, space: Any) -> None:
    for number, outline in enumerate(found.outlines):
        face = GLASS if number < 2 else SCREEN
        space.add_collection3d(Poly3DCollection([outline], facecolor=face, edgecolor=OUTLINE, alpha=0.6, linewidth=0.8))
    for start, end, arrives in zip(found.starts, found.ends, found.arrives, strict=True):
        space.plot(*np.stack([start, end]).T, color=AXIS if arrives else BLOCKED, linewidth=0.6)
    corners = np.concatenate(found.outlines)
    low, high = corners.min(0), corners.max(0)
    space.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    space.set_box_aspect(high - low)
    space.view_init(ELEVATION, AZIMUTH)
    space.patch.set_alpha(0)
    space.set_axis_off()


PANELS = (plot_errors, plot_cost)
