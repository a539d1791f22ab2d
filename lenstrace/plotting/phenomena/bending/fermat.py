"""A ray and a path beside it, and how the optical path changes where corners are displaced."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.bending.fermat import Fermat
from lenstrace.plotting.colours import GLASS, OUTLINE, PALETTE, colours

# From so many the legend has two columns.
MANY_LABELS = 16


def plot_path(found: Fermat, axes: Axes) -> Axes:
    """The surfaces, the path of the ray and one beside it, in mm."""
    z, y = found.profiles
    for place in found.filled:
        outline = np.concatenate([found.profiles[..., place], found.profiles[:, ::-1, place + 1]], 1)
        axes.fill(*outline, color=GLASS, linewidth=0)
    axes.plot(z, y, color=OUTLINE, linewidth=1)
    axes.plot(*found.neighbour, "--", color=PALETTE[1], linewidth=1.2, label="a neighbour")
    axes.plot(*found.path, "o-", color=PALETTE[0], linewidth=1.4, markersize=3.5, label="ray")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="z, mm", ylabel="y, mm", title="The path of the ray, and one beside it")
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.15), ncols=2, frameon=False)
    return axes


def plot_difference(found: Fermat, axes: Axes) -> Axes:
    """What displacements add to the optical path, in wavelengths, against the displacement, in mm."""
    labels = [*(f"surface {number}" for number in found.surfaces), "all, softest"]
    shown = colours(len(labels))
    for i, label in enumerate(labels):
        axes.plot(found.shifts[i], found.waves_theory[i], color=shown[i], linewidth=1)
        axes.plot(
            found.shifts[i], found.waves[i], "os"[i == len(labels) - 1], color=shown[i], markersize=3, label=label
        )
    axes.set(
        xlabel="displacement of a corner along its surface, mm",
        ylabel="optical path difference, wavelengths",
        title="Path difference (points: paths, lines: closed form)",
    )
    axes.locator_params(axis="x", nbins=5)
    axes.grid(alpha=0.3)
    axes.legend(
        loc="upper left", bbox_to_anchor=(1, 1), frameon=False, fontsize="small", ncols=1 + len(labels) // MANY_LABELS
    )
    return axes


PANELS = (plot_path, plot_difference)
