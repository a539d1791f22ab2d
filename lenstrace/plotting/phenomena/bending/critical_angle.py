"""Rays from a point below a surface, and what part of the light is reflected inside, against the angle."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from lenstrace.phenomena.bending.critical_angle import CriticalAngle
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

LEAVING, TOTAL = PALETTE[0], PALETTE[1]


def plot_rays(critical: CriticalAngle, axes: Axes) -> Axes:
    """The rays that leave, those that are reflected totally, and the cone between them, in mm."""
    axes.add_patch(Rectangle((-6, -2), 12, 2, facecolor=GLASS))
    axes.axhline(0, color=OUTLINE, linewidth=1)
    for which, colour, name in (
        (~critical.totally, LEAVING, "leaves"),
        (critical.totally, TOTAL, "is reflected totally"),
    ):
        lines = axes.plot(critical.ray_y[:, which], critical.ray_z[:, which], color=colour, linewidth=0.9)
        if lines:
            lines[0].set_label(name)
    width = math.tan(critical.critical)
    axes.plot([-width, 0, width], [0, -1, 0], color=PALETTE[5], linestyle="--", linewidth=1.4, label="critical angle")
    axes.plot(0, -1, "o", color=PALETTE[5], markersize=5)
    axes.set(xlim=(-2.2, 2.2), ylim=(-1.2, 1.9), xlabel="y, mm", ylabel="z, mm")
    axes.set(aspect="equal", title=f"Rays of a point in n = {critical.indices[0]:g} below n = {critical.indices[1]:g}")
    axes.legend(loc="upper center", ncols=3, fontsize="small")
    return axes


def plot_reflectances(critical: CriticalAngle, axes: Axes) -> Axes:
    """Both polarizations, and natural light; points: at the angles of the traced rays, lines: theory."""
    across = np.degrees(critical.angles)
    names = (("R$_s$, across the plane", PALETTE[0]), ("R$_p$, in the plane", PALETTE[1]))
    for (name, colour), traced, theory in zip(names, critical.curves, critical.theory, strict=True):
        axes.plot(across, theory, color=colour, linewidth=1.5, label=name)
        axes.plot(across[::6], traced[::6], ".", color=colour, markersize=6)
    axes.plot(across, critical.theory.mean(0), color=AXIS, linestyle="--", linewidth=1.2, label="natural light")
    limit = math.degrees(critical.critical)
    axes.axvline(limit, color=PALETTE[5], linestyle=":", linewidth=1.2, label="critical angle")
    axes.set(xlim=(0, 90), ylim=(-0.02, 1.04), xticks=range(0, 91, 15), xlabel="angle inside, degrees")
    axes.set(ylabel="reflected part of the light", title="Reflectance (points: traced, lines: theory)")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right" if limit < 45 else "upper left", fontsize="small")
    return axes


PANELS = (plot_rays, plot_reflectances)
