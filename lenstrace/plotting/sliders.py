"""A demonstration in a notebook, with its options as sliders."""

from __future__ import annotations

import base64
import importlib.util
import io
import math
from collections.abc import Callable
from typing import Any, NamedTuple

from lenstrace.errors import LensTraceError
from lenstrace.phenomena.demonstration import Demonstration
from lenstrace.phenomena.options import Argument, arguments_of
from lenstrace.plotting.demonstration import demonstration_figure

STEPS = 100  # of a slider of a number that is not whole
RESOLUTION = 90  # dots per inch
LABEL = "14em"  # the width of a label


class _Control(NamedTuple):
    """A widget, and what makes the value of an option out of its value."""

    widget: Any
    read: Callable[[Any], Any]


def explore(demonstration: Callable[..., Demonstration]) -> Any:
    """Show the table and the picture of a demonstration, and a slider for each of its options.

    demonstration: such as `lenstrace.phenomena.slab`. Sliders need ipywidgets (`pip install "lenstrace[notebook]"`);
    without it the demonstration is shown once, with the options it has by default. Returns the widget, or None.
    """
    if importlib.util.find_spec("ipywidgets") is None:
        from IPython.display import Image, display

        text, picture = _shown(demonstration, {})
        print(text)
        display(Image(picture))
        return None
    import ipywidgets

    controls = {argument.name: _control(argument) for argument in arguments_of(demonstration)}
    output = ipywidgets.Output()

    def draw(_: Any = None) -> None:
        values = {name: control.read(control.widget.value) for name, control in controls.items()}
        text, picture = _shown(demonstration, values)
        # set as data: what is printed while a slider moves would belong to no cell
        shown: list[dict[str, Any]] = [{"output_type": "stream", "name": "stdout", "text": f"{text}\n"}]
        if picture is not None:
            data = {"image/png": base64.b64encode(picture).decode()}
            shown.append({"output_type": "display_data", "data": data, "metadata": {}})
        output.outputs = tuple(shown)

    for control in controls.values():
        control.widget.observe(draw, "value")
    draw()
    return ipywidgets.VBox([*(control.widget for control in controls.values()), output])


def _shown(demonstration: Callable[..., Demonstration], options: dict[str, Any]) -> tuple[str, bytes | None]:
    """The table and the picture (png); one line, and none, where the options are not right."""
    try:
        found = demonstration(**options)
    except LensTraceError as error:
        return str(error), None
    picture = io.BytesIO()
    demonstration_figure(found).savefig(picture, format="png", dpi=RESOLUTION)
    return repr(found), picture.getvalue()


def _control(argument: Argument) -> _Control:
    """What suits an option: a menu of its choices, a slider over its range, or a field to write in."""
    import ipywidgets

    option, default = argument.option, argument.default
    unit = f", {option.unit}" if option.unit else ""
    shown = {
        "description": f"{argument.name.replace('_', ' ')}{unit}",
        "tooltip": option.meaning,
        "style": {"description_width": LABEL},
        "continuous_update": False,
    }
    if argument.several:
        written = ", ".join(f"{value:g}" for value in default)
        return _Control(ipywidgets.Text(value=written, **shown), _several)
    if option.choices:
        del shown["continuous_update"]
        return _Control(ipywidgets.Dropdown(options=option.choices, value=default, **shown), str)
    if argument.kind is str:
        return _Control(ipywidgets.Text(value=default, **shown), str)
    low, high = option.slider or (max(option.least, option.above), min(option.most, option.below))
    if not (math.isfinite(low) and math.isfinite(high) and low <= default <= high):
        field = ipywidgets.IntText if argument.kind is int else ipywidgets.FloatText
        return _Control(field(value=default, **shown), argument.kind)
    if argument.kind is int:
        return _Control(ipywidgets.IntSlider(value=default, min=int(low), max=int(high), **shown), int)
    slider = ipywidgets.FloatSlider(value=default, min=low, max=high, step=(high - low) / STEPS, **shown)
    slider.readout_format = ".4g"
    return _Control(slider, float)


def _several(text: str) -> Any:
    """Numbers written one after the other; what are none are left to be refused."""
    try:
        return tuple(float(word) for word in text.replace(",", " ").split())
    except ValueError:
        return text
