"""The orders of a grating as beams, and their angles against the wavelength."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.screens.grating import Grating
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE, colours

LABELS_APART = 0.15  # radians: nearer labels would touch


def plot_orders(found: Grating, axes: Axes) -> Axes:
    """Incident, reflected and transmitted beams from one point; the glass is below."""
    axes.axhspan(-1.25, 0, color=GLASS)
    axes.plot([-1.25, 1.25], [0, 0], color=OUTLINE, linewidth=1.2)
    axes.plot([0, 0], [-1.2, 1.2], color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    into = (-np.sin(found.incidence), np.cos(found.incidence))
    axes.annotate("", (0, 0), into, arrowprops={"arrowstyle": "-|>", "color": PALETTE[5], "linewidth": 1.6})
    for angles, side, colour in ((found.transmitted, -1, PALETTE[0]), (found.reflected, 1, PALETTE[1])):
        labelled = -np.inf
        for order, angle in zip(found.orders, angles, strict=True):
            if np.isnan(angle):
                continue
            out = (np.sin(angle), side * np.cos(angle))
            axes.annotate("", out, (0, 0), arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.2})
            if angle - labelled > LABELS_APART:
                axes.text(1.1 * out[0], 1.1 * out[1], _name(order), color=colour, ha="center", va="center")
                labelled = angle
    axes.set(xlabel="y, any unit", ylabel="height above the grating, any unit", title="Orders")
    axes.set(xlim=(-1.25, 1.25), ylim=(-1.25, 1.25), aspect="equal")
    return axes


def plot_spectra(found: Grating, axes: Axes) -> Axes:
    """Angle of the transmitted orders against the wavelength."""
    for order, angles, colour in zip(found.orders, found.spectra, colours(len(found.orders)), strict=True):
        if not np.isnan(angles).all():
            axes.plot(found.spectrum, np.degrees(angles), color=colour, label=_name(order))
    axes.set(xlabel="wavelength, um", ylabel="angle behind the grating, deg", title="Dispersion of the orders")
    axes.grid(alpha=0.3)
    axes.legend(title="order", fontsize="small", loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    return axes


def _name(order: int) -> str:
    return f"{order:+d}" if order else "0"


PANELS = (plot_orders, plot_spectra)
