"""Rays over a hot road, and what the eye sees of an object behind it."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.bending.mirage import Mirage
from lenstrace.plotting.colours import AXIS, OUTLINE, PALETTE

EVERY = 4  # ray to the object is drawn
UPRIGHT, INVERTED, WARM = PALETTE[0], PALETTE[1], "#FBE3D0"


def plot_rays(found: Mirage, axes: Axes) -> Axes:
    """The course of the rays from the eye, in m; the heights are drawn many times too large."""
    top = 1.2 * max(found.heights.max(), found.ray_y[0, 0])
    axes.axhspan(0, min(found.layer, top), color=WARM, label="warm layer")
    axes.axhline(0, color=OUTLINE, linewidth=2)
    for chosen, colour, label in _halves(found):
        which = np.flatnonzero(chosen)[::EVERY]
        axes.plot(found.ray_z[:, which], found.ray_y[:, which], color=colour, linewidth=0.8)
        axes.plot([], [], color=colour, linewidth=1.5, label=label)
    axes.plot(0, found.ray_y[0, 0], "o", color=PALETTE[5], markersize=6, label="eye")
    foot, head = (found.ray_z[-1, 0], 0), (found.ray_z[-1, 0], found.heights.max())
    axes.plot(*zip(foot, head, strict=True), color=OUTLINE, linewidth=4, solid_capstyle="butt", label="object")
    axes.set(
        xlabel="distance, m",
        ylabel="height, m",
        title="Rays (heights exaggerated)",
        ylim=(-0.03 * top, top),
    )
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.15), ncols=3, frameon=False)
    return axes


def plot_image(found: Mirage, axes: Axes) -> Axes:
    """Under which angle the eye sees a point of the object, in degrees, against the height of the point, in m."""
    angles = np.degrees(found.angles)
    axes.axhline(0, color=AXIS, linewidth=0.8)
    axes.plot(found.heights_theory, angles, color=OUTLINE, linewidth=1, label="closed form")
    for chosen, colour, label in _halves(found):
        axes.plot(found.heights[chosen], angles[chosen], "o", color=colour, markersize=3.5, label=label)
    axes.set(
        xlabel="height of the point of the object, m",
        ylabel="angle above the horizontal, deg",
        title="What the eye sees (points: traced)",
        xlim=(0, None),
    )
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.15), ncols=3, frameon=False)
    return axes


def _halves(found: Mirage) -> list[tuple[np.ndarray, str, str]]:
    """Which rays there are of each kind, their colour and what they are."""
    kinds = ((~found.inverted, UPRIGHT, "seen upright"), (found.inverted, INVERTED, "upside down"))
    return [kind for kind in kinds if kind[0].any()]


PANELS = (plot_rays, plot_image)
