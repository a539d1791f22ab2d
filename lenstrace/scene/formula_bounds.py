"""How steep a formula can be in a cube, and how much it can bend: proved bounds, from intervals over cells of the cube.

A bound holds in all of a cell, so the greatest of all cells holds in the cube; those of the greatest bounds are divided
again, as long as it makes the bound better.
Source: Moore, Interval Analysis (1966).
"""

from __future__ import annotations

import dataclasses
import itertools
import math
import operator
from typing import Any

import numpy as np

from lenstrace.errors import SceneError
from lenstrace.scene.formula import Formula
from lenstrace.scene.interval_functions import LIBRARY
from lenstrace.scene.interval_slopes import COLUMNS, ROWS, coordinate, lifted
from lenstrace.scene.intervals import Interval

# Cells along each edge of the cube: even, so that planes through its middle, where kinks often are, pass between cells.
CELLS = 16
# Of the worst cells so many are divided, so often, as long as a bound gets smaller by this factor.
DIVIDED, DIVISIONS, GAIN = 256, 4, 0.98
# Lengths and norms are sums of some rounded numbers: by much less than this part of them.
MARGIN = 1e-9


def slopes_within(function: Formula, reach: float) -> tuple[float, float]:
    """Bounds of a formula of x, y, z in the cube |x|, |y|, |z| <= reach: its steepness and its bending.

    steepness: no gradient in the cube is longer.
    bending: no second derivative along a line in the cube is greater; inf where the formula has kinks, or may have.
    SceneError: the formula has no bound of its steepness, or none is found.

    >>> from lenstrace.scene.formula import formula
    >>> steepness, bending = slopes_within(formula("3*x + 4*y", ("x", "y", "z")), 2.0)
    >>> round(steepness, 6), bending
    (5.0, 0.0)
    """
    if len(function.names) != 3 or not 0 < reach < math.inf:
        raise SceneError(f"slopes of a formula: of 3 numbers, within a positive reach; got {function.names}, {reach}")
    function = dataclasses.replace(function, tree=_with_squares(function.tree))
    edges = np.linspace(-reach, reach, CELLS + 1)
    low, high = (np.array(list(itertools.product(ends, repeat=3))).T for ends in (edges[:-1], edges[1:]))
    try:
        with np.errstate(all="ignore"):
            steepness, bending = _greatest(function, Interval(low, high))
    except ArithmeticError:  # between plain numbers
        steepness, bending = math.inf, math.inf
    if not math.isfinite(steepness):
        raise SceneError(
            f"formula {function.text!r}: no bound of its slope is found where |x|, |y|, |z| <= {reach:g}: it jumps, "
            "divides by 0, or is not defined somewhere; write it otherwise, or give `steepness`"
        )
    return steepness * (1 + MARGIN), bending * (1 + MARGIN)


def _greatest(function: Formula, cells: Interval) -> tuple[float, float]:
    """Greatest steepness and bending of all cells; the worst are divided while that makes one of the two better."""
    bounds = _slopes_in(function, cells)
    for _ in range(DIVISIONS):
        greatest = bounds.max(axis=1)
        worst = np.unique(np.argsort(bounds, axis=1)[:, -DIVIDED:])
        parts = _halves(cells[:, worst])
        # a bound of a cell is one of its parts, too
        divided = np.minimum(_slopes_in(function, parts), np.tile(bounds[:, worst], 8))
        bounds = np.concatenate([np.delete(bounds, worst, axis=1), divided], axis=1)
        ends = ((np.delete(old, worst, axis=1), new) for old, new in ((cells.low, parts.low), (cells.high, parts.high)))
        cells = Interval(*(np.concatenate(pair, axis=1) for pair in ends))
        if not np.any(bounds.max(axis=1) < GAIN * greatest):
            break
    steepness, bending = bounds.max(axis=1)
    return float(steepness), float(bending)


def _halves(cells: Interval) -> Interval:
    """The 8 parts of each cell, (3, 8 n): all first parts, then all second ones."""
    middle = (cells.low + cells.high) / 2
    halves = [list(itertools.product(*zip(*ends, strict=True))) for ends in ((cells.low, middle), (middle, cells.high))]
    return Interval(*(np.concatenate([np.stack(part) for part in parts], axis=1) for parts in halves))


def _slopes_in(function: Formula, cells: Interval) -> np.ndarray:
    """Steepness and bending in each cell: (2, n).     cells: (3, n)."""
    found = lifted(function.evaluate(LIBRARY, *(coordinate(axis, cells[axis]) for axis in range(3))))
    return np.stack([np.broadcast_to(bound, cells.low.shape[1:]) for bound in (found.length, _norm(found.second))])


def _norm(second: Interval) -> np.ndarray:
    """A bound of |d.H d|, of all unit directions d and all symmetric matrices H of these intervals: the lesser of

        || greatest |H_ij| ||      and      || middle of H_ij || + || half width of H_ij ||

    second: (6, n), result: (n,).      || ||: the greatest size of an eigenvalue.
    |H| <= A entry by entry gives ||H|| <= ||A|| (Perron and Frobenius); the second is the triangle's inequality.
    """
    size = second.magnitude().max(axis=0)
    # beyond it the sums below may overflow
    known = size < 1e150
    finite = second[:, known]
    middle, half = (finite.low + finite.high) / 2, (finite.high - finite.low) / 2

    def greatest(entries: np.ndarray) -> np.ndarray:
        matrix = np.empty((entries.shape[1], 3, 3))
        matrix[:, ROWS, COLUMNS] = matrix[:, COLUMNS, ROWS] = entries.T
        return np.abs(np.linalg.eigvalsh(matrix)).max(axis=1)

    bounds = np.full(size.shape, np.inf)
    bounds[known] = np.minimum(greatest(finite.magnitude()), greatest(middle) + greatest(half))
    return bounds


def _with_squares(tree: Any) -> Any:
    """A tree of a formula whose products of a part with itself are squares, which are known to be positive."""
    if not isinstance(tree, tuple):
        return tree
    operation, *operands = (tree[0], *map(_with_squares, tree[1:]))
    if operation is operator.mul and operands[0] == operands[1]:
        return operator.pow, operands[0], 2
    return operation, *operands
