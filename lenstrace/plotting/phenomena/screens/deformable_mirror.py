"""A wavefront before and behind a deformable mirror, and what is left of it against the number of actuators."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.screens.deformable_mirror import DeformableMirror
from lenstrace.plotting.colours import PALETTE

ROUNDING = 1e-12  # of what came: nothing is left


def plot_wavefronts(found: DeformableMirror, axes: Axes) -> Axes:
    """The left half before, the right half behind the mirror, in um."""
    both = np.where(found.x < 0, found.before, found.behind)
    largest = float(np.nanmax(abs(found.before)))
    image = axes.pcolormesh(found.x, found.x, both, cmap="PuOr", vmin=-largest, vmax=largest, shading="nearest")
    axes.figure.colorbar(image, ax=axes, label="path, um")
    axes.axvline(0, color=PALETTE[5], linewidth=1)
    axes.set(xlabel="x, mm", ylabel="y, mm", title=f"{found.name or 'Wavefront'}: before | behind the mirror")
    axes.set_aspect("equal")
    return axes


def plot_left(found: DeformableMirror, axes: Axes) -> Axes:
    """What the mirror leaves of every polynomial, by radial order."""
    seen = found.left > ROUNDING
    axes.semilogy(found.orders[seen], found.left[seen], "o", color=PALETTE[0], markersize=4)
    axes.set(
        xlabel="radial order of the polynomial",
        ylabel="RMS path left over, of what came",
        title=f"What {found.actuators} x {found.actuators} actuators follow",
    )
    if not seen.all():
        orders = ", ".join(map(str, np.unique(found.orders[~seen])))
        axes.text(0.03, 0.95, f"orders {orders}: less than {ROUNDING:g}", transform=axes.transAxes, va="top")
    axes.grid(alpha=0.3, which="both")
    return axes


PANELS = (plot_wavefronts, plot_left)
