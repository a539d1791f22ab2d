"""Rays through a drop, and the sky with both rainbows in true colours."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from lenstrace.phenomena.bending.rainbow import Rainbow
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

PRIMARY, SECONDARY, OTHERS = PALETTE[1], PALETTE[2], PALETTE[0]
BEFORE, BEHIND = 2.0, 6.0  # length of the rays outside the drop, in its radii: to the edge of the picture


def plot_drop(rainbow: Rainbow, axes: Axes) -> Axes:
    """Rays that are reflected once, Descartes' rays of both bows; the secondary's enters below."""
    axes.add_patch(Circle((1, 0), 1, facecolor=GLASS, edgecolor=OUTLINE))
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    count = rainbow.points.shape[-1]
    for place in reversed(range(count)):
        style = {"color": OTHERS, "linewidth": 0.6} if place else {"color": PRIMARY, "linewidth": 2, "label": "primary"}
        _ray(axes, rainbow.points[:3, :, place], rainbow.ways[:, place], style)
    style = {"color": SECONDARY, "linewidth": 2, "label": "secondary"}
    _ray(axes, rainbow.second * [-1, 1], rainbow.second_way * [-1, 1], style)
    axes.set(xlim=(-2.1, 2.2), ylim=(-2.4, 2.0), xlabel="z, radii of the drop", ylabel="y, radii of the drop")
    axes.set(aspect="equal", title=f"Rays through a drop, n = {rainbow.index:g}")
    axes.legend(loc="upper left", fontsize="small", title="Descartes' rays")
    return axes


def _ray(axes: Axes, points: np.ndarray, way: np.ndarray, style: dict) -> None:
    """points: (P, 2), y and z on the drop."""
    start, end = points[0] - [0, points[0, 1] + BEFORE], points[-1] + BEHIND * way
    y, z = np.array([start, *points, end]).T
    axes.plot(z, y, **style)


def plot_sky(rainbow: Rainbow, axes: Axes) -> Axes:
    """The light of the drops against the angle from the point opposite the sun, and its colours."""
    angles = np.degrees(rainbow.angles)
    top = 1.1 * rainbow.luminance.max()
    extent = (angles[0], angles[-1], top, 1.35 * top)
    axes.imshow(rainbow.colours[None], extent=extent, aspect="auto", interpolation="nearest")
    axes.plot(angles, rainbow.luminance, color=PALETTE[5], linewidth=1.4)
    for (violet, *_, red), name in zip(np.degrees(rainbow.bows), ("primary", "secondary"), strict=True):
        axes.axvspan(red, violet, 0, 1 / 1.35, color=AXIS, alpha=0.25, linewidth=0)
        axes.text((red + violet) / 2, 0.93 * top, name, ha="center")
    dark = np.degrees(rainbow.bows[:, -1]).mean()
    axes.text(dark, 0.5 * top, "Alexander's\ndark band", ha="center", va="center")
    axes.set(xlim=(34, 58), ylim=(0, 1.35 * top), xlabel="angle from the point opposite the sun, degrees")
    axes.set_yticks([tick for tick in axes.get_yticks() if tick <= top])
    axes.set(ylabel="light, 1 if sent evenly to all sides", title="The sky: drops of water")
    return axes


PANELS = (plot_drop, plot_sky)
