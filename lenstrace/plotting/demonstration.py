"""The picture of a demonstration: its panels side by side, as the file of the same name in plotting/phenomena says."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, get_type_hints

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
    for place, panel in enumerate(panels, 1):
        # a panel says by the type of its axes whether they have two dimensions or three
        kind = get_type_hints(panel)["axes"].name
        panel(demonstration, figure.add_subplot(1, len(panels), place, projection=kind))
    return figure


def _panels(demonstration: Demonstration) -> tuple[Callable[[Any, Axes], Axes], ...]:
    module = type(demonstration).__module__.replace("lenstrace.phenomena", "lenstrace.plotting.phenomena")
    return importlib.import_module(module).PANELS
