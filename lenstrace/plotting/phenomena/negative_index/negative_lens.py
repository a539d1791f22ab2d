"""Rays through a hollow lens of negative index, and its spherical aberration beside that of an ordinary lens."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.negative_index.negative_lens import NegativeLens
from lenstrace.plotting.colours import AXIS, GLASS, NEGATIVE_GLASS, OUTLINE, PALETTE

POINTS = 101  # of a drawn face


def plot_rays(found: NegativeLens, axes: Axes) -> Axes:
    """The hollow lens above, the convex one below, in mm from their curved vertices."""
    tall = np.abs(found.heights).max()
    gap, end = 2.6 * tall, 1.25 * found.focal_length
    for place, tint in enumerate((NEGATIVE_GLASS, GLASS)):
        level, heights = -gap * place, found.heights[place]
        y = 1.05 * np.abs(heights).max() * np.linspace(-1, 1, POINTS)
        radius, front = found.radii[place], -found.thicknesses[place]
        z = radius - np.sign(radius) * np.sqrt(np.maximum(radius**2 - y**2, 0))
        axes.fill(np.append(z, [front, front]), level + np.append(y, [y[-1], y[0]]), facecolor=tint, edgecolor=OUTLINE)
        axes.axhline(level, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
        for y, face, crossing in zip(heights, found.faces[place], found.crossings[place], strict=True):
            after = y * (1 - (end - face) / (crossing - face))
            axes.plot(
                [front - end / 5, face, end], level + np.array([y, y, after]), color=PALETTE[place], linewidth=0.7
            )
        axes.plot([], [], color=PALETTE[place], label=f"n = {found.indices[place]:g}")
        axes.plot(found.focal_length, level, "o", color=PALETTE[5], markersize=4)
    axes.set(xlabel="z from the curved vertex, mm", ylabel="y, mm (the second lens is drawn below)")
    axes.set_title("Hollow and round, the same focal length")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(fontsize="small", loc="lower left")
    return axes


def plot_crossings(found: NegativeLens, axes: Axes) -> Axes:
    """Where each ray crosses the axis."""
    for place, marker in enumerate("o^"):
        colour, name = PALETTE[place], f"n = {found.indices[place]:g}"
        axes.plot(found.theory[place] - found.focal_length, found.heights[place], color=colour, linewidth=1)
        crossing = found.crossings[place] - found.focal_length
        axes.plot(crossing, found.heights[place], marker, color=colour, markersize=4, label=name)
    axes.set(
        xlabel="axis crossing, mm from the focus",
        ylabel="height of the ray, mm",
        title="Spherical aberration (lines: theory)",
    )
    axes.grid(alpha=0.3)
    axes.legend()
    return axes


PANELS = (plot_rays, plot_crossings)
