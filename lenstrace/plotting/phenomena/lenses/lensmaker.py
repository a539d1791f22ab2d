"""A lens with rays parallel to its axis, and its power against its thickness."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.lenses.lensmaker import Lensmaker
from lenstrace.plotting.colours import PALETTE
from lenstrace.plotting.phenomena.lenses.frame import frame, plot_glass


def plot_rays(found: Lensmaker, axes: Axes) -> Axes:
    """The lens, real rays and F', in mm; rays that diverge are followed back to it."""
    frame(plot_glass(axes, found.outline), found.shown, found.outline[:, 1].max())
    z, y = found.rays
    axes.plot([found.shown[0] + 0 * z[0], *z[1:]], y, color=PALETTE[0], linewidth=0.8)
    if found.focus < found.thickness:
        back = y[-2] + (y[-1] - y[-2]) / (z[-1] - z[-2]) * (found.focus - z[-2])
        axes.plot([found.focus + 0 * y[0], z[-2]], [back, y[-2]], color=PALETTE[0], linewidth=0.6, linestyle="--")
    if found.shown[0] < found.focus < found.shown[1]:
        axes.plot(found.focus, 0, "o", color=PALETTE[1], markersize=5, label="F'")
        axes.legend(loc="upper left", fontsize="small")
    axes.set_title("Rays parallel to the axis")
    return axes


def plot_power(found: Lensmaker, axes: Axes) -> Axes:
    """Power n / f, in 1/m, against the thickness."""
    axes.plot(found.thicknesses, found.thick, color=PALETTE[0], label="lensmaker's formula")
    axes.plot(found.thicknesses, found.thin, color=PALETTE[1], linestyle="--", label="formula of the thin lens")
    axes.plot(found.thicknesses, found.traced, "o", color=PALETTE[5], markersize=4, label="traced")
    axes.axvline(found.thickness, color="grey", linewidth=0.7, linestyle=":")
    axes.set(xlabel="thickness, mm", ylabel="power n₀ / f, 1/m", title="What the thickness does")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    return axes


PANELS = (plot_rays, plot_power)
