"""Rays through a Cartesian oval, and how far those of perfect surfaces, and of a sphere, miss the image."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.cartesian_oval import SURFACES, CartesianOval
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

TALL = 0.33  # of the width of the picture: half its height
EVERY = 4  # which rays are drawn
NOTHING = 1e-17  # mm: where a miss of 0 is drawn on the logarithmic scale


def plot_rays(found: CartesianOval, axes: Axes) -> Axes:
    """The two points, the oval and the rays, in mm."""
    tall = TALL * (found.source + found.image)
    z, y = found.profile.T
    right = 1.05 * found.image
    axes.fill([*z, right, right], [*y, y[-1], y[0]], facecolor=GLASS, zorder=0)
    axes.plot(z, y, color=OUTLINE, linewidth=1.6)
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    axes.plot(found.ray_z[:, ::EVERY], found.ray_y[:, ::EVERY], color=PALETTE[0], linewidth=0.8)
    axes.plot(-found.source, 0, "o", color=PALETTE[5], markersize=5, label="point")
    axes.plot(found.image, 0, "o", color=PALETTE[1], markersize=5, label="image")
    axes.set_aspect("equal")
    axes.set(xlabel="z, mm", ylabel="y, mm", title="A Cartesian oval", xlim=(-1.05 * found.source, right))
    axes.set_ylim(-tall, tall)
    axes.legend(loc="upper left", fontsize="small")
    return axes


def plot_misses(found: CartesianOval, axes: Axes) -> Axes:
    """Height of each ray at the image, in mm."""
    upper = found.apertures > 0
    aperture = found.apertures[upper]
    axes.semilogy(aperture, abs(found.sphere_theory[upper]), color=PALETTE[5], linewidth=1)
    axes.semilogy(
        aperture, abs(found.sphere[upper]), "o", color=PALETTE[5], markersize=4, label="a sphere (line: theory)"
    )
    for name, misses, colour in zip(SURFACES, found.misses, PALETTE, strict=False):
        axes.semilogy(aperture, np.maximum(abs(misses[upper]), NOTHING), ".", color=colour, label=name)
    axes.set(
        xlabel="sine of the ray, or height of the beam by focal distance",
        ylabel="height at the image, mm",
        title="What is left of the image",
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small", loc="center right")
    return axes


PANELS = (plot_rays, plot_misses)
