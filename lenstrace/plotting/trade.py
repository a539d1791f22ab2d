"""Error against time, one mark for every setting."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lenstrace.accuracy.trade import Trade
from lenstrace.analysis.trade import LensTrade

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (9.0, 5.6)  # inches
# Each family looks alike in every picture; others come after these.
FAMILIES = (
    *("paraxial", "third order", "hexapolar", "grid", "random", "sobol", "gaussian"),
    *("gaussian, half the pupil", "gaussian, one spoke", "Newton steps"),
)
MARKERS = "os^vD<>pPX*h8d"
# Where a setting without any error is drawn: this far below the smallest other error.
BELOW = 3.0


def plot_trade(found: LensTrade, axes: Axes | None = None) -> Axes:
    """Relative error against the seconds of a call, both logarithmic; the Pareto front drawn, the tolerance as a line.

    Families of settings have a colour and a marker each; hollow marks are float32. Absolute errors, in the unit of the
    quantity, where the truth is 0. Returns the Axes.
    """
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.subplots(figsize=SIZE, layout="constrained")[1]
    return plot_outcomes(found.trade, found.unit, axes)


def plot_outcomes(trade: Trade, unit: str, axes: Axes) -> Axes:
    """The same of any trade; unit: of its question."""
    from matplotlib.ticker import LogLocator

    relative = trade.truth != 0
    outcomes = [each for each in trade.outcomes if np.isfinite(each.error)]
    errors = np.array([each.relative_error if relative else each.error for each in outcomes])
    least = errors[errors > 0].min(initial=1.0) / BELOW
    errors = np.where(errors > 0, errors, least)
    seconds = np.array([each.seconds for each in outcomes])

    names = list(dict.fromkeys(_family(each.setting.family) for each in outcomes))
    known = [*FAMILIES, *(name for name in names if name not in FAMILIES)]
    for name in names:
        colour, marker = _look(known.index(name))
        for single in (False, True):
            chosen = [
                _family(each.setting.family) == name and ("float32" in each.setting.name) is single for each in outcomes
            ]
            if not any(chosen):
                continue
            axes.plot(
                seconds[chosen] * 1e3,
                errors[chosen],
                linestyle="none",
                marker=marker,
                color=colour,
                markerfacecolor="none" if single else colour,
                markersize=6,
                label=f"{name}, float32" if single else name,
            )
    front = sorted(
        (each.seconds * 1e3, max(error, least)) for each, error in zip(outcomes, errors, strict=True) if each.pareto
    )
    axes.plot(*zip(*front, strict=True), color="0.3", drawstyle="steps-post", label="Pareto front")
    if trade.tolerance is not None:
        tolerance = trade.tolerance if relative else trade.floor
        axes.axhline(tolerance, color="C3", linestyle="--", linewidth=1, label=f"tolerance {tolerance:g}")
    if trade.chosen is not None:
        axes.plot(
            [trade.chosen.seconds * 1e3],
            [max(trade.chosen.relative_error if relative else trade.chosen.error, least)],
            linestyle="none",
            marker="o",
            markersize=14,
            markerfacecolor="none",
            color="C3",
            label="chosen",
        )
    axes.set(xscale="log", yscale="log", xlabel="time of a call, ms")
    axes.set_ylabel("relative error" if relative else f"error, {unit}")
    # whole numbers of ms, not powers of ten: all settings may lie within one
    for each in (axes.xaxis.set_major_formatter, axes.xaxis.set_minor_formatter):
        each("{x:g}")
    axes.xaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    axes.grid(which="major", alpha=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, frameon=False, fontsize="small")
    return axes


def family_look(family: str) -> tuple[str, str]:
    """Colour and marker of one of FAMILIES."""
    return _look(FAMILIES.index(family))


def trade_figure(found: LensTrade, name: str, field_unit: str) -> Figure:
    """A figure of the trade of a named lens alone, without pyplot's global state."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    plot_trade(found, figure.add_subplot())
    figure.suptitle(name, parse_math=False)
    figure.axes[0].set_title(found.described(field_unit), fontsize="medium")
    return figure


def _look(place: int) -> tuple[str, str]:
    return f"C{place % 10}", MARKERS[place % len(MARKERS)]


def _family(name: str) -> str:
    """Without its precision."""
    return name.replace(", float64", "").replace(", float32", "")
