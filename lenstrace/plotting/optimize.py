"""How a search went: its merit against evaluations, and the lens before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lenstrace.analysis.layout import Layout
from lenstrace.design.outcome import Optimized
from lenstrace.plotting.layout import figure_size, plot_layout

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (7.0, 4.0)  # inches


def plot_optimize(found: Optimized, axes: Axes | None = None) -> Axes:
    """The merit of every evaluation, and the least so far, on a logarithmic scale. Returns the axes."""
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.subplots(figsize=SIZE, layout="constrained")[1]
    number = np.arange(1, found.steps + 1)
    axes.plot(number, [step.merit for step in found.history], "o", color="0.6", markersize=3, label="each evaluation")
    axes.plot(number, [step.best for step in found.history], color="C0", label="least so far")
    axes.set(yscale="log", xlabel="evaluation", ylabel="merit")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)
    return axes


def optimize_figure(found: Optimized, before: Layout, after: Layout, name: str) -> Figure:
    """The course of the search below the layouts before and after."""
    from matplotlib.figure import Figure

    sizes = [figure_size(each) for each in (before, after)]
    width, heights = max(SIZE[0], *(size[0] for size in sizes)), [*(size[1] for size in sizes), SIZE[1]]
    figure = Figure(figsize=(width, sum(heights)), layout="constrained")
    parts = figure.subfigures(3, 1, height_ratios=heights, squeeze=False)[:, 0]
    for part, drawing, when in zip(parts, (before, after), ("before", "after"), strict=False):
        plot_layout(drawing, part.add_subplot()).set_title(f"{name}, {when}", fontsize="medium", parse_math=False)
    plot_optimize(found, parts[2].add_subplot())
    return figure
