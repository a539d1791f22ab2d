"""Curves of spot sizes: against the height of the field, and against the wavelength."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from lenstrace.analysis.spot_curves import SpotField, SpotSpectrum
from lenstrace.plotting.colours import colours
from lenstrace.plotting.layout import FIELD_TITLES, field_text
from lenstrace.plotting.spots import LARGE, UM_PER_MM, wavelength_styles
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.axes import Axes

POLYCHROMATIC = "#000000"


def plot_spot_field(curves: SpotField, lens: Lens, axes: Axes | None = None) -> Axes:
    """RMS spot against field, a line for each wavelength and a thicker one for all together; returns the axes. Without
    axes a figure is made through pyplot."""
    axes = new_axes() if axes is None else axes
    x, y, rms = (np.asarray(each) for each in (curves.x, curves.y, curves.rms))
    # in one plane its own coordinate, with its sign; else the distance from the axis
    height = y if not x.any() else x if not y.any() else np.hypot(x, y)
    unit, scale = size_unit(rms)
    for w, um in enumerate(lens.wavelengths.um):
        _line(axes, height, rms[:, w] * scale, wavelength_styles(lens.wavelengths.um)[w][0], f"{um:g} µm")
    if len(lens.wavelengths.um) > 1:
        _line(axes, height, np.asarray(curves.polychromatic) * scale, POLYCHROMATIC, "all wavelengths", width=2.2)
    axes.set_xlabel(f"{FIELD_TITLES[lens.fields.kind]}, {lens.fields.unit}")
    return finished(axes, f"RMS spot, {unit}")


def plot_spot_spectrum(curves: SpotSpectrum, lens: Lens, axes: Axes | None = None) -> Axes:
    """RMS spot against wavelength, a line for each field; returns the axes. Without axes a figure is made through
    pyplot."""
    axes = new_axes() if axes is None else axes
    um, rms = np.asarray(curves.um), np.asarray(curves.rms)
    unit, scale = size_unit(rms)
    for text, colour, row in zip(field_texts(lens), colours(len(rms)), rms, strict=True):
        _line(axes, um, row * scale, colour, text)
    axes.set_xlabel("wavelength, µm")
    return finished(axes, f"RMS spot, {unit}")


def new_axes() -> Axes:
    """Axes of a figure made through pyplot."""
    from matplotlib import pyplot

    return pyplot.subplots(figsize=(6, 4), layout="constrained")[1]


def finished(axes: Axes, label: str) -> Axes:
    """Axes of sizes: from 0 up, named, with a legend."""
    axes.set_ylabel(label)
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small", frameon=False)
    return axes


def size_unit(sizes: Any) -> tuple[str, float]:
    """The unit in which sizes given in mm are read, and how many of it make a mm."""
    finite = np.asarray(sizes)[np.isfinite(sizes)]
    return ("mm", 1.0) if finite.size and finite.max() > LARGE else ("µm", UM_PER_MM)


def field_texts(lens: Lens) -> list[str]:
    """Every field with its unit."""
    fields = lens.fields
    return [field_text(float(x), float(y), fields.unit) for x, y in zip(fields.x, fields.y, strict=True)]


def _line(axes: Axes, x: np.ndarray, y: np.ndarray, colour: str, label: str, width: float = 1.3) -> None:
    """A curve; a curve of one point is a dot."""
    axes.plot(x, y, color=colour, linewidth=width, marker="o" if len(x) == 1 else "", label=label)
