"""Rays from the aplanatic point of a sphere, and what points beside it lose."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from lenstrace.phenomena.lenses.aplanatic_points import AplanaticPoints
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

MARGIN = 0.25  # radii, around what is drawn
RIGHT, TALL = 2.0, 1.6  # of the picture, radii from the centre


def plot_rays(found: AplanaticPoints, axes: Axes) -> Axes:
    """The rays, and where they seem to come from, in mm."""
    r, image = found.radius, found.image
    left, right = min(image, found.source, -r) - MARGIN * r, RIGHT * r
    axes.add_patch(Circle((0, 0), r, facecolor=GLASS, edgecolor=OUTLINE, zorder=0))
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    (_, z), (_, y) = found.ray_z, found.ray_y
    axes.plot(found.ray_z, found.ray_y, color=PALETTE[0], linewidth=0.9)
    axes.plot([z, right + 0 * z], [y, y + found.slopes * (right - z)], color=PALETTE[0], linewidth=0.9)
    axes.plot([image + 0 * z, z], [0 * y, y], color=PALETTE[0], linewidth=0.6, linestyle="--")
    axes.plot(found.source, 0, "o", color=PALETTE[5], markersize=5, label="point")
    axes.plot(image, 0, "o", color=PALETTE[1], markersize=5, label="its image")
    axes.set_aspect("equal")
    tall = max(TALL * r, (right - left) / 3)
    axes.set(xlabel="z, mm", ylabel="y, mm", title="The aplanatic point", xlim=(left, right), ylim=(-tall, tall))
    axes.legend(loc="upper left", fontsize="small")
    return axes


def plot_aberrations(found: AplanaticPoints, axes: Axes) -> Axes:
    """How far from the image by rays near the axis each ray crosses it, in mm, against its angle."""
    for source, measured, theory, colour in zip(
        found.sources, found.aberrations, found.aberrations_theory, PALETTE[1::-1] + PALETTE[2:], strict=False
    ):
        axes.plot(found.angles, theory, color=colour, linewidth=1)
        label = f"point {abs(source):.4g} mm from the centre"
        axes.plot(found.angles[::3], measured[::3], "o", color=colour, markersize=4, label=label)
    if np.all(found.sources == found.sources[-1]):
        axes.set_ylim(-found.radius, found.radius)
    axes.set(
        xlabel="angle to the axis, deg",
        ylabel="axis crossing, mm from that near the axis",
        title="Spherical aberration (lines: theory)",
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    return axes


PANELS = (plot_rays, plot_aberrations)
