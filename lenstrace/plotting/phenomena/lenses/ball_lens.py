"""Rays through a ball, and where each crosses the axis."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Circle

from lenstrace.phenomena.lenses.ball_lens import BallLens
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

LEFT, RIGHT = -2.0, 3.4  # of the picture, radii from the centre
TALL = 1.8


def plot_rays(found: BallLens, axes: Axes) -> Axes:
    """The course of the rays, and the focus of those near the axis, in mm."""
    r, (z, y) = found.radius, found.rays
    axes.add_patch(Circle((0, 0), r, facecolor=GLASS, edgecolor=OUTLINE, zorder=0))
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    axes.plot([LEFT * r + 0 * z[0], *z[1:]], y, color=PALETTE[0], linewidth=0.8)
    if found.focus < r:
        slope = (y[-1] - y[-2]) / (z[-1] - z[-2])
        back = [y[-2] + slope * (LEFT * r - z[-2]), y[-2]]
        axes.plot([LEFT * r + 0 * z[0], z[-2]], back, color=PALETTE[0], linewidth=0.6, linestyle="--")
    if LEFT * r < found.focus < RIGHT * r:
        axes.plot(found.focus, 0, "o", color=PALETTE[1], markersize=5, label="F'")
        axes.legend(loc="upper left", fontsize="small")
    axes.set_aspect("equal")
    axes.set(xlabel="z, mm", ylabel="y, mm", title="Rays", xlim=(LEFT * r, RIGHT * r), ylim=(-TALL * r, TALL * r))
    return axes


def plot_crossings(found: BallLens, axes: Axes) -> Axes:
    """Where the rays cross the axis, from the centre, against their height; mm."""
    axes.plot(found.crossings_theory, found.heights, color=PALETTE[0], label="R sin i / sin 2(i − r)")
    axes.plot(found.crossings[::4], found.heights[::4], "o", color=PALETTE[1], markersize=4, label="traced")
    inside = "inside the ball" if abs(found.focus) < found.radius else ""
    axes.set(
        xlabel="axis crossing, mm from the centre",
        ylabel="height of the ray, mm",
        title=f"Spherical aberration {inside}".strip(),
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    return axes


PANELS = (plot_rays, plot_crossings)
