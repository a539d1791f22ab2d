"""Vignetting: what part of the pupil each field fills, found by tracing rays along its edges."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.pupil_edges import arrival, edges_between
from lenstrace.compute.blocks import each
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import LostRaysError
from lenstrace.sequential.launch import Front
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import Light

# Rays from edge to edge of the pupil, tried from the outside: what is narrower than a step may be overlooked.
TRIED = 64


@pytree
class Vignetting:
    """The part of the pupil that F fields fill, at the primary wavelength, as an ellipse; every array (F,), in units of
    the pupil's radius.

    top, bottom:  y of the outermost rays through x = 0 that arrive.
    right, left:  x of the outermost rays that arrive half-way between these.

    An unvignetted field has 1, -1, 1, -1. In other programs' words VUY = 1 - top, VLY = 1 + bottom (CODE V), and VDY,
    VCY are `centre_y`, 1 - `half_y` (OpticStudio).
    """

    top: jax.Array
    bottom: jax.Array
    right: jax.Array
    left: jax.Array

    @property
    def centre_x(self) -> jax.Array:
        """x of the middle of the ellipse."""
        return (self.right + self.left) / 2

    @property
    def centre_y(self) -> jax.Array:
        """y of the middle of the ellipse."""
        return (self.top + self.bottom) / 2

    @property
    def half_x(self) -> jax.Array:
        """Half the width of the ellipse."""
        return (self.right - self.left) / 2

    @property
    def half_y(self) -> jax.Array:
        """Half the height of the ellipse."""
        return (self.top - self.bottom) / 2

    def inside(self, pupil_x: Any, pupil_y: Any) -> tuple[Any, Any]:
        """Points of the unit disk (N,) brought into the ellipse of each field, (F, N). What arrives is not quite an
        ellipse: near the rim some rays may still be lost."""
        return (
            self.centre_x[:, None] + self.half_x[:, None] * pupil_x,
            self.centre_y[:, None] + self.half_y[:, None] * pupil_y,
        )


def vignetting(lens: Lens) -> Vignetting:
    """The part of the pupil that each field fills.

    Apertures cut it, and semi-diameters too in a lens with `clip_at_semi_diameters`, as do surfaces that are missed and
    total reflection. LostRaysError where no ray through the middle line of the pupil arrives. The edges are found by
    bisection to the last digits, and are held fixed by derivatives.
    """
    system, front = with_pupil(lens)
    numbers = (front, system.light_at(system.primary)), system.fields
    asked, fields = jax.tree.map(lax.stop_gradient, numbers) if is_traced(lens) else numbers
    x, y = fields[:, 0], fields[:, 1]
    zero, one = 0 * x, 0 * x + 1
    top, bottom = (s * each(_edge, asked, (x, y, zero, zero, zero, s * one)) for s in (1, -1))
    if not is_traced(lens):
        _check(lens, np.asarray(top))
    middle = (top + bottom) / 2
    width = jnp.sqrt(1 - middle * middle)
    right, left = (s * width * each(_edge, asked, (x, y, zero, middle, s * width, zero)) for s in (1, -1))
    if not is_traced(lens):
        _check(lens, np.asarray(right))
    return Vignetting(top, bottom, right, left)


def _edge(asked: tuple[Front, Light], lines: tuple[jax.Array, ...]) -> jax.Array:
    """The largest t for which the ray through the point (x, y) + t (dx, dy) of the pupil arrives, -1 <= t <= 1; nan if
    there is none. lines: field x and y, x, y, dx, dy."""
    front, light = asked
    field_x, field_y, x, y, dx, dy = lines
    arrives = arrival(front, light, (field_x, field_y), (x, y), (dx, dy))

    def outside_in(k: jax.Array, state: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        inner, outer = state
        t = jnp.full_like(x, 1 - 2 * k / TRIED)
        sought, good = jnp.isnan(inner), arrives(t)
        return jnp.where(sought & good, t, inner), jnp.where(sought & ~good, t, outer)

    inner, outer = lax.fori_loop(0, TRIED + 1, outside_in, (jnp.full_like(x, jnp.nan), jnp.ones_like(x)))
    return edges_between(arrives, inner, outer, True, inner == outer)


def _check(lens: Lens, edge: np.ndarray) -> None:
    if np.isnan(edge).any():
        field = int(np.isnan(edge).argmax())
        place = f"({float(lens.fields.x[field]):g}, {float(lens.fields.y[field]):g}) {lens.fields.unit}"
        raise LostRaysError(f"field {place}: no ray through the middle lines of the pupil arrives; check the apertures")
