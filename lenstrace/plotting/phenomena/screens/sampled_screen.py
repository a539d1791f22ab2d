"""A sampled screen, and its errors against the number of samples."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.screens.sampled_screen import SampledScreen
from lenstrace.plotting.colours import PALETTE


def plot_screen(found: SampledScreen, axes: Axes) -> Axes:
    """The samples, in um."""
    values = 1e3 * found.values
    largest = abs(values).max()
    image = axes.pcolormesh(found.x, found.x, values, cmap="PuOr", vmin=-largest, vmax=largest, shading="nearest")
    axes.figure.colorbar(image, ax=axes, label="added path, um")
    axes.set(xlabel="x, mm", ylabel="y, mm", title=f"{found.samples} x {found.samples} samples of a cubic")
    axes.set_aspect("equal")
    return axes


def plot_errors(found: SampledScreen, axes: Axes) -> Axes:
    """Errors of a screen that is a wave, with the powers of the step they fall with."""
    count = found.per_wave
    axes.loglog(count, found.path_errors, "o", color=PALETTE[0], label="path")
    axes.loglog(count, found.slope_errors, "^", color=PALETTE[1], label="slope")
    for errors, power, colour in ((found.path_errors, 4, PALETTE[0]), (found.slope_errors, 3, PALETTE[1])):
        line = errors[-1] * (count / count[-1]) ** -power
        axes.loglog(count, line, color=colour, linewidth=1, label=f"step to the power {power}")
    axes.set(xlabel="samples to a wave", ylabel="largest error over largest value", title="A wave, sampled")
    axes.set_xticks([6, 10, 20, 40], ["6", "10", "20", "40"], minor=False)
    axes.set_xticks([], minor=True)
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    return axes


PANELS = (plot_screen, plot_errors)
