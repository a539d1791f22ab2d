"""The picture of a demonstration: its panels side by side, as the file of the same name in plotting/phenomena says."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from lenstrace.phenomena.demonstration import Demonstration

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Inches.
WIDTH, HEIGHT = 10.0, 4.4
ALONE = 6.5  # the width of a picture of one panel


def plot_demonstration(demonstration: Demonstration) -> Figure:
    """Draw what a demonstration found, on a new figure made through pyplot, which a notebook then shows."""
    from matplotlib import pyplot

    return _drawn(demonstration, pyplot.figure)


def demonstration_figure(demonstration: Demonstration) -> Figure:
    """The same without pyplot's global state."""
    from matplotlib.figure import Figure

    return _drawn(demonstration, Figure)


def _drawn(demonstration: Demonstration, new: Callable[..., Any]) -> Figure:
    panels = _panels(demonstration)
    figure = new(figsize=(WIDTH if len(panels) > 1 else ALONE, HEIGHT), layout="compressed")
    for panel, axes in zip(panels, figure.subplots(1, len(panels), squeeze=False)[0], strict=True):
        panel(demonstration, axes)
    return figure


def _panels(demonstration: Demonstration) -> tuple[Callable[[Any, Axes], Axes], ...]:
    module = type(demonstration).__module__.replace("lenstrace.phenomena", "lenstrace.plotting.phenomena")
    return importlib.import_module(module).PANELS
