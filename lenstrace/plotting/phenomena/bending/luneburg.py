"""A beam through a Luneburg lens, and what its accuracy costs."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.bending.luneburg import Luneburg
from lenstrace.plotting.colours import AXIS, OUTLINE, PALETTE

SIDE = 201  # points along a side of the picture of the index


def plot_rays(found: Luneburg, axes: Axes) -> Axes:
    """The ball, darker where its index is higher, and the rays; mm."""
    side = np.linspace(-1, 1, SIDE)
    r2 = side**2 + side[:, None] ** 2
    index = np.where(r2 <= 1, np.sqrt(np.maximum(2 - r2, 0)), np.nan)
    edges = side * found.radius
    image = axes.pcolormesh(edges, edges, index, cmap="Blues", vmin=1, vmax=2, shading="nearest", rasterized=True)
    axes.figure.colorbar(image, ax=axes, label="refractive index")
    turn = np.linspace(0, 2 * np.pi, SIDE)
    axes.plot(found.radius * np.cos(turn), found.radius * np.sin(turn), color=OUTLINE, linewidth=1)
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    axes.plot(found.ray_z, found.ray_y, color=PALETTE[1], linewidth=0.8)
    axes.set(xlabel="z from the centre, mm", ylabel="y, mm", title="Luneburg lens")
    axes.set_aspect("equal")
    return axes


def plot_cost(found: Luneburg, axes: Axes) -> Axes:
    """Error against what it cost."""
    axes.loglog(found.evaluations, found.errors, "o-", color=PALETTE[0], linewidth=1)
    axes.set(xlabel="evaluations of the gradient", ylabel="largest miss of the focus, mm", title="What accuracy costs")
    axes.grid(alpha=0.3, which="both")
    return axes


PANELS = (plot_rays, plot_cost)
