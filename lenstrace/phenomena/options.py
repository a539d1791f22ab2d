"""The options of a demonstration: what each means, its unit, its range; checked before anything is computed.

A demonstration is a function whose arguments say so in their annotations:

    @demonstration
    def snell(angle: Annotated[float, Option("angle of incidence", "deg", least=0, below=90)] = 30.0) -> Snell: ...

The command line and the sliders of a notebook are made from the same words.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import math
import numbers
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, get_args, get_type_hints

import numpy as np

from lenstrace.compute.pytree import is_traced
from lenstrace.errors import OptionError

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

# Of a refractive index, in absolute value: what the demonstrations are made for.
INDEX_SIZE = LEAST_INDEX, MOST_INDEX = 0.1, 10.0
# Of a length in mm, in absolute value.
LENGTH_SIZE = LEAST_LENGTH, MOST_LENGTH = 1e-3, 1e6


@dataclasses.dataclass(frozen=True)
class Option:
    """What an argument means and what it may be.

    meaning:        in words.               unit:  "" for a pure number.
    least, most:    smallest and largest value that is allowed.
    above, below:   values that it must stay clear of on either side.
    size:           smallest and largest absolute value, of a number of either sign.
    plane:          inf is allowed, of a radius: a plane.
    slider:         the range of a slider, where it is not that of the values.
    choices:        the words that are allowed, of an option that is a word; any word where none are given.
    """

    meaning: str
    unit: str = ""
    least: float = -math.inf
    most: float = math.inf
    above: float = -math.inf
    below: float = math.inf
    size: tuple[float, float] | None = None
    plane: bool = False
    slider: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()

    @property
    def allowed(self) -> str:
        """The range in words; "" where every number is allowed."""
        bounds = (("at least", self.least), ("above", self.above), ("at most", self.most), ("below", self.below))
        words = [f"{word} {bound:g}{self._unit}" for word, bound in bounds if math.isfinite(bound)]
        words += ["from {0:g} to {1:g} or from -{1:g} to -{0:g}".format(*self.size) + self._unit] if self.size else []
        words += [f"one of {', '.join(self.choices)}"] if self.choices else []
        return " and ".join(words) + (" (inf for a plane)" if self.plane else "")

    @property
    def _unit(self) -> str:
        return f" {self.unit}" if self.unit else ""

    def accepts(self, value: Any) -> bool:
        """True for a value in the range."""
        if isinstance(value, str):
            return not self.choices or value in self.choices
        if self.plane and value == math.inf:
            return True
        inside = self.least <= value <= self.most and self.above < value < self.below
        inside = inside and (self.size is None or self.size[0] <= abs(value) <= self.size[1])
        return inside and math.isfinite(value)


def positive_index(meaning: str, slider: tuple[float, float] | None = None) -> Option:
    """A refractive index above 0."""
    return Option(meaning, least=LEAST_INDEX, most=MOST_INDEX, slider=slider)


def negative_index(meaning: str, slider: tuple[float, float] | None = None) -> Option:
    """A refractive index below 0."""
    return Option(meaning, least=-MOST_INDEX, most=-LEAST_INDEX, slider=slider)


def index_of_either_sign(meaning: str, slider: tuple[float, float] | None = None) -> Option:
    """A refractive index, not near 0."""
    return Option(meaning, size=INDEX_SIZE, slider=slider)


def positive_length(meaning: str, slider: tuple[float, float] | None = None) -> Option:
    """A length in mm."""
    return Option(meaning, "mm", least=LEAST_LENGTH, most=MOST_LENGTH, slider=slider)


def length_of_either_sign(meaning: str, slider: tuple[float, float] | None = None) -> Option:
    """A length in mm that has a sign, such as a focal length."""
    return Option(meaning, "mm", size=LENGTH_SIZE, slider=slider)


def radius_of_surface(meaning: str) -> Option:
    """A radius in mm, inf for a plane."""
    return Option(meaning, "mm", size=LENGTH_SIZE, plane=True)


@dataclasses.dataclass(frozen=True)
class Argument:
    """An option of a demonstration with its name, the kind of its value (float, int or str), whether it takes several,
    and what it is where nothing is said."""

    name: str
    option: Option
    kind: type
    several: bool
    default: Any


def demonstration(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Check the options of a demonstration when it is called: OptionError says which, what it must be, and what it got.

    Numbers that JAX traces are not checked.
    """
    signature = inspect.signature(function)

    @functools.wraps(function)
    def call(*values: Arguments.args, **named: Arguments.kwargs) -> Result:
        given = signature.bind(*values, **named).arguments
        for argument in arguments_of(call):
            if argument.name in given:
                _check(argument, given[argument.name], function.__name__)
        return function(*values, **named)

    return call


def arguments_of(function: Callable[..., Any]) -> list[Argument]:
    """The options of a demonstration, in order; arguments without an `Option`, such as a lens, are left out."""
    hints = get_type_hints(function, include_extras=True)
    found = []
    for name, parameter in inspect.signature(function).parameters.items():
        kind, *notes = get_args(hints[name]) or (hints[name],)
        option = next((note for note in notes if isinstance(note, Option)), None)
        if option is not None:
            several = bool(get_args(kind))
            found.append(Argument(name, option, get_args(kind)[0] if several else kind, several, parameter.default))
    return found


def takes_lens(function: Callable[..., Any]) -> bool:
    """True for a demonstration that any lens can be given to."""
    return "lens" in inspect.signature(function).parameters


def _check(argument: Argument, value: Any, where: str) -> None:
    """OptionError for a value that the option does not accept."""
    if is_traced(value):
        return
    values, name = np.asarray(value, dtype=object), f"{where.replace('_', '-')}: {argument.name}"
    if argument.several and (values.ndim != 1 or not values.size):
        raise OptionError(f"{name} needs a list of at least one value, got {value!r}")
    needs = {float: numbers.Real, int: numbers.Integral, str: str}[argument.kind]
    for each in values.tolist() if argument.several else [values.item() if values.ndim == 0 else value]:
        sound = isinstance(each, needs) and not isinstance(each, bool) and argument.option.accepts(each)
        if not sound:
            words = argument.option.allowed or (
                "a whole number" if argument.kind is int else "a word" if argument.kind is str else "a finite number"
            )
            raise OptionError(f"{name} must be {words}, got {each!r}")
