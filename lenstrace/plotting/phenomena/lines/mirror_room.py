"""A path of light in a room of mirrors, and the straight line through the rooms that the mirrors show."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import LinearLocator
from mpl_toolkits.mplot3d import Axes3D

from lenstrace.phenomena.lines.mirror_room import MirrorRoom
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

PATH, SOURCE, RECEIVER = PALETTE[0], PALETTE[1], PALETTE[2]
ELEVATION, AZIMUTH, ZOOM = 22, -62, 0.8  # of the view into the room: degrees, and how much of the panel it fills
MARGIN = 0.15  # of a room, around all of them
FLATTEST = 0.15  # sides of a drawn room, of the longest: flatter ones are drawn so, for else nothing would be seen
APART = 0.03  # of the extent of a picture: nearer numbers would touch
NUMBERED = 12  # more reflections go without numbers


def plot_room(found: MirrorRoom, axes: Axes3D) -> Axes3D:
    """The path folded into the room, its reflections numbered; its shadow as the other panel has it."""
    corners = np.array(list(itertools.product((0, 1), repeat=3)))
    for a, b in itertools.combinations(corners, 2):
        if abs(a - b).sum() == 1:
            axes.plot(*(np.stack([a, b]) * found.sides).T, color=OUTLINE, linewidth=0.8)
    axes.plot(*found.path.T[:2], 0, color=AXIS, linewidth=0.8, linestyle=":", label="shadow on the floor")
    axes.plot(*found.path.T, color=PATH, linewidth=1.6)
    axes.plot(*found.path[1:-1].T, "o", color=PATH, markersize=4)
    for text, (x, y, z) in _numbers(found.path[1:-1], found.sides):
        axes.text(x, y, z, f" {text}", color=PATH, zorder=10)
    axes.plot(*found.source[:, None], "o", color=SOURCE, label="source")
    axes.plot(*found.receiver[:, None], "s", color=RECEIVER, label="receiver")
    axes.set(xlim=(0, found.sides[0]), ylim=(0, found.sides[1]), zlim=(0, found.sides[2]))
    axes.set(xlabel="x, mm", ylabel="y, mm", zlabel="z, mm", title=_title(found))
    # the hint of zoom in matplotlib is of whole numbers, and those of the axes are of two dimensions
    drawn: Any = axes
    drawn.set_box_aspect(np.maximum(found.sides / found.sides.max(), FLATTEST), zoom=ZOOM)
    axes.view_init(ELEVATION, AZIMUTH)
    for axis in (drawn.xaxis, drawn.yaxis, drawn.zaxis):
        axis.set_pane_color("none")
        axis.set_major_locator(LinearLocator(3))
        axis.set_major_formatter("{x:.3g}")
    axes.grid(False)
    axes.legend(loc="upper left", fontsize="small", frameon=False)
    return axes


def plot_rooms(found: MirrorRoom, axes: Axes) -> Axes:
    """The same path as a straight line from the image of the source, seen along z."""
    sides = found.sides[:2]
    low, high = np.minimum(found.room[:2], 0), np.maximum(found.room[:2], 0)
    for place in itertools.product(*(range(a, b + 1) for a, b in zip(low, high, strict=True))):
        real = not any(place)
        axes.add_patch(
            Rectangle(
                (place[0] * sides[0], place[1] * sides[1]),
                *sides,
                facecolor=GLASS if real else "none",
                edgecolor=AXIS,
                linewidth=0.8,
            )
        )
        odd = np.array(place) % 2 == 1
        image = place * sides + np.where(odd, sides - found.source[:2], found.source[:2])
        axes.plot(*image, "o", color=SOURCE, markerfacecolor=SOURCE if real else "none", markersize=5)
    straight = found.straight[:, :2]
    axes.plot(*straight.T, color=PATH, linewidth=1.6)
    axes.plot(*straight[1:-1].T, "o", color=PATH, markersize=4)
    for text, point in _numbers(straight[1:-1], sides * (high - low + 1)):
        axes.annotate(text, tuple(point), (4, -11), textcoords="offset points", color=PATH)
    axes.plot(*straight[0], "o", color=SOURCE)
    axes.plot(*found.receiver[:2], "s", color=RECEIVER)
    margin = MARGIN * sides
    axes.set(xlim=((low * sides - margin)[0], ((high + 1) * sides + margin)[0]))
    axes.set(ylim=((low * sides - margin)[1], ((high + 1) * sides + margin)[1]))
    ends = np.array([axes.get_xlim(), axes.get_ylim()])
    extent = ends[:, 1] - ends[:, 0]
    axes.set_aspect("equal" if extent.min() > FLATTEST * extent.max() else "auto")
    length = found.shortest[-1]
    axes.set(xlabel="x, mm", ylabel="y, mm", title=f"From room ({_room(found)}): {length:.6g} mm straight")
    return axes


def _title(found: MirrorRoom) -> str:
    bounces = len(found.path) - 2
    return f"Shortest path of {bounces} reflection{'' if bounces == 1 else 's'}"


def _numbers(points: np.ndarray, extent: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Numbers of the reflections and where they go; what would lie upon each other is written once, as "2, 3"."""
    labels: list[tuple[str, np.ndarray]] = []
    for number, point in enumerate(points, 1):
        if labels and np.linalg.norm((point - labels[-1][1]) / extent) < APART:
            labels[-1] = (f"{labels[-1][0]}, {number}", labels[-1][1])
        else:
            labels.append((f"{number}", point))
    return labels if len(points) <= NUMBERED else []


def _room(found: MirrorRoom) -> str:
    return ", ".join(f"{number}" for number in found.room)


PANELS = (plot_room, plot_rooms)
