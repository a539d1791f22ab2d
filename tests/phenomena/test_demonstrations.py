"""Every demonstration, as it is by default: it agrees with theory, its picture can be drawn, it refuses bad options."""

import importlib
import math

import pytest
from matplotlib.figure import Figure

from lenstrace import LensTraceError, OptionError, phenomena
from lenstrace.phenomena.catalogue import PLACES, find, summary
from lenstrace.phenomena.demonstration import Comparison, Demonstration
from lenstrace.phenomena.options import Argument, arguments_of
from lenstrace.plotting.demonstration import demonstration_figure

every_demonstration = pytest.mark.parametrize("name", PLACES)


@every_demonstration
def test_agrees_with_theory_and_is_drawn(name: str) -> None:
    found = find(name)()
    assert isinstance(found, Demonstration)
    assert found.rows
    for row in found.rows:
        assert row.agrees, f"{row.quantity}: {row.texts}"
    figure = demonstration_figure(found)
    assert isinstance(figure, Figure)
    for axes in figure.axes:
        if axes.get_label() != "<colorbar>" and axes.axison:
            assert axes.get_xlabel(), "a label is missing on x"
            assert axes.get_ylabel(), "a label is missing on y"
    figure.canvas.draw()


@every_demonstration
def test_has_a_picture_module(name: str) -> None:
    """It is found by the place of the demonstration alone."""
    module = f"lenstrace.plotting.phenomena.{PLACES[name]}.{name.replace('-', '_')}"
    assert 1 <= len(importlib.import_module(module).PANELS) <= 2


@every_demonstration
def test_explains_itself(name: str) -> None:
    assert 10 < len(summary(name)) < 90
    assert getattr(phenomena, name.replace("-", "_")) is find(name)
    for argument in arguments_of(find(name)):
        assert argument.option.meaning
        for value in argument.default if argument.several else [argument.default]:
            assert argument.option.accepts(value), argument.name


def refused(argument: Argument) -> list[object]:
    """Values that an option does not accept: not a number, and just beyond its bounds."""
    option = argument.option
    if argument.kind is str:
        return ["no such choice"] if option.choices else [3.0]
    values: list[object] = [math.nan, -math.inf if option.plane else math.inf, "x", True]
    values += [0.0, option.size[0] / 2, -2 * option.size[1]] if option.size else []
    values += [bound for bound in (option.above, option.below) if math.isfinite(bound)]
    values += [option.least - 1] if math.isfinite(option.least) else []
    values += [option.most + 1] if math.isfinite(option.most) else []
    return [[value] for value in values] if argument.several else values


@every_demonstration
def test_refuses_bad_options_in_one_line(name: str) -> None:
    for argument in arguments_of(find(name)):
        for value in refused(argument):
            with pytest.raises(OptionError, match=f"^{name}: {argument.name} must be ") as caught:
                find(name)(**{argument.name: value})
            assert "\n" not in str(caught.value)
        if argument.several:
            with pytest.raises(OptionError, match="at least one"):
                find(name)(**{argument.name: ()})


def test_a_comparison_can_fail() -> None:
    assert Comparison("a", "mm", 1 + 2e-10, 1.0).agrees is False
    assert Comparison("a", "mm", 1 + 0.5e-10, 1.0).agrees
    assert not Comparison("a", "mm", math.nan, 1.0, math.inf).agrees
    assert Comparison("a", "mm", math.inf, math.inf).agrees
    assert not Comparison("a", "mm", 1e-300, 0.0).agrees


def test_an_unknown_name_has_no_attribute() -> None:
    with pytest.raises(AttributeError, match="no_such_thing"):
        _ = phenomena.no_such_thing
    assert issubclass(OptionError, LensTraceError)
