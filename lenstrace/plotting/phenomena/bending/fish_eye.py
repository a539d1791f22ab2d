"""The circles of Maxwell's fish-eye, and how well they meet."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.bending.fish_eye import FishEye
from lenstrace.plotting.colours import AXIS, PALETTE, colours


def plot_rays(found: FishEye, axes: Axes) -> Axes:
    """The rays from the source to its image, in mm; the circle where the index is half that at the centre."""
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    turn = np.linspace(0, 2 * np.pi, 181)
    axes.plot(found.scale * np.cos(turn), found.scale * np.sin(turn), color=AXIS, linestyle="--", label="index n₀ / 2")
    for z, y, colour in zip(found.ray_z.T, found.ray_y.T, colours(len(found.angles)), strict=True):
        axes.plot(z, y, color=colour, linewidth=0.9)
    axes.plot(found.source, 0, "o", color=PALETTE[5], markersize=5, label="source")
    axes.plot(found.image, 0, "o", color=PALETTE[1], markersize=5, label="image")
    axes.set(xlabel="z from the centre, mm", ylabel="y, mm", title="Maxwell's fish-eye")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(fontsize="small", loc="lower left")
    return axes


def plot_misses(found: FishEye, axes: Axes) -> Axes:
    """By how much each ray misses the image."""
    axes.semilogy(np.degrees(found.angles), found.misses.clip(1e-17), "o", color=PALETTE[0])
    axes.set(xlabel="angle at which the ray sets out, deg", ylabel="misses the image by, mm", title="A perfect image")
    axes.grid(alpha=0.3)
    return axes


PANELS = (plot_rays, plot_misses)
