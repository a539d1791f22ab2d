"""The functions that a formula may have, on intervals, with their derivatives: what `Formula.evaluate` takes."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np

from lenstrace.scene.interval_slopes import (
    Slopes,
    absolute,
    chosen,
    exponential,
    lifted,
    logarithm,
    norm,
    square_root,
    stepped,
)
from lenstrace.scene.intervals import Interval, exactly, outward

ONE = exactly(1.0)


def _where(condition: Slopes, one: Slopes, other: Slopes) -> Slopes:
    low, high = condition.value.low, condition.value.high
    known = np.isfinite(condition.length)
    return chosen(known & ((low > 0) | (high < 0)), known & (low == 0) & (high == 0), one, other, jumps=True)


def _maximum(one: Slopes, other: Slopes) -> Slopes:
    known = np.isfinite(one.length + other.length)
    # never >=: of two cells that share a kink in the face between them one has to know of it
    take, take_other = one.value.low > other.value.high, other.value.low > one.value.high
    greater = chosen(known & take, known & take_other, one, other, jumps=False)
    value = Interval(np.maximum(one.value.low, other.value.low), np.maximum(one.value.high, other.value.high))
    return dataclasses.replace(greater, value=value)


def _sin(u: Slopes) -> Slopes:
    sine, cosine = u.value.sine(), _cosine(u.value)
    return u.through(sine, cosine, -sine)


def _cos(u: Slopes) -> Slopes:
    sine, cosine = u.value.sine(), _cosine(u.value)
    return u.through(cosine, -sine, -cosine)


def _cosine(u: Interval) -> Interval:
    return (u + outward(np.full(1, math.pi / 2), np.full(1, math.pi / 2))).sine()


def _tan(u: Slopes) -> Slopes:
    tangent = u.value.tangent()
    slope = ONE + tangent.power(2)
    return u.through(tangent, slope, exactly(2.0) * tangent * slope)


def _sinh(u: Slopes) -> Slopes:
    sinh, cosh = u.value.rising(np.sinh), u.value.absolute().rising(np.cosh)
    return u.through(sinh, cosh, sinh)


def _cosh(u: Slopes) -> Slopes:
    sinh, cosh = u.value.rising(np.sinh), u.value.absolute().rising(np.cosh)
    return u.through(cosh, sinh, cosh)


def _tanh(u: Slopes) -> Slopes:
    tanh = u.value.rising(np.tanh).within(-1, 1)
    slope = ONE - tanh.power(2)
    return u.through(tanh, slope, exactly(-2.0) * tanh * slope)


def _arcsin(u: Slopes) -> Slopes:
    arcsin = u.value.rising(np.arcsin).only((u.value.low >= -1) & (u.value.high <= 1))
    rest = ONE - u.value.power(2)
    return u.through(arcsin, rest.power(-0.5), u.value * rest.power(-1.5))


def _arctan(u: Slopes) -> Slopes:
    slope = (ONE + u.value.power(2)).reciprocal()
    return u.through(u.value.rising(np.arctan), slope, exactly(-2.0) * u.value * slope.power(2))


def _arctan2(y: Slopes, x: Slopes) -> Slopes:
    """By the quotient of the one that is nearer to 0; it jumps behind the origin."""
    up, down, ahead = y.value.low > 0, y.value.high < 0, x.value.low > 0
    level = _arctan(x / y)
    sides = chosen(up, down, math.pi / 2 - level, -math.pi / 2 - level, jumps=True)
    straight = ahead & (x.value.low >= y.value.nearest())
    return chosen(straight, ~straight, _arctan(y / x), sides, jumps=True)


def _step(function: Callable[[np.ndarray], np.ndarray]) -> Callable[[Slopes], Slopes]:
    return lambda u: stepped(function(u.value.low), function(u.value.high), u.length)


def _with_numbers(function: Callable[..., Slopes]) -> Callable[..., Slopes]:
    return lambda *operands: function(*map(lifted, operands))


_FUNCTIONS = {
    **{"sin": _sin, "cos": _cos, "tan": _tan, "sinh": _sinh, "cosh": _cosh, "tanh": _tanh},
    **{
        "exp": exponential,
        "log": logarithm,
        "sqrt": square_root,
        "abs": absolute,
        "hypot": norm,
        "maximum": _maximum,
        "where": _where,
    },
    **{"sign": _step(np.sign), "floor": _step(np.floor), "minimum": lambda one, other: -_maximum(-one, -other)},
    **{"arcsin": _arcsin, "arccos": lambda u: math.pi / 2 - _arcsin(u), "arctan": _arctan, "arctan2": _arctan2},
}
# What `Formula.evaluate` takes, by the names of numpy.
LIBRARY = SimpleNamespace(**{name: _with_numbers(function) for name, function in _FUNCTIONS.items()})
