"""What a shape reports of a ray that meets it."""

from __future__ import annotations

from typing import NamedTuple

import jax

from lenstrace.optics.vectors import Vector


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
