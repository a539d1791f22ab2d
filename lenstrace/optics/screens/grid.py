"""A screen given by its values on a grid, and the bicubic spline through them."""

from __future__ import annotations

import functools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.optics.screens.screen import Number, Screen, plain, unless_sound

LEAST = 4  # values along a side, for a cubic
REACH = 1e4  # cells beyond the grid where the polynomial at its edge ends: its sixth power is finite in float32


@pytree
class GridScreen(Screen):
    """W between its values at equidistant points: the cubic spline through them, twice continuously differentiable.

    values:      (J, I), mm, W at x = -half_width[0] ... half_width[0] along a row, y = -half_width[1] ...
                 half_width[1] from row to row. Beyond the grid the polynomial at its edge goes on, for REACH cells;
                 from there W is constant along x or y, so that it stays finite.
    half_width:  mm, along x and y.

    With "not a knot" at both ends it is exact for cubic polynomials.
    """

    values: Any
    half_width: tuple[Number, Number]

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:
        """W, mm."""
        return self.prepared().path(x, y, wavelength)

    def prepared(self) -> _Spline:
        """The coefficients of the spline: one linear equation along each side."""
        xp = jnp if is_traced(self.values) else np
        values = xp.asarray(self.values)
        (down, across) = (_coefficients_from_values(count) for count in values.shape)
        return _Spline(down @ values @ across.T, self.half_width)

    @property
    def label(self) -> str:
        """For the table of a lens."""
        down, across = np.shape(self.values)
        half = [plain(each) for each in self.half_width]
        return f"grid of {across} x {down} values within +-{half[0]}, +-{half[1]} mm"

    @property
    def mistake(self) -> str:
        """No table, too few values, values that are not finite, a width that is none."""
        shape = np.shape(self.values)
        if len(shape) != 2 or min(shape) < LEAST:
            return f"grid: the path needs at least {LEAST} rows of {LEAST} values, got the shape {shape}"
        if not is_traced(self.values) and not np.isfinite(np.asarray(self.values, float)).all():
            return "grid: the path must be finite numbers"
        return next(filter(None, (unless_sound(w, "grid: half_width", positive=True) for w in self.half_width)), "")


@pytree
class _Spline(Screen):
    """W = sum over j, i of c_ji B(v - j + 1) B(u - i + 1), B the cubic B-spline, u and v in steps of the grid.

    coefficients: (J + 2, I + 2), mm.       half_width: mm.
    """

    coefficients: Any
    half_width: tuple[Number, Number]

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:  # noqa: ARG002
        """W, mm: the sum of the sixteen terms that are not 0."""
        rows, columns = self.coefficients.shape
        first_x, across = _pieces(x, self.half_width[0], columns - 2)
        first_y, down = _pieces(y, self.half_width[1], rows - 2)
        flat = jnp.asarray(self.coefficients, x.dtype).reshape(-1)
        start = first_y * columns + first_x
        lines = [
            sum(weight * flat[start + j * columns + i] for i, weight in enumerate(across)) for j, _ in enumerate(down)
        ]
        return sum((weight * line for weight, line in zip(down, lines, strict=True)), jnp.zeros_like(x))


def _pieces(x: jax.Array, half_width: Number, count: int) -> tuple[jax.Array, list[jax.Array]]:
    """The cell of a grid of `count` points that x lies in, and the four B-splines there."""
    u = jnp.clip((x + half_width) * ((count - 1) / 2 / half_width), -REACH, count - 1 + REACH)
    cell = jnp.clip(jnp.floor(jax.lax.stop_gradient(u)), 0, count - 2)
    t = u - cell
    s = 1 - t
    weights = [s**3 / 6, 2 / 3 - t * t * (2 - t) / 2, 2 / 3 - s * s * (2 - s) / 2, t**3 / 6]
    return cell.astype(jnp.int32), weights


@functools.lru_cache
def _coefficients_from_values(count: int) -> np.ndarray:
    """(count + 2, count), what makes the coefficients of the spline along a line of `count` values.

    At each point (c[i-1] + 4 c[i] + c[i+1]) / 6 is the value; the third derivative is the same on both sides of the
    second point from either end: the fourth difference of the coefficients is 0.
    """
    equations = np.zeros((count + 2, count + 2))
    for i in range(count):
        equations[i + 1, i : i + 3] = 1 / 6, 4 / 6, 1 / 6
    equations[0, :5] = equations[-1, -5:] = 1, -4, 6, -4, 1
    return np.linalg.inv(equations)[:, 1:-1]
