"""Field curvature, distortion, colour, illumination and angles of incidence, one panel each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lenstrace.analysis.colour import AxialColour, LateralColour, LongitudinalAberration
from lenstrace.analysis.distortion import Distortion, DistortionGrid
from lenstrace.analysis.field_curvature import FieldCurvature
from lenstrace.analysis.illumination import Illumination, IncidenceAngles
from lenstrace.plotting.colours import PALETTE, colours
from lenstrace.plotting.layout import FIELD_TITLES
from lenstrace.plotting.spots import SPECTRUM
from lenstrace.sequential.lens import Lens

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Result = (
    FieldCurvature
    | Distortion
    | DistortionGrid
    | LateralColour
    | LongitudinalAberration
    | AxialColour
    | Illumination
    | IncidenceAngles
)
# Panels side by side; inches of a panel. Horizontal axes show at least this much, mm or percent: rounding is no curve.
COLUMNS, PANEL = 4, (3.5, 3.6)
LEAST = 1e-4


def plot_field_curvature(result: FieldCurvature, lens: Lens, axes: Axes | None = None) -> Axes:
    """Tangential (solid) and sagittal (dashed) foci against field; a colour for each wavelength. Returns the axes."""
    axes = _axes(axes)
    for w, (um, colour) in enumerate(_wavelengths(lens)):
        _curve(axes, np.asarray(result.tangential)[:, w], result.field, color=colour, label=f"{um:g} µm")
        _curve(axes, np.asarray(result.sagittal)[:, w], result.field, color=colour, linestyle="--")
    if lens.wavelengths.um:
        axes.plot([], [], color="black", label="tangential")
        axes.plot([], [], color="black", linestyle="--", label="sagittal")
    return _against_field(axes, lens, "focus from image surface, mm", "Field curvature")


def plot_distortion(result: Distortion, lens: Lens, axes: Axes | None = None) -> Axes:
    """Distortion against field, of the primary wavelength. Returns the axes."""
    axes = _axes(axes)
    angles = lens.fields.kind == "angle"
    _curve(
        axes,
        result.percent,
        result.field,
        color=PALETTE[0],
        label="from paraxial height" if angles else "from slope x height",
    )
    if np.isfinite(np.asarray(result.f_theta_percent)).any():
        _curve(axes, result.f_theta_percent, result.field, color=PALETTE[1], linestyle="--", label="f θ")
    return _against_field(axes, lens, "distortion, %", "Distortion")


def plot_distortion_grid(result: DistortionGrid, lens: Lens, axes: Axes | None = None) -> Axes:
    """The image of a square grid (marks) on the grid without distortion (lines), to scale. Returns the axes."""
    axes = _axes(axes)
    x, y = np.asarray(result.ideal_x), np.asarray(result.ideal_y)
    axes.plot(x, y, color="0.75", linewidth=0.8)
    axes.plot(x.T, y.T, color="0.75", linewidth=0.8)
    axes.plot(np.ravel(result.x), np.ravel(result.y), "x", color=PALETTE[1], markersize=4)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x, mm", ylabel="y, mm")
    axes.set_title(f"Grid, {lens.wavelengths.um[lens.wavelengths.primary]:g} µm", fontsize="medium")
    return axes


def plot_lateral_colour(result: LateralColour, lens: Lens, axes: Axes | None = None) -> Axes:
    """Chief-ray heights against that of the primary wavelength. Returns the axes."""
    axes = _axes(axes)
    for w, (um, colour) in enumerate(_wavelengths(lens)):
        _curve(axes, 1000 * np.asarray(result.height)[:, w], result.field, color=colour, label=f"{um:g} µm")
    return _against_field(axes, lens, "height from primary, µm", "Lateral colour")


def plot_longitudinal_aberration(result: LongitudinalAberration, lens: Lens, axes: Axes | None = None) -> Axes:
    """Axial crossings against pupil height; a colour for each wavelength. Returns the axes."""
    axes = _axes(axes)
    for w, (um, colour) in enumerate(_wavelengths(lens)):
        _curve(axes, np.asarray(result.z)[:, w], result.pupil, color=colour, label=f"{um:g} µm")
    return _finished(axes, "crossing from image surface, mm", "pupil height", "Longitudinal aberration")


def plot_axial_colour(result: AxialColour, lens: Lens, axes: Axes | None = None) -> Axes:
    """Paraxial focus against wavelength, from that of the primary one. Returns the axes."""
    axes = _axes(axes)
    _curve(axes, result.curve_shift, result.curve_um, color="black")
    for w, (um, colour) in enumerate(_wavelengths(lens)):
        axes.plot(np.asarray(result.shift)[w], um, "o", color=colour, label=f"{um:g} µm")
    return _finished(axes, "paraxial focus from primary, mm", "wavelength, µm", "Axial colour")


def plot_illumination(result: Illumination, lens: Lens, axes: Axes | None = None) -> Axes:
    """Relative illumination, and the part of the pupil that arrives, against field. Returns the axes."""
    axes = _axes(axes)
    axes.plot(result.field, result.relative, ".-", color=PALETTE[0], label="relative solid angle")
    axes.plot(result.field, result.fraction, ".--", color=PALETTE[1], label="part of the pupil")
    axes.set_ylim(0, 1.05 * float(np.nanmax([1.0, *result.relative])))
    axes.set(xlabel=_field_label(lens), ylabel="fraction")
    axes.set_title("Illumination", fontsize="medium")
    axes.legend(fontsize="x-small", frameon=False)
    return axes


def plot_incidence_angles(result: IncidenceAngles, lens: Lens, axes: Axes | None = None) -> Axes:
    """Largest angle at each surface, and those of the rays of the largest field and of the axis. Returns the axes."""
    from matplotlib.ticker import MaxNLocator

    axes = _axes(axes)
    surfaces = np.arange(1, len(lens) + 2)
    axes.bar(surfaces, np.asarray(result.largest), color="0.88", label="largest")
    for values, name, mark, colour in (
        (result.upper[0], "marginal, axis", "o", "black"),
        (result.chief[-1], "chief, largest field", "s", PALETTE[0]),
        (result.upper[-1], "upper, largest field", "^", PALETTE[1]),
        (result.lower[-1], "lower, largest field", "v", PALETTE[2]),
    ):
        axes.plot(surfaces, np.asarray(values), mark, color=colour, markersize=3.5, label=name)
    low, high = axes.get_ylim()
    axes.set_ylim(low, 1.4 * high)  # room for the legend
    axes.set(xlabel="surface", ylabel="angle of incidence, deg")
    axes.set_title("Incidence", fontsize="medium")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(fontsize="x-small", frameon=False)
    return axes


def field_figure(lens: Lens, results: Sequence[Result]) -> Figure:
    """A figure of these results, a panel each, without pyplot's global state."""
    from matplotlib.figure import Figure

    columns = max(min(len(results), COLUMNS), 1)
    rows = -(-len(results) // columns)
    figure = Figure(figsize=(PANEL[0] * columns, PANEL[1] * max(rows, 1)), layout="constrained")
    for place, result in enumerate(results, 1):
        _draw(result, lens, figure.add_subplot(rows, columns, place))
    if lens.name:
        figure.suptitle(lens.name, parse_math=False)
    return figure


def _draw(result: Result, lens: Lens, axes: Axes) -> Axes:
    match result:
        case FieldCurvature():
            return plot_field_curvature(result, lens, axes)
        case Distortion():
            return plot_distortion(result, lens, axes)
        case DistortionGrid():
            return plot_distortion_grid(result, lens, axes)
        case LateralColour():
            return plot_lateral_colour(result, lens, axes)
        case LongitudinalAberration():
            return plot_longitudinal_aberration(result, lens, axes)
        case AxialColour():
            return plot_axial_colour(result, lens, axes)
        case Illumination():
            return plot_illumination(result, lens, axes)
        case IncidenceAngles():
            return plot_incidence_angles(result, lens, axes)


def _axes(axes: Axes | None) -> Axes:
    if axes is not None:
        return axes
    from matplotlib import pyplot

    return pyplot.figure(figsize=PANEL, layout="constrained").add_subplot()


def _wavelengths(lens: Lens) -> list[tuple[float, str]]:
    """Each wavelength with its colour, blue to red as they rise."""
    um = lens.wavelengths.um
    count = len(um)
    ordered = colours(count)
    if count <= len(SPECTRUM):
        ordered = [SPECTRUM[round(place)] for place in np.linspace(0, len(SPECTRUM) - 1, count)]
    return [(each, ordered[rank]) for each, rank in zip(um, np.argsort(np.argsort(um)), strict=True)]


def _curve(axes: Axes, x: Any, y: Any, **style: str) -> None:
    """A line; a single point is marked."""
    axes.plot(np.asarray(x), np.asarray(y), marker="." if np.size(x) == 1 else "", linewidth=1.2, **style)  # type: ignore[arg-type]


def _field_label(lens: Lens) -> str:
    return f"{FIELD_TITLES[lens.fields.kind]}, {lens.fields.unit}"


def _against_field(axes: Axes, lens: Lens, label: str, title: str) -> Axes:
    return _finished(axes, label, _field_label(lens), title)


def _finished(axes: Axes, label: str, up: str, title: str) -> Axes:
    """Labels, the line of no aberration, and a scale that does not show rounding."""
    axes.axvline(0, color="0.6", linewidth=0.7, zorder=0)
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, -LEAST), max(high, LEAST))
    axes.locator_params(axis="x", nbins=5)
    axes.set(xlabel=label, ylabel=up)
    axes.set_title(title, fontsize="medium")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize="x-small", frameon=False)
    return axes
