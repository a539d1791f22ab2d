"""Rays of a point in Maxwell's fish-eye, and what their accuracy costs."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Circle

from lenstrace.phenomena.bending.fish_eye import FishEye
from lenstrace.plotting.colours import GLASS, OUTLINE, PALETTE
from lenstrace.plotting.phenomena.bending.tolerance import plot_cost


def plot_rays(found: FishEye, axes: Axes) -> Axes:
    """The course of the rays, in mm."""
    disc = Circle((0, 0), found.radius, facecolor=GLASS, edgecolor=OUTLINE, linestyle="--", label="r = R, n = n₀/2")
    axes.add_patch(disc)
    axes.plot(found.ray_z, found.ray_y, color=PALETTE[0], linewidth=0.8)
    axes.plot(found.source, 0, "o", color=PALETTE[5], markersize=5, label="point")
    axes.plot(found.image, 0, "o", color=PALETTE[1], markersize=5, label="image")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="z, mm", ylabel="y, mm", title="Rays: n = n₀ / (1 + r²/R²)")
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.15), ncols=3, frameon=False)
    return axes


def plot_accuracy(found: FishEye, axes: Axes) -> Axes:
    """Error of the image against the tolerance."""
    return plot_cost(found.cost(), axes, "farthest ray from the image, of its distance")


PANELS = (plot_rays, plot_accuracy)
