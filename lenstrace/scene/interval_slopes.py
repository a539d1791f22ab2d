"""What a function of x, y, z, and its first and second derivatives, can be in cells of space: by interval arithmetic.

By the chain rule, each factor the interval of all it can be in a cell,

    phi(u)_i = phi'(u) u_i,      phi(u)_ij = phi''(u) u_i u_j + phi'(u) u_ij

and so for the length of the gradient, |grad phi(u)| <= |phi'(u)| |grad u|, which is often less than the box of the
three first derivatives allows. Where a function may have a kink, its first derivatives are the hull of those of both
sides, and its second are not known; where it may jump, or is not defined, neither are, and the length is inf.
Sources: Griewank & Walther, Evaluating Derivatives (2008), chapter 13; the hull at a kink: Clarke, Optimization and
Nonsmooth Analysis (1983), chapter 2.
"""

from __future__ import annotations

import dataclasses
import functools
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from lenstrace.scene.intervals import SMALLEST, Interval, exactly, outward, times

# The second derivatives, in this order: xx, yy, zz, xy, xz, yz.
ROWS, COLUMNS = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)
# Of a root of a sum of squares: the time grows with its square.
MOST_PARTS = 12
# Where a function's first and second derivatives are not known.
UNKNOWN = Interval(np.full(1, -np.inf), np.full(1, np.inf))


@dataclasses.dataclass(frozen=True, eq=False)
class Slopes:
    """What a function can be in each of n cells; it computes like a number.

    value: (n,).     first: (3, n).     second: (6, n), in the order of `ROWS` and `COLUMNS`.
    length: (n,), not less than that of the gradient.
    Each n may be 1 instead: the same in all cells.
    squares: gives the functions whose sum of squares this is, where it is one.
    parts: the functions whose root of the sum of squares this is, where it is one.
    """

    value: Interval
    first: Interval
    second: Interval
    length: np.ndarray
    squares: Callable[[], tuple[Slopes, ...]] | None = None
    parts: tuple[Slopes, ...] = ()

    def __add__(self, other: Any) -> Slopes:
        other = lifted(other)
        mine, its = self.squares, other.squares
        squares = None if mine is None or its is None else lambda: (*mine(), *its())
        first, second = self.first + other.first, self.second + other.second
        return _slopes(self.value + other.value, first, second, self.length + other.length, squares)

    def __neg__(self) -> Slopes:
        return Slopes(-self.value, -self.first, -self.second, self.length)

    def __sub__(self, other: Any) -> Slopes:
        return self + -lifted(other)

    def __rsub__(self, other: Any) -> Slopes:
        return lifted(other) - self

    def __mul__(self, other: Any) -> Slopes:
        other = lifted(other)
        mine, its = self.squares, other.squares
        squares = None if mine is None or its is None else lambda: _products(mine(), its())
        first = self.value * other.first + self.first * other.value
        cross = self.first[ROWS,] * other.first[COLUMNS,] + self.first[COLUMNS,] * other.first[ROWS,]
        second = self.value * other.second + cross + self.second * other.value
        length = times(self.value.magnitude(), other.length) + times(other.value.magnitude(), self.length)
        # 0 times what has no bound may be 0 times what is not defined
        length = np.where(np.isfinite(self.length + other.length), length, np.inf)
        return _slopes(self.value * other.value, first, second, length, squares)

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: Any) -> Slopes:
        return self * lifted(other) ** -1

    def __rtruediv__(self, other: Any) -> Slopes:
        return lifted(other) / self

    def __pow__(self, n: Any) -> Slopes:
        """A power: n a number, or a function."""
        if isinstance(n, Slopes):
            return exponential(logarithm(self) * n)
        whole = float(n).is_integer()
        if n == 1:
            return self
        if self.parts and n % 2 == 0:
            return functools.reduce(operator.add, (part**2 for part in self.parts)) ** (n // 2)
        if len(self.parts) == 1 and n > 1:
            return _power_of_size(self.parts[0], n)
        if self.squares is not None and not whole:
            return square_root(self) ** (2 * n)
        slope, bend = exactly(n) * self.value.power(n - 1), exactly(n * (n - 1)) * self.value.power(n - 2)
        power = self.through(self.value.power(n), slope, bend)
        if n % 2 == 0:
            return dataclasses.replace(power, squares=lambda: (self ** (n // 2),))
        if self.squares is not None:
            return dataclasses.replace(power, squares=lambda: (square_root(self) ** n,))
        return power

    def __rpow__(self, base: Any) -> Slopes:
        return lifted(base) ** self

    def __lt__(self, other: Any) -> Slopes:
        return lifted(other) > self

    def __le__(self, other: Any) -> Slopes:
        return lifted(other) >= self

    def __gt__(self, other: Any) -> Slopes:
        """1 where it holds in all of a cell, 0 where nowhere; else it may jump."""
        other = lifted(other)
        low, high = self.value.low > other.value.high, self.value.high > other.value.low
        return stepped(low, high, self.length + other.length)

    def __ge__(self, other: Any) -> Slopes:
        """1 where it holds in all of a cell, 0 where nowhere; else it may jump."""
        other = lifted(other)
        low, high = self.value.low >= other.value.high, self.value.high >= other.value.low
        return stepped(low, high, self.length + other.length)

    def through(self, value: Interval, first: Interval, second: Interval) -> Slopes:
        """phi of it, by what phi, its first and its second derivative are on its values."""
        known = np.isfinite(self.length) & (np.isfinite(value.low) | np.isfinite(value.high))
        length = np.where(known, times(first.magnitude(), self.length), np.inf)
        return _slopes(value, first * self.first, second * _outer(self.first) + first * self.second, length)


def coordinate(axis: int, values: Interval) -> Slopes:
    """x, y or z: axis 0, 1 or 2; values: (n,)."""
    first = np.eye(3)[:, axis, None]
    return Slopes(values, Interval(first, first), _rows(exactly(0.0), 6), np.ones(1))


def lifted(value: Any) -> Slopes:
    """A number, that has no slope, or what it already is."""
    return value if isinstance(value, Slopes) else _constant(exactly(float(value)))


def _constant(value: Interval) -> Slopes:
    squares = (lambda: (_constant(value.power(0.5)),)) if value.low[0] >= 0 else None
    return Slopes(value, _rows(exactly(0.0), 3), _rows(exactly(0.0), 6), np.zeros(1), squares)


def _slopes(
    value: Interval,
    first: Interval,
    second: Interval,
    length: np.ndarray,
    squares: Callable[[], tuple[Slopes, ...]] | None = None,
) -> Slopes:
    """The length is also no more than what the first derivatives allow, save where it is inf."""
    known = np.isfinite(length)
    box = np.hypot.reduce(first.magnitude(), axis=0)
    length = np.where(known, np.minimum(length, box), np.inf)
    return Slopes(value, first.only(known), second.only(known), length, squares)


def _products(one: tuple[Slopes, ...], other: tuple[Slopes, ...]) -> tuple[Slopes, ...]:
    """Functions whose sum of squares is the product of two sums of squares; no more of them than in one sum."""
    if len(one) > 1 and len(other) > 1:
        other = (norm(*other),)
    return tuple(a * b for a in one for b in other)


def _rows(value: Interval, count: int) -> Interval:
    return Interval(*(np.broadcast_to(end, (count, *end.shape)) for end in (value.low, value.high)))


def _outer(first: Interval) -> Interval:
    """The 6 products u_i u_j."""
    square, cross = first.power(2), first[[0, 0, 1],] * first[[1, 2, 2],]
    return Interval(np.concatenate([square.low, cross.low]), np.concatenate([square.high, cross.high]))


def chosen(take: np.ndarray, take_other: np.ndarray, one: Slopes, other: Slopes, *, jumps: bool) -> Slopes:
    """One function where `take`, another where `take_other`; elsewhere the edge between the two may lie in the cell."""

    def each(mine: Interval, its: Interval, edge: Interval) -> Interval:
        pairs = ((mine.low, its.low, edge.low), (mine.high, its.high, edge.high))
        return Interval(*(np.where(take, a, np.where(take_other, b, c)) for a, b, c in pairs))

    value = each(one.value, other.value, one.value.union(other.value))
    first = each(one.first, other.first, UNKNOWN if jumps else one.first.union(other.first))
    length = np.inf if jumps else np.maximum(one.length, other.length)
    length = np.where(take, one.length, np.where(take_other, other.length, length))
    return Slopes(value, first, each(one.second, other.second, UNKNOWN), length)


def absolute(u: Slopes) -> Slopes:
    """|u|."""
    size = chosen(u.value.low > 0, u.value.high < 0, u, -u, jumps=False)
    return dataclasses.replace(size, value=u.value.absolute(), parts=(u,))


def _power_of_size(u: Slopes, n: float) -> Slopes:
    """|u|^n, n > 1, which has no kink."""
    slope = u.value.rising(lambda end: np.copysign(np.abs(end) ** (n - 1), end))
    bend = exactly(n * (n - 1)) * u.value.absolute().power(n - 2)
    return u.through(u.value.absolute().power(n), exactly(n) * slope, bend)


def norm(*parts: Slopes) -> Slopes:
    """The root s of the sum of squares of functions g_k, with the unit vector e = g / s:

        s_i = sum_k e_k g_k,i      s_ij = sum_k e_k g_k,ij + (sum_k g_k,i g_k,j - s_i s_j) / s

    |grad s|^2 is at most the greatest eigenvalue of the matrix of all grad g_k . grad g_l, and that the greatest sum of
    the sizes in a row of it.
    """
    if len(parts) == 1:
        return absolute(parts[0])
    if len(parts) > MOST_PARTS:
        return norm(norm(*parts[: len(parts) // 2]), norm(*parts[len(parts) // 2 :]))
    squares = [part.value.power(2) for part in parts]
    size = _sum(squares).power(0.5)
    rests = [_sum(squares[:k] + squares[k + 1 :]).power(0.5) for k in range(len(parts))]
    pairs = [(_unit(part.value, rest), part) for part, rest in zip(parts, rests, strict=True)]
    first = _sum([unit * part.first for unit, part in pairs])
    turn = _sum([_outer(part.first) for part in parts]) - _outer(first)
    second = _sum([unit * part.second for unit, part in pairs]) + turn * size.reciprocal()
    rows = [functools.reduce(operator.add, (_dot(one, other) for other in parts)) for one in parts]
    length = np.sqrt(functools.reduce(np.maximum, rows))
    return dataclasses.replace(_slopes(size, first, second, length), parts=parts)


def _sum(intervals: list[Interval]) -> Interval:
    return functools.reduce(operator.add, intervals)


def _dot(one: Slopes, other: Slopes) -> np.ndarray:
    """A bound of |grad g . grad h|; inf where one of the two has none."""
    products = one.first * other.first
    dot = (products[0] + products[1] + products[2]).magnitude()
    least = np.minimum(dot, times(one.length, other.length))
    return np.where(np.isfinite(one.length + other.length), least, np.inf)


def _unit(part: Interval, rest: Interval) -> Interval:
    """g / hypot(g, r), r >= 0; 0 where both are 0: a place that counts only if all of a cell is such, and flat."""

    def ratio(g: np.ndarray, r: np.ndarray) -> np.ndarray:
        return np.where(g == 0, 0, np.where(np.isinf(g), np.sign(g), g / np.hypot(g, r)))

    low = ratio(part.low, np.where(part.low > 0, rest.high, rest.low))
    high = ratio(part.high, np.where(part.high > 0, rest.low, rest.high))
    return outward(low, high).within(-1, 1)


def square_root(u: Slopes) -> Slopes:
    """The root of u; of a sum of squares, that has a bound of its slope where it is 0, too."""
    return u**0.5 if u.squares is None else norm(*u.squares())


def exponential(u: Slopes) -> Slopes:
    """e^u."""
    # never taken for 0, however small
    exp = outward(np.exp(u.value.low), np.exp(u.value.high) + SMALLEST)
    return u.through(exp, exp, exp)


def logarithm(u: Slopes) -> Slopes:
    """log u, where u > 0."""
    known = u.value.only(u.value.low > 0)
    return u.through(known.rising(np.log).only(u.value.low > 0), known.reciprocal(), -known.power(-2))


def stepped(low: np.ndarray, high: np.ndarray, length: np.ndarray) -> Slopes:
    """A function of values from low to high that is constant in a cell, or jumps; length: of what it is made of."""
    # of what is not defined nothing is sure
    value = Interval(low.astype(float), high.astype(float)).only(np.isfinite(length))
    slope = Interval(np.zeros(1), np.zeros(1)).only(value.low == value.high)
    return Slopes(value, _rows(slope, 3), _rows(slope, 6), slope.high)
