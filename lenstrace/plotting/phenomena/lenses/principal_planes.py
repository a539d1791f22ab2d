"""A lens with its cardinal points and the two rays that define them; its conjugates on Newton's hyperbola."""

from __future__ import annotations

from textwrap import fill

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.principal_planes import MAGNIFICATIONS, PrincipalPlanes
from lenstrace.plotting.cardinal import plot_first_order
from lenstrace.plotting.colours import PALETTE
from lenstrace.plotting.layout import plot_layout
from lenstrace.plotting.phenomena.lenses.frame import frame

NAMES = ("comes in parallel", "goes out parallel")
LIMIT = 5.4  # of X / f: the largest magnification, and room for its label
TITLE_WIDTH = 44  # characters


def plot_planes(found: PrincipalPlanes, axes: Axes) -> Axes:
    """The lens, its points and planes; the key rays, bent in the vertex planes, as rays near the axis are, and (dashed)
    in the principal planes; mm."""
    plot_layout(found.layout, axes)
    axes.set_title(fill(found.layout.name, TITLE_WIDTH), parse_math=False)
    for ray, construction, colour, name in zip(found.rays, found.constructions, PALETTE, NAMES, strict=False):
        axes.plot(*construction.T, color=colour, linewidth=0.9, linestyle="--")
        axes.plot(*ray.T, color=colour, linewidth=1.3, label=name)
    plot_first_order(found.points, axes, wavelength=found.primary)
    frame(axes, found.shown, max(surface.semi_diameter for surface in found.layout.surfaces if surface.bends))
    axes.legend(loc="upper left", fontsize="small")
    return axes


def plot_conjugates(found: PrincipalPlanes, axes: Axes) -> Axes:
    """Image against object, each from its focal point in focal lengths."""
    line = np.geomspace(1 / LIMIT, LIMIT, 100)
    for side in (-1, 1):
        axes.plot(side * line, side / line, color=PALETTE[0], linewidth=1, label="X X' = f f'" if side > 0 else None)
    axes.plot(found.objects, found.images, "o", color=PALETTE[1], markersize=5, label="traced")
    for m, x, y in zip(MAGNIFICATIONS, found.objects, found.images, strict=True):
        axes.annotate(
            f"m = {m:g}".replace("-", "−"), (x, y), xytext=(5, 4), textcoords="offset points", fontsize="x-small"
        )
    axes.axhline(0, color="grey", linewidth=0.6)
    axes.axvline(0, color="grey", linewidth=0.6)
    axes.set(
        xlabel="X / f, object from F",
        ylabel="X' / f', image from F'",
        title="Conjugates",
        xlim=(-LIMIT, LIMIT),
        ylim=(-LIMIT, LIMIT),
    )
    axes.legend(loc="upper left")
    return axes


PANELS = (plot_planes, plot_conjugates)
