"""Modulation transfer functions: contrast against spatial frequency, shift of the image, and field."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lenstrace.analysis.mtf import GeometricMtf, Mtf, ThroughFocusMtf
from lenstrace.plotting.colours import colours
from lenstrace.plotting.layout import FIELD_TITLES, field_text
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LIMIT = "#7F7F7F"
# Inches of a panel.
PANEL = (6.4, 4.4)


def plot_mtf(mtf: Mtf, lens: Lens, axes: Axes | None = None, *, geometric: GeometricMtf | None = None) -> Axes:
    """Contrast against spatial frequency, a colour for each field: tangential solid, sagittal dashed; grey, without
    aberrations (the widest of the fields); thin, by rays alone. Returns the axes."""
    axes = _new_axes(axes)
    frequency = np.asarray(mtf.frequency)
    limits = np.concatenate([np.asarray(mtf.limit_tangential), np.asarray(mtf.limit_sagittal)])
    limits = limits[np.isfinite(limits).all(-1)]
    if len(limits):
        axes.plot(frequency, limits.max(0), color=LIMIT, linewidth=1.2, label="diffraction limit")
    _pairs(axes, lens, frequency, mtf.tangential, mtf.sagittal)
    if geometric is not None:
        for f, colour in enumerate(colours(len(lens.fields.y))):
            for values, style in ((geometric.tangential, "-"), (geometric.sagittal, "--")):
                axes.plot(geometric.frequency, np.asarray(values)[f], color=colour, linestyle=style, linewidth=0.6)
        axes.plot([], [], color="black", linewidth=0.6, label="rays alone")
    axes.set_xlim(0, float(frequency.max()))
    return _finished(axes, "spatial frequency, cycles/mm")


def plot_mtf_through_focus(through: ThroughFocusMtf, lens: Lens, axes: Axes | None = None) -> Axes:
    """Contrast at one frequency against the shift of the image, a colour for each field: tangential solid, sagittal
    dashed. Returns the axes."""
    axes = _new_axes(axes)
    _pairs(axes, lens, np.asarray(through.shift), through.tangential, through.sagittal)
    axes.set_title(f"{float(through.frequency):g} cycles/mm", fontsize="medium")
    return _finished(axes, "shift of the image, mm")


def plot_mtf_field(mtf: Mtf, lens: Lens, axes: Axes | None = None) -> Axes:
    """Contrast against field, a colour for each spatial frequency: tangential solid, sagittal dashed. Returns the axes.

    Of a lens whose fields lie along y; one of few fields is drawn with straight lines between them.
    """
    axes = _new_axes(axes)
    order = np.argsort(np.array(lens.fields.y))
    field = np.array(lens.fields.y)[order]
    for k, colour in enumerate(colours(len(mtf.frequency))):
        for values, style in ((mtf.tangential, "-"), (mtf.sagittal, "--")):
            label = f"{float(mtf.frequency[k]):g} cycles/mm" if style == "-" else None
            axes.plot(field, np.asarray(values)[order, k], color=colour, linestyle=style, marker=".", label=label)
    return _finished(axes, f"{FIELD_TITLES[lens.fields.kind]}, {lens.fields.unit}")


def mtf_figure(
    mtf: Mtf, lens: Lens, *, geometric: GeometricMtf | None = None, through: Sequence[ThroughFocusMtf] = ()
) -> Figure:
    """A figure of the contrast, and through focus below it, without pyplot's global state."""
    from matplotlib.figure import Figure

    rows = 1 + len(through)
    figure = Figure(figsize=(PANEL[0], PANEL[1] * rows), layout="constrained")
    plot_mtf(mtf, lens, figure.add_subplot(rows, 1, 1), geometric=geometric)
    for place, each in enumerate(through, 2):
        plot_mtf_through_focus(each, lens, figure.add_subplot(rows, 1, place))
    if lens.name:
        figure.suptitle(lens.name, parse_math=False)
    return figure


def _pairs(axes: Axes, lens: Lens, across: np.ndarray, tangential: Any, sagittal: Any) -> None:
    for f, colour in enumerate(colours(len(lens.fields.y))):
        if not np.isfinite(np.asarray(tangential)[f]).any():
            continue
        field = field_text(float(lens.fields.x[f]), float(lens.fields.y[f]), lens.fields.unit)
        axes.plot(across, np.asarray(tangential)[f], color=colour, linewidth=1.5, label=field)
        axes.plot(across, np.asarray(sagittal)[f], color=colour, linewidth=1.5, linestyle="--")


def _finished(axes: Axes, label: str) -> Axes:
    axes.plot([], [], color="black", label="tangential")
    axes.plot([], [], color="black", linestyle="--", label="sagittal")
    axes.set(ylim=(0, 1.02), xlabel=label, ylabel="contrast")
    axes.grid(color="0.92", linewidth=0.6)
    axes.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
    return axes


def _new_axes(axes: Axes | None) -> Axes:
    if axes is not None:
        return axes
    from matplotlib import pyplot

    return pyplot.figure(figsize=PANEL, layout="constrained").add_subplot()
