"""Error at the end of rays through a graded index, against the tolerance of their steps."""

from __future__ import annotations

from matplotlib.axes import Axes

from lenstrace.phenomena.bending.tolerance import Cost
from lenstrace.plotting.colours import AXIS, PALETTE


def plot_cost(cost: Cost, axes: Axes, error: str) -> Axes:
    """error: what it is, with its unit. Every second point says how often the equation was evaluated."""
    axes.loglog(cost.tolerances, cost.errors, "o-", color=PALETTE[0], markersize=4, linewidth=1, label="traced")
    axes.loglog(cost.tolerances, cost.tolerances, color=AXIS, linewidth=1, linestyle="--", label="error = tolerance")
    for place in range(0, len(cost.calls), 2):
        axes.annotate(
            f"{cost.calls[place]}",
            (cost.tolerances[place], cost.errors[place]),
            (4, 5),
            textcoords="offset points",
            fontsize="small",
        )
    axes.set(
        xlabel="tolerance: relative error of a step",
        ylabel=error,
        title="Accuracy and its cost (numbers: evaluations)",
        xlim=(10 * cost.tolerances.max(), cost.tolerances.min() / 10),
    )
    axes.grid(alpha=0.3)
    axes.legend(loc="lower left")
    return axes
