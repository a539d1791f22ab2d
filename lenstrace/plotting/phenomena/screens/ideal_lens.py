"""A beam behind the ideal and the quadratic lens, and how far each ray misses the focus."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.screens.ideal_lens import IdealLens
from lenstrace.plotting.colours import AXIS, OUTLINE, PALETTE

NAMES = ("ideal, W = f − √(f² + r²)", "quadratic, W = −r²/2f")


def plot_rays(found: IdealLens, axes: Axes) -> Axes:
    """The rays up to a little behind the focus, in mm; the two lenses above each other."""
    f, gap = found.focal_length, 2.6 * abs(found.heights).max()
    for place, (name, crossing) in enumerate(zip(NAMES, found.crossings, strict=True)):
        level, colour = -gap * place, PALETTE[place]
        axes.axhline(level, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
        axes.plot([0, 0], [level + found.heights[0], level + found.heights[-1]], color=OUTLINE, linewidth=2)
        for y, z in zip(found.heights, crossing, strict=True):
            end = 1.2 * f if f > 0 else -f / 2
            axes.plot([-abs(f) / 4, 0, end], [level + y, level + y, level + y * (1 - end / z)], color=colour, lw=0.7)
        axes.plot([], [], color=colour, label=name)
    axes.plot([f, f], [-gap, 0], "o", color=PALETTE[5], markersize=4, label="z = f")
    axes.set(xlabel="z, mm", ylabel="y, mm (the second lens is drawn below)", title="A beam along the axis")
    axes.legend(fontsize="small", loc="upper right")
    axes.set_ylim(-gap - 1.2 * gap / 2.6, 2.4 * gap / 2.6)
    return axes


def plot_crossings(found: IdealLens, axes: Axes) -> Axes:
    """Where each ray crosses the axis, in mm from the focus."""
    for name, crossing, theory, marker, colour in zip(
        NAMES, found.crossings, found.crossings_theory, "o^", PALETTE, strict=False
    ):
        axes.plot(theory - found.focal_length, found.heights, color=colour, linewidth=1)
        axes.plot(crossing - found.focal_length, found.heights, marker, color=colour, markersize=4, label=name)
    axes.set(
        xlabel="axis crossing, mm from the focus",
        ylabel="height on the screen, mm",
        title="What each ray misses (lines: theory)",
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    return axes


PANELS = (plot_rays, plot_crossings)
