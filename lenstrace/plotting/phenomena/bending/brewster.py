"""The rays at Brewster's angle with the directions in which their light swings, and the reflectances."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from lenstrace.phenomena.bending.brewster import Brewster
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

ACROSS, IN_PLANE = PALETTE[0], PALETTE[1]
# Where on a ray of length 1 its polarization is drawn, and half the length of the strokes.
MARKS, STROKE = np.array([0.35, 0.55, 0.75]), 0.06
CORNER = 0.1  # side of the mark of a right angle


def plot_rays(brewster: Brewster, axes: Axes) -> Axes:
    """The rays, of length 1: dots for light that swings across the plane of incidence, strokes for light within it."""
    axes.add_patch(Rectangle((-2, -2), 4, 2, facecolor=GLASS))
    axes.axhline(0, color=OUTLINE, linewidth=1)
    axes.plot([0, 0], [-1.1, 1.1], color=AXIS, linewidth=0.9, linestyle=(0, (6, 4)))
    angle, bent = brewster.polarizing, brewster.refracted
    rays = (
        (-math.sin(angle), math.cos(angle), "incident", angle, True),
        (math.sin(angle), math.cos(angle), "reflected", angle, False),
        (math.sin(bent), -math.cos(bent), "refracted", bent, True),
    )
    for x, y, name, of_ray, both in rays:
        axes.plot([0, x], [0, y], color=PALETTE[5], linewidth=1.2)
        axes.plot(MARKS * x, MARKS * y, "o", color=ACROSS, markersize=5)
        if both:
            strokes = np.add.outer([-STROKE, STROKE], 0 * MARKS)
            axes.plot(MARKS * x - strokes * y, MARKS * y + strokes * x, color=IN_PLANE, linewidth=2)
        words = f"{name} {round(math.degrees(of_ray), 2):g}°"
        axes.text(max(-0.88, min(0.88, x)), y + math.copysign(0.1, y), words, ha="center", va="center")
    sides = np.array([rays[1][:2], rays[2][:2]])
    axes.plot(*(CORNER * np.array([sides[0], sides.sum(0), sides[1]])).T, color=OUTLINE, linewidth=1)
    axes.text(-1.25, 1.2, "n = 1", va="center")
    axes.text(-1.25, -1.2, f"n = {brewster.index:g}", va="center")
    axes.plot([], [], "o", color=ACROSS, markersize=5, label="across the plane (s)")
    axes.plot([], [], color=IN_PLANE, linewidth=2, label="in the plane (p)")
    axes.set(xlim=(-1.35, 1.35), ylim=(-1.35, 1.35), xlabel="along the surface", ylabel="across the surface")
    axes.set(aspect="equal", title="Rays at Brewster's angle (of length 1)")
    axes.legend(loc="center left", bbox_to_anchor=(0, 0.3), fontsize="small")
    return axes


def plot_reflectances(brewster: Brewster, axes: Axes) -> Axes:
    """Both polarizations, natural light, and light from all sides; points: measured, lines: theory."""
    across = np.degrees(brewster.angles)
    for name, colour, found, theory in zip(
        ("R$_s$", "R$_p$"), (ACROSS, IN_PLANE), brewster.curves, brewster.theory, strict=True
    ):
        axes.plot(across, theory, color=colour, linewidth=1.5, label=name)
        axes.plot(across[::5], found[::5], ".", color=colour, markersize=6)
    axes.plot(across, brewster.theory.mean(0), color=AXIS, linestyle="--", linewidth=1.2, label="natural light")
    axes.axhline(brewster.diffuse, color=PALETTE[2], linewidth=1.2, label="light from all sides")
    axes.axvline(
        math.degrees(brewster.polarizing), color=PALETTE[5], linestyle=":", linewidth=1.2, label="Brewster's angle"
    )
    axes.set(xlim=(0, 90), ylim=(-0.02, 1.02), xticks=range(0, 91, 15), xlabel="angle of incidence, degrees")
    axes.set(ylabel="reflected part of the light", title="Reflectance (points: measured, lines: theory)")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", fontsize="small")
    return axes


PANELS = (plot_rays, plot_reflectances)
