"""Rays of a parabolic and of a spherical mirror, and the size of their spots."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.parabola_mirror import MIRRORS, ParabolaMirror
from lenstrace.plotting.colours import AXIS, MIRROR, PALETTE

LEFT, TALL = 1.5, 0.5  # how far the picture reaches to the left, and half its height, at least; focal lengths
WIDER, TALLER = 2.4, 1.4  # the same, in radii of the beam
NOTHING = 1e-19  # focal lengths: where a spot of 0 is drawn on the logarithmic scale


def plot_rays(found: ParabolaMirror, axes: Axes) -> Axes:
    """The rays up to the edge behind the focus, in mm: of the parabola below the axis, of the sphere above it."""
    f, beam = found.focal_length, found.heights[-1]
    edge, tall = -max(LEFT * f, WIDER * beam), max(TALL * f, TALLER * beam)
    for side, place, name in ((-1, 0, MIRRORS[0]), (1, 1, MIRRORS[1])):
        met, slope, colour = found.met[place], found.slopes[place], PALETTE[place]
        half = side * found.profile_heights >= 0
        axes.plot(found.profiles[place, half], found.profile_heights[half], color=MIRROR, linewidth=2.5)
        z = np.array([edge + 0 * met, met, edge + 0 * met])
        y = side * np.array([found.heights, found.heights, found.heights + slope * (edge - met)])
        axes.plot(z, y, color=colour, linewidth=0.8)
        axes.plot([], [], color=colour, label=name)
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    axes.plot(-f, 0, "o", color=PALETTE[5], markersize=4, label="focus")
    axes.set_aspect("equal")
    axes.set(
        xlabel="z, mm", ylabel="y, mm", title="Rays of a star on the axis", xlim=(edge, -edge / 10), ylim=(-tall, tall)
    )
    axes.legend(loc="upper left", fontsize="small", ncols=3)
    return axes


def plot_spots(found: ParabolaMirror, axes: Axes) -> Axes:
    """Radius and RMS of the spots in the focal plane, in focal lengths, against the radius of the beam."""
    f = found.focal_length
    axes.loglog(found.apertures, found.largest_theory / f, color=PALETTE[1], linewidth=1)
    axes.loglog(found.apertures, found.rms_theory / f, color=PALETTE[1], linewidth=1)
    for place, (name, colour) in enumerate(zip(MIRRORS, PALETTE, strict=False)):
        largest, rms = (np.maximum(spots[place] / f, NOTHING) for spots in (found.largest, found.rms))
        axes.loglog(found.apertures, largest, "o", color=colour, markersize=4, label=f"{name}: radius")
        axes.loglog(found.apertures, rms, "^", color=colour, markersize=4, mfc="none", label=f"{name}: RMS")
    axes.set(
        xlabel="radius of the beam / focal length",
        ylabel="spot in the focal plane / focal length",
        title="Spots (lines: theory, of slope 3)",
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small", loc="center right")
    return axes


PANELS = (plot_rays, plot_spots)
