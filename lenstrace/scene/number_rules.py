"""What a number of a scene must obey, each rule by itself: it gives what the program takes, or says what was got."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from lenstrace.errors import LensTraceError, SceneError

# Below it the highlights of float32 would be lost to rounding.
SMOOTHEST = 1e-3

Rule = Callable[[Any], Any]


def obeyed(name: str, rule: Rule, value: Any) -> Any:
    """What a rule makes of a value; its error names it."""
    try:
        return rule(value)
    except LensTraceError as error:
        raise type(error)(f"{name} {error}") from None


def number(value: Any) -> float:
    """A finite number."""
    if isinstance(value, np.ndarray | jax.Array) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, int | float | np.floating | np.integer):
        raise SceneError(f"must be a number, got {value!r}")
    if not math.isfinite(value):
        raise SceneError(f"must be finite, got {value}")
    return float(value)


def positive(value: Any) -> float:
    """A number above 0."""
    if not number(value) > 0:
        raise SceneError(f"must be positive, got {value}")
    return float(value)


def whole(value: Any) -> int:
    """A whole number, 1 or above."""
    try:
        found = 0 if isinstance(value, bool) else operator.index(value)
    except TypeError:
        found = 0
    if found < 1:
        raise SceneError(f"must be a whole number, at least 1, got {value!r}")
    return found


def size(value: Any) -> tuple[int, int]:
    """Pixels of a picture."""
    if np.ndim(value) != 1 or len(value) != 2:
        raise SceneError(f"must be two numbers, width and height in pixels, got {value!r}")
    return whole(value[0]), whole(value[1])


def angle(value: Any) -> float:
    """Degrees between 0 and 180."""
    if not 0 < number(value) < 180:
        raise SceneError(f"must be between 0 and 180 degrees, got {value}")
    return float(value)


def extent(value: Any) -> float:
    """A number above 0, or inf."""
    return _or_infinite(value, positive)


def bound(value: Any) -> float:
    """A number, 0 or above, or inf."""
    return _or_infinite(value, not_negative)


def not_negative(value: Any) -> float:
    """A number, 0 or above."""
    if number(value) < 0:
        raise SceneError(f"must not be negative, got {value}")
    return float(value)


def numbers(value: Any) -> np.ndarray:
    """Finite numbers, (N,)."""
    return np.array([number(each) for each in value], float)


def share(value: Any) -> float:
    """A number from 0 to 1."""
    if not 0 <= number(value) <= 1:
        raise SceneError(f"must be from 0 to 1, a surface gives back no more light than it gets; got {value}")
    return float(value)


def roughness(value: Any) -> float:
    """From SMOOTHEST to 1."""
    if not SMOOTHEST <= number(value) <= 1:
        raise SceneError(f"must be from {SMOOTHEST:g} (polished; below it take a smooth material) to 1, got {value}")
    return float(value)


def vector(value: Any) -> tuple[float, float, float]:
    """Three finite numbers."""
    return three(value, number)


def colour(value: Any) -> tuple[float, float, float]:
    """Linear RGB, not negative; one number for grey."""
    return three(value, not_negative)


def three(value: Any, rule: Rule) -> tuple[float, float, float]:
    """Three numbers, each by a rule; one that stands for all of a colour."""
    if np.ndim(value) == 0 and rule is not number:
        value = (value,) * 3
    if np.ndim(value) != 1 or len(value) != 3:
        raise SceneError(f"must be three numbers, got {value!r}")
    x, y, z = (rule(each) for each in value)
    return x, y, z


def _or_infinite(value: Any, rule: Rule) -> float:
    return math.inf if isinstance(value, float) and value == math.inf else rule(value)
