"""Rays above a hot road, and the index that turns them back."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.bending.mirage import Mirage
from lenstrace.plotting.colours import OUTLINE, PALETTE, colours


def plot_rays(found: Mirage, axes: Axes) -> Axes:
    """The rays, and where the eye believes they come from; metres, the height much enlarged."""
    for x, y, angle, colour in zip(found.ray_x.T, found.ray_y.T, found.angles, colours(len(found.angles)), strict=True):
        axes.plot(x, y, color=colour, linewidth=1, label=f"{angle:.3g} mrad")
        axes.plot([0, x[-1]], [found.eye, found.eye - angle * 1e-3 * x[-1]], color=colour, linewidth=0.7, linestyle=":")
    axes.plot(0, found.eye, "o", color=PALETTE[5], markersize=5)
    axes.axhline(0, color=OUTLINE, linewidth=2)
    axes.set(
        xlabel="distance along the road, m",
        ylabel="height, m",
        title="A mirage (dotted: as the eye sees it)",
        ylim=(-0.6 * found.eye, 1.6 * found.eye),
    )
    axes.legend(title="below the horizon", fontsize="small", loc="upper center", ncols=3)
    return axes


def plot_index(found: Mirage, axes: Axes) -> Axes:
    """The index against height."""
    axes.plot(found.index, found.heights, color=PALETTE[0])
    for turning, colour in zip(found.turning, colours(len(found.turning)), strict=True):
        axes.axhline(turning, color=colour, linewidth=0.8)
    axes.set(
        xlabel="refractive index less 1, millionths", ylabel="height, m", title="The air, and where rays are turned"
    )
    axes.grid(alpha=0.3)
    return axes


PANELS = (plot_rays, plot_index)
