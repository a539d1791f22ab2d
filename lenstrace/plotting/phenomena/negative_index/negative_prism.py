"""A ray through a prism of negative index beside one through ordinary glass, and the deviation of both."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from lenstrace.phenomena.negative_index.negative_prism import NegativePrism
from lenstrace.plotting.colours import AXIS, NEGATIVE_GLASS, OUTLINE, PALETTE

COLOURS = (PALETTE[1], PALETTE[0])  # of n and |n|


def plot_rays(prism: NegativePrism, axes: Axes) -> Axes:
    """The course of the rays, in mm, and the normals of the back face where they leave it."""
    axes.add_patch(
        Polygon(list(zip(prism.face_z, prism.face_y, strict=True)), facecolor=NEGATIVE_GLASS, edgecolor=OUTLINE)
    )
    half = 0.3 * (prism.ray_z[3] - prism.ray_z[2]).max()
    for index, colour, z, y in zip(prism.indices, COLOURS, prism.ray_z.T, prism.ray_y.T, strict=False):
        axes.plot(z, y, color=colour, linewidth=1.5, label=f"n = {index:g}")
        normal_z = z[2] + half, z[2] - half
        normal_y = y[2] + half * prism.normal, y[2] - half * prism.normal
        axes.plot(normal_z, normal_y, color=AXIS, linewidth=0.9, linestyle="--")
    axes.plot(prism.ray_z[:2, 0], prism.ray_y[:2, 0], color=PALETTE[5], linewidth=1.5)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="z, mm", ylabel="y, mm", title="Rays, and the normal where they leave")
    axes.legend(loc="lower left", fontsize="small")
    return axes


def plot_deviation(prism: NegativePrism, axes: Axes) -> Axes:
    """Deviation against incidence, for both indices."""
    for index, colour, measured, theory in zip(
        prism.indices, COLOURS, prism.deviations, prism.deviations_theory, strict=True
    ):
        axes.plot(prism.incidences, theory, color=colour, linewidth=1)
        axes.plot(prism.incidences, measured, "o", color=colour, markersize=4, label=f"n = {index:g}")
    axes.axvline(prism.incidence, color=AXIS, linewidth=0.9, linestyle="--", label="the rays on the left")
    axes.axhline(0, color=AXIS, linewidth=0.7)
    axes.set(
        xlabel="incidence on the front face, up is positive, deg",
        ylabel="deviation, up (to the base) is positive, deg",
        title="Deviation (points: traced, lines: theory)",
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    return axes


PANELS = (plot_rays, plot_deviation)
