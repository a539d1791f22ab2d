"""Sliders of a demonstration: they change it, they say what is wrong, and it is shown without them too."""

import importlib.util

import pytest

import lenstrace
from lenstrace import phenomena
from lenstrace.phenomena.catalogue import PLACES, find
from lenstrace.phenomena.options import arguments_of
from lenstrace.plotting.sliders import _control


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """What a notebook would display."""
    pictures: list[object] = []
    monkeypatch.setattr("IPython.display.display", pictures.append)
    return pictures


def test_a_slider_changes_the_demonstration() -> None:
    box = lenstrace.explore(phenomena.ideal_lens)
    *widgets, output = box.children
    sliders = {widget.description.split(",")[0]: widget for widget in widgets}
    text, picture = output.outputs
    assert "focal length 100 mm" in text["text"]
    sliders["focal length"].value = 50.0
    text, other = output.outputs
    assert "focal length 50 mm" in text["text"]
    assert other["data"]["image/png"] != picture["data"]["image/png"]
    sliders["height"].value = 60.0
    (text,) = output.outputs
    assert text["text"].startswith("ideal-lens: the quadratic lens of focal length 50 mm sends no light on")


def test_without_ipywidgets_it_is_shown_once(
    shown: list[object], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    real = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "ipywidgets" else real(name))
    assert lenstrace.explore(phenomena.ideal_lens) is None
    assert "crosses the axis" in capsys.readouterr().out
    assert len(shown) == 1


@pytest.mark.parametrize("name", PLACES)
def test_every_option_has_a_control_that_starts_with_its_default(name: str) -> None:
    for argument in arguments_of(find(name)):
        control = _control(argument)
        assert control.read(control.widget.value) == argument.default, argument.name


def test_several_numbers_are_written_one_after_the_other() -> None:
    angles = next(argument for argument in arguments_of(phenomena.slab) if argument.several)
    control = _control(angles)
    assert control.read("1, 2.5 3") == (1.0, 2.5, 3.0)
    assert control.read("one") == "one"
