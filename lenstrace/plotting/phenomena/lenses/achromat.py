"""Focal length against wavelength, of a single lens and of an achromatic doublet."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.achromat import Achromat
from lenstrace.plotting.colours import AXIS, PALETTE


def plot_both(found: Achromat, axes: Axes) -> Axes:
    """Both in one scale."""
    _plot(
        found,
        axes,
        (("singlet", found.singlet, found.singlet_theory), ("doublet", found.doublet, found.doublet_theory)),
    )
    axes.set_title("Longitudinal colour")
    return axes


def plot_doublet(found: Achromat, axes: Axes) -> Axes:
    """The doublet alone: its secondary spectrum."""
    _plot(found, axes, (("doublet", found.doublet, found.doublet_theory),), first=1)
    axes.set_title("What the doublet leaves: the secondary spectrum")
    return axes


def _plot(found: Achromat, axes: Axes, curves: tuple, first: int = 0) -> None:
    for place, (name, measured, theory) in enumerate(curves, first):
        axes.plot(found.wavelengths, theory, color=PALETTE[place], linewidth=1)
        axes.plot(found.wavelengths[::4], measured[::4], "o^"[place], color=PALETTE[place], markersize=4, label=name)
    for line, name in zip(found.lines, "FdC", strict=True):
        axes.axvline(line, color=AXIS, linestyle=":", linewidth=1)
        axes.annotate(name, (line, 1), xycoords=("data", "axes fraction"), xytext=(2, -11), textcoords="offset points")
    axes.set(xlabel="wavelength, um", ylabel="focus from that of d light, mm")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right")


PANELS = (plot_both, plot_doublet)
