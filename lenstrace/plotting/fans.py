"""Ray fans: transverse aberration and path difference across the pupil, four panels a field, all to one scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lenstrace.analysis.conditions import image_is_far
from lenstrace.analysis.fans import Fans
from lenstrace.plotting.layout import field_text
from lenstrace.plotting.spots import wavelength_styles
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

# What panels of a field show, and across which coordinate of the pupil.
PANELS = (("ey", "py"), ("ex", "px"), ("OPD", "py"), ("OPD", "px"))
UNITS = (("mm", 1.0), ("µm", 1e3), ("nm", 1e6))
ANGLES = (("rad", 1.0), ("mrad", 1e3), ("µrad", 1e6))
# A unit is taken when the largest number is at least this in it; no scale shows less than the other, in mm, radians or
# waves.
READABLE, SMALLEST = 1.0, 1e-9
# Inches: a panel, and the legend beside them.
PANEL, LEGEND = (2.5, 2.1), 1.3
ZERO = "#8C8C8C"


def plot_fans(fans: Fans, lens: Lens, axes: Sequence[Axes] | None = None) -> tuple[Axes, ...]:
    """Draw both fans of every field, a line for each wavelength; a lost ray leaves a gap.

    axes:  four for each field: transverse aberration against py and px, then path difference against py and px.
           Without them a figure is made through pyplot. Returns them.
    """
    if axes is None:
        from matplotlib import pyplot

        count = len(lens.fields.y)
        axes = fan_axes(pyplot.figure(figsize=fans_size(count), layout="constrained"), count)
    pupil = np.asarray(fans.pupil)
    across = [np.asarray(fans.tangential.y), np.asarray(fans.sagittal.x)]
    paths = [np.asarray(fans.tangential.opd), np.asarray(fans.sagittal.opd)]
    unit, scale = unit_of(across, angles=image_is_far(lens))
    curves = [values * scale for values in across] + paths
    halves = [_half(curves[:2])] * 2 + [_half(paths)] * 2
    units = [unit, unit, "waves", "waves"]
    for place, panel in enumerate(axes):
        field, kind = divmod(place, len(PANELS))
        for w, (colour, _) in enumerate(wavelength_styles(lens.wavelengths.um)):
            label = f"{lens.wavelengths.um[w]:g} µm"
            panel.plot(pupil, curves[kind][field, w], color=colour, linewidth=1.2, label=label)
        panel.axhline(0, color=ZERO, linewidth=0.6, zorder=1)
        panel.axvline(0, color=ZERO, linewidth=0.6, zorder=1)
        panel.set(xlim=(-1, 1), ylim=(-1.1 * halves[kind], 1.1 * halves[kind]))
        name, coordinate = PANELS[kind]
        panel.set_xlabel(coordinate)
        panel.set_ylabel(f"{name}, {units[kind]}")
        panel.tick_params(labelsize="small")
        if kind == 0:
            text = field_text(float(lens.fields.x[field]), float(lens.fields.y[field]), lens.fields.unit)
            panel.set_title(text, fontsize="medium", loc="left")
    axes[len(PANELS) - 1].legend(
        loc="upper left", bbox_to_anchor=(1.03, 1.0), borderaxespad=0.0, frameon=False, fontsize="small"
    )
    return tuple(axes)


def fans_figure(fans: Fans, lens: Lens) -> Figure:
    """A figure of the fans alone, without pyplot's global state."""
    from matplotlib.figure import Figure

    count = len(lens.fields.y)
    figure = Figure(figsize=fans_size(count), layout="constrained")
    plot_fans(fans, lens, fan_axes(figure, count))
    if lens.name:
        figure.suptitle(lens.name, parse_math=False)
    return figure


def fans_size(count: int) -> tuple[float, float]:
    """Width and height in inches of the panels of so many fields."""
    return PANEL[0] * len(PANELS) + LEGEND, PANEL[1] * count + 0.5


def fan_axes(figure: Figure | SubFigure, count: int) -> list[Axes]:
    """Panels for so many fields, a row each."""
    return [figure.add_subplot(count, len(PANELS), place + 1) for place in range(count * len(PANELS))]


def unit_of(values: Sequence[np.ndarray], *, angles: bool) -> tuple[str, float]:
    """The unit in which transverse aberrations are read, and how many of it make a mm (angles: a radian)."""
    largest = _half(values)
    units = ANGLES if angles else UNITS
    return next((each for each in units if largest * each[1] >= READABLE), units[1])


def _half(values: Sequence[np.ndarray]) -> float:
    """The largest size of numbers, of which some are nan."""
    return max(float(np.max(np.abs(each), initial=SMALLEST, where=np.isfinite(each))) for each in values)
