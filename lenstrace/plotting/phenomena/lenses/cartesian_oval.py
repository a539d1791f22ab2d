"""Rays through an oval, and how well it, an ellipsoid and a sphere make an image."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.cartesian_oval import CartesianOval
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

NAMES = ("oval, point to point", "ellipsoid, beam to point", "sphere, point to point")
ROUNDING = 1e-17  # mm: what is drawn where a ray misses by nothing


def plot_rays(found: CartesianOval, axes: Axes) -> Axes:
    """The oval and its rays, in mm; the glass reaches to the image."""
    z, y, end = found.profile_z, found.profile_y, found.ray_z[-1, 0]
    axes.fill(np.append(z, [end * 1.1] * 2), np.append(y, [y[-1], y[0]]), color=GLASS)
    axes.plot(z, y, color=OUTLINE, linewidth=1.2)
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    axes.plot(found.ray_z, found.ray_y, color=PALETTE[0], linewidth=0.7)
    axes.plot([found.ray_z[0, 0], end], [0, 0], "o", color=PALETTE[5], markersize=4)
    axes.set(xlabel="z, mm", ylabel="y, mm", title="A Cartesian oval")
    axes.set_aspect("equal", adjustable="datalim")
    return axes


def plot_misses(found: CartesianOval, axes: Axes) -> Axes:
    """By how much each ray misses the image."""
    for name, heights, misses, marker, colour in zip(NAMES, found.heights, found.misses, "o^s", PALETTE, strict=False):
        axes.semilogy(heights, misses.clip(ROUNDING), marker, color=colour, markersize=4, label=name)
    axes.set(xlabel="height of the ray on the surface, mm", ylabel="misses the image by, mm", title="Perfect, and not")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small", loc="center")
    return axes


PANELS = (plot_rays, plot_misses)
