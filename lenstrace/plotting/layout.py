"""The drawing of a lens: glass, mirrors, stop, image and the rays of every field in the y-z plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lenstrace.analysis.layout import Layout, RayBundle, SurfaceDrawing
from lenstrace.plotting.colours import AXIS, GLASS, IMAGE, MIRROR, NEGATIVE_GLASS, OUTLINE, SCREEN, STOP, colours

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FIELD_TITLES = {"angle": "field", "object_height": "object height", "image_height": "image height"}
# Inches: the width of a figure, what labels and legend need beside the drawing, the least and largest height.
WIDTH, BESIDE, LEAST, LARGEST = 10.0, (1.9, 1.0), 2.6, 9.0


def plot_layout(layout: Layout, axes: Axes | None = None) -> Axes:
    """Draw a layout, in mm; returns the axes. Without axes a figure is made through pyplot."""
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.figure(figsize=figure_size(layout), layout="constrained").add_subplot()
    for medium in layout.media:
        tint = GLASS if medium.index > 0 else NEGATIVE_GLASS
        axes.fill(*medium.outline.T, facecolor=tint, edgecolor=OUTLINE, linewidth=0.9, zorder=1)
    axes.plot(*layout.axis.T, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)), zorder=1.5)
    for bundle, colour in zip(layout.bundles, colours(len(layout.bundles)), strict=True):
        for ray in bundle.rays:
            axes.plot(*ray.T, color=colour, linewidth=0.8, zorder=2)
        axes.plot([], [], color=colour, linewidth=1.6, label=_field_label(bundle, layout))
    for surface in layout.surfaces:
        _draw_surface(surface, axes)
    axes.set_aspect("equal")
    axes.margins(0.03, 0.05)
    axes.set_xlabel("z, mm")
    axes.set_ylabel("y, mm")
    axes.set_title(layout.name, parse_math=False)
    if layout.bundles:
        axes.legend(
            title=FIELD_TITLES[layout.field_kind],
            loc="upper left",
            bbox_to_anchor=(1.01, 1.0),
            borderaxespad=0.0,
            frameon=False,
            fontsize="small",
            title_fontsize="small",
            alignment="left",
        )
    return axes


def layout_figure(layout: Layout) -> Figure:
    """A figure of the layout alone, sized to its proportions, without pyplot's global state."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=figure_size(layout), layout="constrained")
    plot_layout(layout, figure.add_subplot())
    return figure


def figure_size(layout: Layout) -> tuple[float, float]:
    """Width and height in inches that suit the proportions of the drawing."""
    points = np.concatenate(
        [layout.axis]
        + [surface.profile for surface in layout.surfaces if surface.bends or surface.is_image]
        + [ray for bundle in layout.bundles for ray in bundle.rays]
    )
    width, height = np.ptp(points[np.isfinite(points[:, 0])], axis=0)
    beside, above = BESIDE
    wanted = above + (WIDTH - beside) * float(height / width)
    return WIDTH, min(max(wanted, LEAST), LARGEST)


def field_text(x: float, y: float, unit: str) -> str:
    """A field with its unit, as a person writes it: y, or (x, y)."""
    number = f"{y:.5g}" if x == 0 else f"({x:.5g}, {y:.5g})"
    return f"{number}°" if unit == "deg" else f"{number} {unit}"


def _field_label(bundle: RayBundle, layout: Layout) -> str:
    text = field_text(*bundle.field, layout.field_unit)
    return text if bundle.rays else f"{text} (no rays)"


def _draw_surface(surface: SurfaceDrawing, axes: Axes) -> None:
    """The lines of one surface; a plane that does nothing leaves none."""
    from matplotlib.collections import LineCollection

    if surface.is_mirror:
        axes.plot(*surface.profile.T, color=MIRROR, linewidth=2.0, zorder=3)
        axes.add_collection(LineCollection(list(surface.hatching), colors=MIRROR, linewidths=0.6, zorder=2.9))
    elif surface.is_image:
        axes.plot(*surface.profile.T, color=IMAGE, linewidth=1.4, zorder=3)
    elif surface.bends:
        axes.plot(*surface.profile.T, color=OUTLINE, linewidth=0.9, zorder=2.5)
    for bar in surface.bars:
        axes.plot(*bar.T, color=STOP if surface.is_stop else SCREEN, linewidth=2.6, solid_capstyle="butt", zorder=3)
