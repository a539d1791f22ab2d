"""Lights without size: a point, and one so far away that its rays are parallel."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector, dot, normalize
from lenstrace.scene.colours import Colour, scaled
from lenstrace.scene.lights.light import Lighting
from lenstrace.scene.rays import nowhere


@pytree
class PointLight:
    """Shines alike in all directions. position: lengths of the scene; intensity: radiance times area of the scene."""

    position: Vector
    intensity: Colour

    def toward(self, point: Vector, u: jax.Array, v: jax.Array, moment: jax.Array | None) -> Lighting:
        """At a point: intensity over the squared distance; the rest makes no difference."""
        del u, v, moment
        away = tuple(a - b for a, b in zip(self.position, point, strict=True))
        square = dot(away, away)  # type: ignore[arg-type]
        square = jnp.where(square > 0, square, 1)
        inverse = 1 / jnp.sqrt(square)
        x, y, z = (a * inverse for a in away)
        everywhere = jnp.full_like(square, jnp.inf)
        return Lighting((x, y, z), square * inverse, scaled(self.intensity, 1 / square), everywhere, nowhere(square))


@pytree
class DistantLight:
    """Parallel light. direction: in which it travels, any length; irradiance: on a plane across it."""

    direction: Vector
    irradiance: Colour

    def toward(self, point: Vector, u: jax.Array, v: jax.Array, moment: jax.Array | None) -> Lighting:
        """The same at every point; the rest makes no difference."""
        del u, v, moment
        x, y, z = (-a + jnp.zeros_like(point[0]) for a in normalize(self.direction))
        far = jnp.full_like(x, jnp.inf)
        return Lighting((x, y, z), far, scaled(self.irradiance, jnp.ones_like(x)), far, nowhere(x))
