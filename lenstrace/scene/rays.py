"""A ray of the scene tracer."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector

NOWHERE = -1  # the number of no primitive


@pytree
class SceneRay:
    """Where a line of sight begins, and where to.

    point, direction:  lengths of the scene; unit vector.
    start:   number of the primitive it begins on, NOWHERE for none: what is met there again is not its beginning.
    moment:  -1/2 to 1/2 of the time of the shutter; None in a scene where nothing moves.
    um:      wavelength; None in a scene without dispersion.
    """

    point: Vector
    direction: Vector
    start: jax.Array
    moment: jax.Array | None = None
    um: jax.Array | None = None

    def onward(self, point: Vector, direction: Vector, start: jax.Array) -> SceneRay:
        """The same light, from another point on."""
        return SceneRay(point, direction, start, self.moment, self.um)


def nowhere(like: jax.Array) -> jax.Array:
    """NOWHERE, for rays of the shape of an array."""
    return jnp.full(like.shape, NOWHERE, jnp.int32)
