"""A beam through a plate of negative index: its rays, its waves, and which way both go."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from lenstrace.phenomena.negative_index.negative_waves import NegativeWaves
from lenstrace.plotting.colours import GLASS, NEGATIVE_GLASS, OUTLINE, PALETTE

ARROW = 2.5  # mm


def plot_waves(found: NegativeWaves, axes: Axes) -> Axes:
    """Rays, wavefronts, and inside the plate an arrow for the way of the energy and one for that of the phase."""
    low, high = found.ray_y.min() - 1, found.ray_y.max() + 1
    tint = NEGATIVE_GLASS if found.index < 0 else GLASS
    axes.add_patch(Rectangle((0, low), found.thickness, high - low, facecolor=tint, edgecolor=OUTLINE))
    axes.plot(found.ray_z[:, ::3], found.ray_y[:, ::3], color=PALETTE[0], linewidth=0.8)
    for z, y in zip(found.front_z, found.front_y, strict=True):
        axes.plot(z.T, y.T, color=PALETTE[1], linewidth=1)
    middle = found.ray_z.shape[1] // 2
    z, y = found.ray_z[:, middle], found.ray_y[:, middle]
    ray = (z[2] - z[1], y[2] - y[1])
    size = (ray[0] ** 2 + ray[1] ** 2) ** 0.5
    for place, way, colour in (
        (0.62, (ray[0] / size, ray[1] / size), PALETTE[0]),
        (0.42, tuple(found.back), PALETTE[1]),
    ):
        start = (z[1] + place * ray[0], y[1] + place * ray[1])
        end = (start[0] + ARROW * way[0], start[1] + ARROW * way[1])
        axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 2.5}, zorder=4)
    axes.plot([], [], color=PALETTE[0], label="rays: the way of the energy")
    axes.plot([], [], color=PALETTE[1], label="wavefronts: the way of the phase")
    axes.set(xlabel="z, mm", ylabel="y, mm", title=f"A plate of index {found.index:g}", ylim=(low, high))
    axes.set_aspect("equal")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2, frameon=False, fontsize="small")
    return axes


PANELS = (plot_waves,)
