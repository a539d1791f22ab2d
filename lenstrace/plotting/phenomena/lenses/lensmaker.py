"""A lens with its beam, and its focal length against thickness."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.lensmaker import Lensmaker
from lenstrace.plotting.colours import PALETTE
from lenstrace.plotting.layout import plot_layout


def plot_lens(found: Lensmaker, axes: Axes) -> Axes:
    """The lens and a beam, up to its focus."""
    plot_layout(found.drawing, axes)
    axes.legend().remove()
    axes.set_title("A beam along the axis")
    return axes


def plot_thickness(found: Lensmaker, axes: Axes) -> Axes:
    """Focal length against thickness."""
    axes.axhline(found.thin, color=PALETTE[5], linestyle="--", linewidth=1, label="without thickness")
    axes.plot(found.thicknesses, found.theory, color=PALETTE[0], label="lensmaker's equation")
    axes.plot(found.thicknesses[::3], found.focal_lengths[::3], "o", color=PALETTE[1], markersize=4, label="traced")
    axes.set(xlabel="thickness, mm", ylabel="focal length, mm", title="What thickness does")
    axes.grid(alpha=0.3)
    axes.legend()
    return axes


PANELS = (plot_lens, plot_thickness)
