"""Interval arithmetic on numpy arrays: every result holds all values that a function takes on the intervals given.

Ends of intervals are rounded outward by `ROUNDING`, save ends of 0, which stay exact. [-inf, inf] stands for "not
known": where a function is not defined, or has no bound.
Source: Moore, Interval Analysis (1966).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, Self

import numpy as np

# Of an end of an interval: numpy's functions are good to a few times 2^-53.
ROUNDING = 2.0**-50
LARGEST = np.finfo(float).max
SMALLEST = np.finfo(float).tiny


@dataclasses.dataclass(frozen=True, eq=False)
class Interval:
    """low, high: arrays of one shape, low <= high, no nan; low may be -inf and high inf."""

    low: np.ndarray
    high: np.ndarray

    def __add__(self, other: Self) -> Interval:
        return outward(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Self) -> Interval:
        return outward(self.low - other.high, self.high - other.low)

    def __neg__(self) -> Interval:
        return Interval(-self.high, -self.low)

    def __mul__(self, other: Self) -> Interval:
        ends = [times(a, b) for a in (self.low, self.high) for b in (other.low, other.high)]
        return outward(np.minimum.reduce(ends), np.maximum.reduce(ends))

    def __getitem__(self, rows: Any) -> Interval:
        return Interval(self.low[rows], self.high[rows])

    def magnitude(self) -> np.ndarray:
        """The greatest |u|."""
        return np.maximum(np.abs(self.low), np.abs(self.high))

    def nearest(self) -> np.ndarray:
        """The least |u|."""
        return np.maximum(np.maximum(self.low, -self.high), 0)

    def absolute(self) -> Interval:
        """|u|."""
        return Interval(self.nearest(), self.magnitude())

    def only(self, known: np.ndarray) -> Interval:
        """As it is where `known`, elsewhere [-inf, inf]."""
        return Interval(np.where(known, self.low, -np.inf), np.where(known, self.high, np.inf))

    def within(self, low: float, high: float) -> Interval:
        """Of a function that takes no value outside [low, high]."""
        return Interval(np.clip(self.low, low, high), np.clip(self.high, low, high))

    def union(self, other: Self) -> Interval:
        """The least interval that holds both."""
        return Interval(np.minimum(self.low, other.low), np.maximum(self.high, other.high))

    def reciprocal(self) -> Interval:
        """1 / u; not known where u may be 0."""
        return outward(1 / self.high, 1 / self.low).only((self.low > 0) | (self.high < 0))

    def power(self, exponent: float) -> Interval:
        """u^n for a whole n; for another, where u is nowhere negative."""
        whole = float(exponent).is_integer()
        if exponent < 0 and whole:
            return self.power(-exponent).reciprocal()
        if exponent % 2 == 0:
            return self.absolute().rising(lambda end: np.power(end, float(exponent)))
        ends = np.power(self.low, float(exponent)), np.power(self.high, float(exponent))
        return outward(*(ends if exponent > 0 else ends[::-1])).only(whole | (self.low >= 0))

    def rising(self, function: Callable[[np.ndarray], np.ndarray]) -> Interval:
        """A function that never falls; nan stands for not known."""
        return outward(function(self.low), function(self.high))

    def sine(self) -> Interval:
        """sin u: of the ends, and 1 or -1 where a peak or a trough lies between."""
        ends = np.sin(self.low), np.sin(self.high)
        low = np.where(self._holds(-np.pi / 2, 2 * np.pi), -1, np.minimum(*ends))
        high = np.where(self._holds(np.pi / 2, 2 * np.pi), 1, np.maximum(*ends))
        return outward(low, high).within(-1, 1)

    def tangent(self) -> Interval:
        """tan u; not known where a pole lies between."""
        ends = np.tan(self.low), np.tan(self.high)
        return outward(*ends).only(~self._holds(np.pi / 2, np.pi) & (ends[0] <= ends[1]))

    def _holds(self, place: float, period: float) -> np.ndarray:
        """Whether place + k period lies between, for any whole k."""
        return ~(np.floor((self.high - place) / period) <= np.floor((self.low - place) / period))


def times(a: Any, b: Any) -> np.ndarray:
    """a b, where 0 times inf is 0: inf stands for a number that is not known."""
    product = np.asarray(a * b)
    return np.where(np.isnan(product), 0, product)


def outward(low: Any, high: Any) -> Interval:
    """Rounded outward; an end that is nan, or beyond all numbers, is not known."""
    low = np.minimum(np.where(np.isnan(low), -np.inf, low), LARGEST)
    high = np.maximum(np.where(np.isnan(high), np.inf, high), -LARGEST)
    return Interval(low - ROUNDING * np.abs(low), high + ROUNDING * np.abs(high))


def exactly(value: float) -> Interval:
    """A number."""
    return Interval(np.full(1, value), np.full(1, value))
