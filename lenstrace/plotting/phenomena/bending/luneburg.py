"""A beam through Luneburg's lens, and what its accuracy costs."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Circle

from lenstrace.phenomena.bending.luneburg import Luneburg
from lenstrace.plotting.colours import GLASS, OUTLINE, PALETTE
from lenstrace.plotting.phenomena.bending.tolerance import plot_cost


def plot_rays(found: Luneburg, axes: Axes) -> Axes:
    """The course of the rays, in mm."""
    axes.add_patch(Circle((0, 0), found.radius, facecolor=GLASS, edgecolor=OUTLINE))
    axes.plot(found.ray_z, found.ray_y, color=PALETTE[0], linewidth=0.8)
    axes.plot(*found.focus, "o", color=PALETTE[1], markersize=6, label="focus")
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.12)
    axes.set(xlabel="z, mm", ylabel="y, mm", title="Rays: n² = 2 − r²/R²")
    axes.legend(loc="upper left")
    return axes


def plot_accuracy(found: Luneburg, axes: Axes) -> Axes:
    """Error of the focus against the tolerance."""
    return plot_cost(found.cost(), axes, "farthest ray from the focus, radii of the ball")


PANELS = (plot_rays, plot_accuracy)
