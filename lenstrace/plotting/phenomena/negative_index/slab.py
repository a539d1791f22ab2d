"""Rays through a slab of negative index, and what its image loses when the index is not quite the right one."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from lenstrace.phenomena.negative_index.slab import Slab
from lenstrace.plotting.colours import AXIS, NEGATIVE_GLASS, OUTLINE, PALETTE

# Of the height of the steepest ray on the front face: what the caustic is drawn within.
WITHIN = 1.5


def plot_rays(slab: Slab, axes: Axes) -> Axes:
    """The course of the rays, the image and the caustic, in mm."""
    height = 1.1 * abs(slab.ray_y[1:3]).max()
    plate = Rectangle((0, -height), slab.thickness, 2 * height, facecolor=NEGATIVE_GLASS, edgecolor=OUTLINE)
    axes.add_patch(plate)
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    axes.plot(slab.ray_z, slab.ray_y, color=PALETTE[0], linewidth=0.7)
    axes.plot(slab.ray_z[0, 0], 0, "o", color=PALETTE[5], markersize=5, label="source")
    axes.plot(slab.image, 0, "o", color=PALETTE[1], markersize=5, label="image near the axis")
    shown = (abs(slab.caustic_y) < WITHIN * height) & (slab.caustic_z > slab.thickness)
    if abs(slab.caustic_y).max() > 1e-9 * height:
        axes.plot(slab.caustic_z[shown], slab.caustic_y[shown], color=PALETTE[1], linewidth=2, label="caustic")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="z, mm", ylabel="y, mm", title="Rays", ylim=(-1.2 * height, 1.2 * height))
    axes.legend(loc="upper left", fontsize="small")
    return axes


def plot_spot(slab: Slab, axes: Axes) -> Axes:
    """How far the steepest ray misses the image, in mm, against the departure of the index."""
    for side, measured, theory, marker, colour in zip(
        (">", "<"), slab.spots, slab.spots_theory, "o^", (PALETTE[0], PALETTE[1]), strict=True
    ):
        axes.loglog(slab.departures, theory, color=colour, linewidth=1)
        axes.loglog(slab.departures, measured, marker, color=colour, markersize=4, label=f"n {side} −n₀")
    axes.set(
        xlabel="|n + n₀|, departure of the index from a perfect one",
        ylabel="height of the steepest ray in the image, mm",
        title="What the image loses (points: traced, lines: theory)",
    )
    axes.grid(alpha=0.3)
    axes.legend()
    return axes


PANELS = (plot_rays, plot_spot)
