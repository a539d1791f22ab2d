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
    """Where a ray meets a shape; where there is no crossing all numbers are finite, and without meaning.

    distance:        signed path along the ray, mm.
    point:           the point met, mm.
    normal:          any length, n_z > 0 at the vertex.       normal_squared: its squared length.
    cosine:          |normal . direction|.
    met:             whether there is a crossing.
    reason:          why there is none, a `RayStatus`; without meaning where there is one.
    """

    distance: jax.Array
    point: Vector
    normal: Vector
    normal_squared: jax.Array
    cosine: jax.Array
    met: jax.Array
    reason: jax.Array | int

    @property
    def status(self) -> jax.Array:
        """0 (`RayStatus.OK`), or the reason why there is no crossing."""
        return jnp.where(self.met, 0, self.reason)


def approach(point: Vector, direction: Vector) -> tuple[jax.Array, Vector]:
    """The place from where a crossing is found without loss of digits, and how far along the ray it is, mm."""
    (x, y, z), (l, m, n) = point, direction
    steep = jnp.abs(n) > FLAT
    t = -jnp.where(steep, z, dot(point, direction)) / jnp.where(steep, n, 1)
    return t, (x + t * l, y + t * m, jnp.where(steep, 0, z + t * n))
