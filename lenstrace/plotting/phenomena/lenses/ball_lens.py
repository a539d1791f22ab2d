"""A beam through a ball, and where its rays cross the axis."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Circle

from lenstrace.phenomena.lenses.ball_lens import BallLens
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE


def plot_rays(found: BallLens, axes: Axes) -> Axes:
    """The ball and the rays, in mm from its centre."""
    axes.add_patch(Circle((0, 0), found.radius, facecolor=GLASS, edgecolor=OUTLINE))
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    axes.plot(found.ray_z, found.ray_y, color=PALETTE[0], linewidth=0.7)
    axes.plot(found.focal_length, 0, "o", color=PALETTE[1], markersize=5, label="F'")
    axes.set(xlabel="z from the centre, mm", ylabel="y, mm", title="A beam along the axis")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper right")
    return axes


def plot_crossings(found: BallLens, axes: Axes) -> Axes:
    """Where each ray crosses the axis."""
    axes.plot(found.theory, found.heights, color=PALETTE[0], linewidth=1, label="theory")
    axes.plot(found.crossings, found.heights, "o", color=PALETTE[1], markersize=4, label="traced")
    axes.axvline(found.focal_length, color=PALETTE[5], linestyle="--", linewidth=1, label="F'")
    axes.set(xlabel="axis crossing from the centre, mm", ylabel="height of the ray, mm", title="Spherical aberration")
    axes.grid(alpha=0.3)
    axes.legend()
    return axes


PANELS = (plot_rays, plot_crossings)
