"""Smooth interpolation of tabulated indices, exact at the nodes, that never overshoots the table."""

from __future__ import annotations

import numpy as np

WINDOW = 5
"""Nodes whose polynomial gives the slope at the middle one: fourth order where the table is smooth."""

MONOTONE_LIMIT = 3.0
"""A slope up to this multiple of the neighbouring secants keeps a cubic monotone (Fritsch & Carlson 1980)."""


def interpolate(nodes: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Piecewise cubic through (nodes, values), evaluated at `at`.

    nodes: ascending, at least 2; values: the same shape; at: any shape, within the nodes. Two nodes give the
    straight line, three the parabola where it does not overshoot; more give a cubic Hermite curve with the
    slopes of the polynomial through five neighbours, limited so that no interval leaves the range of its two
    nodes.

    Source: Hyman, SIAM J. Sci. Stat. Comput. 4, 645 (1983), for the limit.
    """
    slopes = _limited(_polynomial_slopes(nodes, values), np.diff(values) / np.diff(nodes))
    left = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    width = nodes[left + 1] - nodes[left]
    t = (at - nodes[left]) / width
    rise = values[left + 1] - values[left]
    # Newton's form about the left node; written so that t = 0 and t = 1 give the nodes to the last bit.
    bend = t * (1 - t) * ((1 - t) * (slopes[left] * width - rise) - t * (slopes[left + 1] * width - rise))
    line = np.where(t < 0.5, values[left] + t * rise, values[left + 1] - (1 - t) * rise)
    return line + bend


def _polynomial_slopes(nodes: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Derivative at each node of the polynomial through it and its nearest neighbours in the table."""
    count = len(nodes)
    size = min(WINDOW, count)
    start = np.clip(np.arange(count) - size // 2, 0, count - size)
    window = start[:, None] + np.arange(size)
    # Barycentric weights w_j = 1 / prod_k (x_j - x_k); the derivative at x_i is
    #     sum_j (w_j / w_i) (y_j - y_i) / (x_i - x_j).
    # Source: Berrut & Trefethen, SIAM Rev. 46, 501 (2004), section 9.
    distance = nodes[window][:, :, None] - nodes[window][:, None, :]
    weight = 1 / np.prod(np.where(distance == 0, 1.0, distance), axis=2)
    own = np.arange(count) - start
    ratio = weight / weight[np.arange(count), own][:, None]
    to_node = nodes[:, None] - nodes[window]
    terms = ratio * (values[window] - values[:, None]) / np.where(to_node == 0, 1.0, to_node)
    return terms.sum(axis=1)


def _limited(slopes: np.ndarray, secants: np.ndarray) -> np.ndarray:
    """Slopes cut to 0 ... 3 times the smaller neighbouring secant; 0 where the two secants differ in sign."""
    before = np.concatenate([secants[:1], secants])
    after = np.concatenate([secants, secants[-1:]])
    smaller = np.minimum(np.abs(before), np.abs(after)) * (np.sign(before) == np.sign(after))
    return np.sign(before) * np.clip(np.sign(before) * slopes, 0.0, MONOTONE_LIMIT * smaller)
