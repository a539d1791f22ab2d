"""Wavefront maps: the path difference over the pupil at the primary wavelength, one panel a field, all to one scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lenstrace.analysis.wavefront import RIM, Wavefront
from lenstrace.plotting.layout import field_text
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

# Diverging, even in lightness, safe for the colour-blind: 0 is pale.
COLOURS = "RdBu_r"
# A scale never shows less, in waves.
SMALLEST = 1e-6
# Panels side by side; inches of a panel and of the colour bar.
COLUMNS, PANEL, BAR = 4, (2.7, 3.1), 1.0


def plot_wavefront(front: Wavefront, lens: Lens, axes: Sequence[Axes] | None = None) -> tuple[Axes, ...]:
    """Draw the wavefronts of the primary wavelength, ahead of the sphere in red; a lost ray leaves its cell empty.

    axes:  one for each field; without them a figure is made through pyplot. Returns them.
    Titles give RMS and peak to valley in waves; the colour bar, in waves, is the same for all.
    """
    if axes is None:
        from matplotlib import pyplot

        count = len(lens.fields.y)
        axes = wavefront_axes(pyplot.figure(figsize=wavefront_size(count), layout="constrained"), count)
    primary = lens.wavelengths.primary
    maps = pupil_maps(front)[:, primary]
    half = float(np.max(np.abs(maps), initial=SMALLEST, where=np.isfinite(maps)))
    edge = 1 + 1 / (maps.shape[-1] - 1)
    rms, valley = (np.asarray(a)[:, primary] for a in (front.rms, front.peak_to_valley))
    image = None
    for f, panel in enumerate(axes):
        image = panel.imshow(
            maps[f],
            origin="lower",
            extent=(-edge, edge, -edge, edge),
            cmap=COLOURS,
            vmin=-half,
            vmax=half,
            interpolation="nearest",
        )
        panel.set_xlabel("px")
        panel.set_ylabel("py")
        field = field_text(float(lens.fields.x[f]), float(lens.fields.y[f]), lens.fields.unit)
        figures = f"RMS {rms[f]:.3g}, P-V {valley[f]:.3g} waves" if np.isfinite(rms[f]) else "no ray arrives"
        panel.set_title(f"{field}\n{figures}", fontsize="medium")
        panel.tick_params(labelsize="small")
    if image is not None:
        bar = axes[0].figure.colorbar(image, ax=list(axes), shrink=0.8)
        bar.set_label(f"OPD, waves of {lens.wavelengths.um[primary]:g} µm")
    return tuple(axes)


def wavefront_figure(front: Wavefront, lens: Lens) -> Figure:
    """A figure of the wavefronts alone, without pyplot's global state."""
    from matplotlib.figure import Figure

    count = len(lens.fields.y)
    figure = Figure(figsize=wavefront_size(count), layout="constrained")
    plot_wavefront(front, lens, wavefront_axes(figure, count))
    if lens.name:
        figure.suptitle(lens.name, parse_math=False)
    return figure


def wavefront_size(count: int) -> tuple[float, float]:
    """Width and height in inches of the panels of so many fields."""
    return PANEL[0] * min(count, COLUMNS) + BAR, PANEL[1] * -(-count // COLUMNS)


def wavefront_axes(figure: Figure | SubFigure, count: int) -> list[Axes]:
    """Panels for so many fields, in rows from the left."""
    columns = min(count, COLUMNS)
    return [figure.add_subplot(-(-count // columns), columns, place + 1) for place in range(count)]


def pupil_maps(front: Wavefront) -> np.ndarray:
    """Path differences (F, W, samples, samples) on the square grid, rows along y, columns along x; else nan."""
    x, y, opd = (np.asarray(a)[..., RIM:] for a in (front.pupil_x, front.pupil_y, front.opd))
    # points at the edge were moved inward, some into the next cell: the inner point wins
    order = np.argsort(-np.hypot(x, y), kind="stable")
    x, y, opd = x[order], y[order], opd[..., order]
    samples = front.samples
    columns, rows = (np.rint((a + 1) * (samples - 1) / 2).astype(int) for a in (x, y))
    maps = np.full((*opd.shape[:2], samples, samples), np.nan)
    maps[..., rows, columns] = opd
    return maps
