"""Rays through a drop, and the sky with both bows in their colours."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.patches import Circle

from lenstrace.phenomena.bending.rainbow import Rainbow
from lenstrace.plotting.colours import AXIS, GLASS, OUTLINE, PALETTE

FAR = 2.6  # radii of the drop: how far rays are drawn
EDGE = 1.0  # degrees on either side of the sky, where what is beyond is missing


def plot_drop(found: Rainbow, axes: Axes) -> Axes:
    """Rays that are reflected once; the thick one is that of the bow."""
    axes.add_patch(Circle((0, 0), 1, facecolor=GLASS, edgecolor=OUTLINE))
    axes.axhline(0, color=AXIS, linewidth=0.7, linestyle=(0, (12, 3, 2, 3)))
    last = found.course_z.shape[1] - 1
    for place in range(last + 1):
        z, y = found.course_z[:, place], found.course_y[:, place]
        way = found.leaving[place]
        z, y = [-FAR, *z, z[-1] + 2 * FAR * way[0]], [y[0], *y, y[-1] + 2 * FAR * way[1]]
        bow = place == last
        axes.plot(z, y, color=PALETTE[1 if bow else 0], linewidth=2 if bow else 0.7, zorder=3 if bow else 2)
    axes.set(xlabel="z, radii of the drop", ylabel="y, radii of the drop", xlim=(-FAR, 1.3), ylim=(-2.6, 1.3))
    axes.set_title(f"One reflection: the bow at {found.bows[0]:.2f}°")
    axes.set_aspect("equal")
    return axes


def plot_sky(found: Rainbow, axes: Axes) -> Axes:
    """The sky from the point opposite to the sun outward, in the colours of water, and its luminance."""
    low, high = found.sky[0], found.sky[-1]
    axes.imshow(
        found.colours[None], extent=(low, high, 0, 1.6), aspect="auto", origin="lower", interpolation="bilinear"
    )
    axes.plot(found.sky, found.intensity, color="white", linewidth=1.2)
    for place, name in ((38.0, "inside"), (46.6, "Alexander's band"), (57.0, "outside")):
        axes.text(place, 1.45, name, color="white", ha="center")
    axes.text(found.bows[0] - 1.2, 1.3, "primary bow", color="white", ha="right")
    axes.text(found.bows[1] + 2.0, 1.3, "secondary bow", color="white", ha="left")
    axes.set(
        xlabel="angle from the point opposite to the sun, deg",
        ylabel="luminance, brightest = 1",
        title="The sky, in the colours of water",
        xlim=(low + EDGE, high - EDGE),
    )
    return axes


PANELS = (plot_drop, plot_sky)
