"""What a shape reports of a ray that meets it."""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import Vector, dot

# A ray flatter than this against the vertex plane is not brought to that plane before a crossing is looked for, but to
# its point nearest to the vertex: the plane may be far away, or nowhere.
FLAT = 0.25


class Crossing(NamedTuple):
    """Where a ray meets a shape.

    distance:        signed path along the ray, mm; finite, and without meaning, where there is none.
    point:           the point met, mm.
    normal:          any length, n_z > 0 at the vertex.       normal_squared: its squared length.
    cosine:          |normal . direction|.
    status:          0 (`RayStatus.OK`) or the reason why there is no crossing.
    """

    distance: jax.Array
    point: Vector
    normal: Vector
    normal_squared: jax.Array
    cosine: jax.Array
    status: jax.Array


def approach(point: Vector, direction: Vector) -> tuple[jax.Array, Vector]:
    """The place from where a crossing is found without loss of digits, and how far along the ray it is, mm."""
    (x, y, z), (l, m, n) = point, direction
    steep = jnp.abs(n) > FLAT
    t = -jnp.where(steep, z, dot(point, direction)) / jnp.where(steep, n, 1)
    return t, (x + t * l, y + t * m, jnp.where(steep, 0, z + t * n))
