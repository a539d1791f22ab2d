"""Light from all around, from a map of the sphere of directions; one colour is a map of one cell."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree
from lenstrace.optics.turns import turned
from lenstrace.optics.vectors import Vector
from lenstrace.scene.colours import Colour
from lenstrace.scene.lights.light import Lighting
from lenstrace.scene.rays import nowhere


@pytree
class Environment:
    """Cells of equal solid angle: rows by equal steps of the height y from 1 down to -1, columns by angle about y.

    Column 0 begins at +z and the angle goes toward +x.
    radiance: (H * W, 3), row after row, constant in each cell.      chosen: (H * W,), the chance that a direction is
    taken from this cell and those before it; grows up to 1.         columns: W.
    """

    radiance: jax.Array
    chosen: jax.Array
    columns: jax.Array

    def seen(self, direction: Vector) -> tuple[Colour, jax.Array]:
        """Radiance from a direction, and with what density per solid angle `toward` chooses it."""
        cell = self._cell(direction)
        return self._colour(cell), self._density(cell)

    def toward(self, point: Vector, u: jax.Array, v: jax.Array, w: jax.Array) -> Lighting:
        """A direction chosen by the brightness of the cells; the same at every point."""
        del point
        count = self.chosen.shape[0]
        cell = jnp.zeros(u.shape, jnp.int32)
        if count > 1:
            cell = jnp.searchsorted(self.chosen, w, side="right").astype(jnp.int32)
            cell = jnp.clip(cell, 0, count - 1)
        rows, columns = (each.astype(u.dtype) for each in (count // self.columns, self.columns))
        row, column = ((cell // self.columns).astype(u.dtype), (cell % self.columns).astype(u.dtype))
        height = 1 - 2 * (row + u) / rows
        cos, sin = turned((column + v) / columns)
        across = jnp.sqrt(jnp.maximum(1 - height * height, 0))
        density = self._density(cell)
        r, g, b = self._colour(cell)
        far = jnp.full_like(u, jnp.inf)
        direction = across * sin, height, across * cos
        safe = jnp.where(density > 0, density, 1)
        return Lighting(direction, far, (r / safe, g / safe, b / safe), density, nowhere(u))

    def _cell(self, direction: Vector) -> jax.Array:
        x, y, z = direction
        count = self.chosen.shape[0]
        if count == 1:
            return jnp.zeros(x.shape, jnp.int32)
        rows = count // self.columns
        row = jnp.clip(((1 - y) / 2 * rows.astype(y.dtype)).astype(jnp.int32), 0, rows - 1)
        turn = jnp.arctan2(x, z) / (2 * jnp.pi)
        part = (turn - jnp.floor(turn)) * self.columns.astype(turn.dtype)
        column = jnp.clip(part.astype(jnp.int32), 0, self.columns - 1)
        return row * self.columns + column

    def _colour(self, cell: jax.Array) -> Colour:
        return self.radiance[cell, 0], self.radiance[cell, 1], self.radiance[cell, 2]

    def _density(self, cell: jax.Array) -> jax.Array:
        before = jnp.where(cell > 0, self.chosen[jnp.maximum(cell - 1, 0)], 0)
        return (self.chosen[cell] - before) * (self.chosen.shape[0] / (4 * np.pi))


def environment(radiance: np.ndarray, dtype: np.dtype) -> Environment:
    """The light of a map. radiance: (H, W, 3), rows of equal solid angle from the top; black everywhere is allowed."""
    cells = np.asarray(radiance, float).reshape(-1, 3)
    weight = cells.mean(-1)
    weight = weight if weight.sum() > 0 else np.ones_like(weight)
    chosen = np.cumsum(weight / weight.sum())
    chosen[-1] = 1
    columns = np.int32(np.shape(radiance)[1])
    return Environment(jnp.asarray(cells, dtype), jnp.asarray(chosen, dtype), jnp.asarray(columns))
