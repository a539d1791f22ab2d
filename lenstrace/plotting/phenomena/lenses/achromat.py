"""Focal length against wavelength: a singlet beside a doublet, and the doublet by itself."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.achromat import Achromat
from lenstrace.plotting.colours import OUTLINE

SPECTRUM = "turbo"  # from blue to red in the order of the spectrum


def plot_both(found: Achromat, axes: Axes) -> Axes:
    """Of the singlet and of the doublet, in mm."""
    for place, (name, marker) in enumerate((("singlet", "o"), ("doublet", "s"))):
        _curve(found, place, marker, axes, f"{name}, {' + '.join(found.glasses[: place + 1])}")
    axes.set_title("Focal length of thin lenses")
    axes.legend(loc="best")
    return axes


def plot_secondary(found: Achromat, axes: Axes) -> Axes:
    """Of the doublet, in mm: the secondary spectrum."""
    _curve(found, 1, "s", axes, "doublet")
    axes.set_title("What the doublet leaves: the secondary spectrum")
    return axes


def _curve(found: Achromat, place: int, marker: str, axes: Axes, label: str) -> None:
    """Theory as a line, what is traced as marks in the colours of the spectrum."""
    axes.axhline(0, color="grey", linewidth=0.6)
    axes.plot(found.wavelengths, found.shifts_theory[place], color=OUTLINE, linewidth=1, zorder=1)
    colours = (found.wavelengths - found.wavelengths[0]) / np.ptp(found.wavelengths)
    axes.scatter(found.wavelengths, found.shifts[place], s=22, c=colours, marker=marker, cmap=SPECTRUM, label=label)
    axes.set(xlabel="wavelength, µm", ylabel="focal length less that at d, mm")
    axes.grid(alpha=0.3)


PANELS = (plot_both, plot_secondary)
