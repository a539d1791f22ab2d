"""A Zernike screen as a map, and the spot that it makes of a point."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.screens.zernike_screen import FOCAL_LENGTH, ZernikeScreen
from lenstrace.plotting.colours import PALETTE


def plot_path(found: ZernikeScreen, axes: Axes) -> Axes:
    """The added path over the pupil, in um."""
    largest = abs(found.path[found.path == found.path]).max()
    edges = (found.x[0], found.x[-1], found.x[0], found.x[-1])
    image = axes.imshow(found.path, origin="lower", extent=edges, cmap="PuOr", vmin=-largest, vmax=largest)
    axes.figure.colorbar(image, ax=axes, label="added path, um")
    axes.set(xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    axes.set(xlabel="x / radius", ylabel="y / radius", title=f"W: {found.name}" if found.name else "W")
    return axes


def plot_spot(found: ZernikeScreen, axes: Axes) -> Axes:
    """Where the rays meet the focal plane of an ideal lens, in um."""
    axes.plot(1e3 * found.spot_x, 1e3 * found.spot_y, ".", color=PALETTE[0], markersize=2)
    axes.set(xlabel="x, um", ylabel="y, um", title=f"Spot behind an ideal lens of {FOCAL_LENGTH:g} mm")
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(alpha=0.3)
    return axes


PANELS = (plot_path, plot_spot)
