"""A star with points coloured by its winding number, and a line that rounding makes ragged."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from lenstrace.phenomena.lines.point_in_polygon import PointInPolygon
from lenstrace.plotting.colours import OUTLINE, PALETTE, colours

OUTSIDE = "#C8C8C8"
# Right of the line, on it, left of it.
SIDES = (PALETTE[4], PALETTE[5], PALETTE[0])


def plot_star(found: PointInPolygon, axes: Axes) -> Axes:
    """Points about the star, in units of its radius, coloured by how often it runs around them."""
    most = int(found.winding.max())
    for number, colour in zip(range(most + 1), [OUTSIDE, *colours(most)], strict=True):
        chosen = found.winding == number
        axes.plot(found.x[chosen], found.y[chosen], ".", color=colour, markersize=3, label=f"{number}")
    axes.plot(*found.star.T, color=OUTLINE, linewidth=1)
    axes.set_aspect("equal")
    axes.set(xlabel="x, radii of the star", ylabel="y, radii of the star", title="Times that the star runs around")
    axes.legend(title="winding", loc="upper left", bbox_to_anchor=(1, 1), markerscale=3, frameon=False)
    return axes


def plot_line(found: PointInPolygon, axes: Axes) -> Axes:
    """Where plain float64 says the points near the line are; exact is the diagonal."""
    count = len(found.plain)
    axes.imshow(found.plain, origin="lower", cmap=ListedColormap(SIDES), vmin=-1, vmax=1, interpolation="nearest")
    axes.plot(*np.array([[0, count - 1]] * 2), color=PALETTE[1], linewidth=1.5, label="exact")
    handles = [
        Patch(color=colour, label=label)
        for colour, label in zip(SIDES[::-1], ("left", "on the line", "right"), strict=True)
    ]
    axes.set(
        xlabel="i,  x = 0.5 + i 2⁻⁵³",
        ylabel="j,  y = 0.5 + j 2⁻⁵³",
        title=f"Sides by plain float64: {found.wrong} of {count**2} wrong",
    )
    axes.legend(
        handles=[*axes.lines, *handles], loc="upper left", bbox_to_anchor=(1, 1), frameon=False, fontsize="small"
    )
    return axes


PANELS = (plot_star, plot_line)
