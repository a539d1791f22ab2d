"""A ray at a surface: incident, reflected, refracted; and the angle behind the surface against that before it."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Rectangle

from lenstrace.phenomena.bending.snell import Snell
from lenstrace.plotting.colours import AXIS, GLASS, NEGATIVE_GLASS, OUTLINE, PALETTE

INCIDENT, REFLECTED, REFRACTED = PALETTE[5], PALETTE[1], PALETTE[0]
# Radius of the arcs of the angles, in units of the rays.
ARC = 0.3


def plot_rays(snell: Snell, axes: Axes) -> Axes:
    """The three rays in their plane, of length 1, and their angles against the normal."""
    denser = abs(snell.indices[1]) >= abs(snell.indices[0])
    colour = GLASS if snell.indices[1] > 0 else NEGATIVE_GLASS
    axes.add_patch(Rectangle((-2, -2 if denser else 0), 4, 2, facecolor=colour if denser else GLASS))
    axes.axhline(0, color=OUTLINE, linewidth=1)
    axes.plot([0, 0], [-1.1, 1.1], color=AXIS, linewidth=0.9, linestyle=(0, (6, 4)))
    _ray(axes, snell.angle, -1, 1, INCIDENT, "incident")
    _ray(axes, snell.angle, 1, 1, REFLECTED, "reflected")
    if snell.refracted is not None:
        _ray(axes, snell.refracted, 1, -1, REFRACTED, "refracted")
    for place, index in zip((1.15, -1.2), snell.indices, strict=True):
        axes.text(-1.25, place, f"n = {index:g}".replace("-", "−"), va="center")
    title = "Rays (of length 1)" + (": total reflection" if snell.refracted is None else "")
    axes.set(xlim=(-1.35, 1.35), ylim=(-1.35, 1.35), xlabel="along the surface", ylabel="across the surface")
    axes.set(aspect="equal", title=title)
    return axes


def _ray(axes: Axes, angle: float, right: int, up: int, colour: str, name: str) -> None:
    """right, up: to which side it lies, +1 or -1; the incident ray runs toward the middle."""
    x, y = right * math.sin(angle), up * math.cos(angle)
    axes.plot([0, x], [0, y], color=colour, linewidth=2)
    head, tail = (0.55, 0.65) if name == "incident" else (0.7, 0.6)
    arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 2, "mutation_scale": 16}
    axes.annotate("", (head * x, head * y), (tail * x, tail * y), arrowprops=arrow)
    edges = sorted((90 * up, math.degrees(math.atan2(y, x))))
    if edges[1] - edges[0] < 180:
        axes.add_patch(Arc((0, 0), 2 * ARC, 2 * ARC, theta1=edges[0], theta2=edges[1], color=colour))
    side = "left" if (x or right) > 0 else "right"
    words = f"{name} {abs(round(math.degrees(angle), 2)):g}°"
    # beyond its end, clear of the surface and of the frame
    place = min(0.8, max(x, -0.8)) if abs(x) > 0.5 else x
    axes.text(place, y + 0.1 * up, words, color=colour, ha=side if abs(x) < 0.5 else "center", va="center")


def plot_angles(snell: Snell, axes: Axes) -> Axes:
    """The law as a curve, in degrees."""
    across = np.degrees(snell.angles)
    axes.plot(across, np.degrees(snell.bent_theory), color=AXIS, linewidth=1.2, label="theory")
    axes.plot(across[::3], np.degrees(snell.bent[::3]), ".", color=REFRACTED, markersize=6, label="traced")
    if snell.largest < math.pi / 2:
        axes.axvspan(math.degrees(snell.largest), 90, color=AXIS, alpha=0.25, linewidth=0, label="total reflection")
    if snell.refracted is not None:
        here = math.degrees(snell.angle), math.degrees(snell.refracted)
        axes.plot(*here, "o", color=PALETTE[1], markersize=8, fillstyle="none", markeredgewidth=2, label="this ray")
    axes.set(xlim=(0, 90), xticks=range(0, 91, 15), xlabel="angle of incidence, degrees")
    axes.set(ylabel="angle of refraction, degrees", title="All angles")
    axes.grid(alpha=0.3)
    axes.legend(loc="best", fontsize="small")
    return axes


PANELS = (plot_rays, plot_angles)
