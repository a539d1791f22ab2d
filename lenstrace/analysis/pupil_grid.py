"""A square grid over the pupil, and how much of each of its cells the unit circle covers."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.errors import RayError

FEWEST, MOST = 9, 1025
LEAST, TINY = 1e-3, 1e-9
# Of its width: how far the point of a cell moves inward, at most, from the middle of the cell. The middle of what is
# covered is up to twice as far; half of that makes up for the spread within the cells, so that the mean of r^2 is
# right.
INWARD = 0.25


def check_samples(samples: int) -> None:
    """RayError for a grid too coarse to show anything, or too fine for the memory of a machine."""
    if isinstance(samples, bool) or not isinstance(samples, int | np.integer) or not FEWEST <= samples <= MOST:
        raise RayError(f"samples across the pupil must be a whole number from {FEWEST} to {MOST}, got {samples!r}")


def grid_points(samples: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A square grid of cells from edge to edge of the pupil: x and y of a point of each cell that meets the unit
    circle, (N,), and the part of the cell that it covers.

    The point is the middle of the cell, at the edge about the middle of what is covered: a sum over the points is an
    integral over the disk to 0.1 % for 65 samples, and no ray is sent past the pupil.
    """
    check_samples(samples)
    width = 2 / (samples - 1)
    x, y = (a.ravel() for a in np.meshgrid(*[np.linspace(-1, 1, samples)] * 2))
    share = coverage(x, y, width)
    x, y, share = (a[share > 0] for a in (x, y, share))
    radius = np.hypot(x, y)
    inward = np.where(share < 1, np.minimum(1.0, radius - (1 - share) * INWARD * width), radius)
    scale = np.divide(inward, radius, out=np.ones_like(radius), where=radius > 0)
    return x * scale, y * scale, share


def coverage(x: Any, y: Any, width: Any) -> Any:
    """The part of a square cell of some width about the point x, y that lies in the unit circle."""
    return cell_coverage(x, y, (width, 0.0), (0.0, width))


def cell_coverage(x: Any, y: Any, one: tuple[Any, Any], two: tuple[Any, Any]) -> Any:
    """The part of a cell about the point x, y, with two edge vectors, that lies in the unit circle.

    Exact for a straight edge: with s the distance to it, a and b the extents of the two edges along the radius, and
    p(t) = max(t, 0)^2, it is

        (p(s + (a + b)/2) - p(s + (a - b)/2) - p(s - (a - b)/2) + p(s - (a + b)/2)) / (2 a b).

    s = 1 - r less the mean sagitta of the circle over the cell, (the squares of the extents across the radius) / 24.
    """
    # in numpy where JAX holds none of the numbers
    xp = jnp if any(isinstance(a, jax.Array) for a in (x, y, *one, *two)) else np
    square = x * x + y * y
    r = xp.sqrt(xp.where(square > 0, square, 1))
    first, second = (xp.abs(x * edge[0] + y * edge[1]) / r for edge in (one, two))
    sagitta = sum((x * edge[1] - y * edge[0]) ** 2 for edge in (one, two)) / (24 * r * r)
    s = 1 - sagitta - xp.where(square > 0, r, 0)
    # at least a thousandth of the other: a smaller extent makes no difference, and would be a divisor near 0
    a, b = xp.maximum(first, LEAST * second + TINY), xp.maximum(second, LEAST * first + TINY)

    def ramp(t: Any) -> Any:
        return xp.maximum(t, 0) ** 2

    corners = ramp(s + (a + b) / 2) - ramp(s + (a - b) / 2) - ramp(s - (a - b) / 2) + ramp(s - (a + b) / 2)
    return xp.where(square > 0, xp.clip(corners / (2 * a * b), 0, 1), 1)
