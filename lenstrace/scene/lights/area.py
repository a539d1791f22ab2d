"""Lights of a shape: every point of it shines alike in all directions, on the side of its normal."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector, divide_where, dot, normalize, safe_sqrt
from lenstrace.scene.colours import scaled
from lenstrace.scene.frame import Frame
from lenstrace.scene.lights.light import Lighting


@pytree
class AreaLight:
    """shape, frame: of the primitive that shines, in its number; radiance: that it sends out."""

    shape: Any
    frame: Frame | None
    radiance: Any
    number: Any

    def toward(self, point: Vector, u: jax.Array, v: jax.Array, moment: jax.Array | None) -> Lighting:
        """From a point of the shape at a moment, chosen evenly by its area with u and v in [0, 1).

        Per solid angle the density is r^2 / (cos A), r the distance, A the area, cos at the light.
        """
        place = self.shape.place(u, v)
        normal = normalize(self.shape.normal(place))
        if self.frame is not None:
            place, normal = self.frame.outer_point(place, moment), self.frame.outer_direction(normal)
        x, y, z = (a - b for a, b in zip(place, point, strict=True))
        square = dot((x, y, z), (x, y, z))
        apart = square > 0
        length = safe_sqrt(square)
        # quotients last, as in `divide_where`: what uses the direction does not find the point on the light again
        direction = x / length, y / length, z / length
        cosine = -dot(direction, normal)
        # not over the density: a cosine that a compiler finds anew may be 0 in one place and more in the other
        seen = divide_where(apart, jnp.maximum(cosine, 0) * self.shape.area(), square)
        density = jnp.where(apart, self.density(square, cosine), 0)
        return Lighting(
            *(direction, jnp.where(apart, length, 0), scaled(self.radiance, seen), density),
            jnp.broadcast_to(self.number, square.shape),
        )

    def density(self, square: jax.Array, cosine: jax.Array) -> jax.Array:
        """With which `toward` chooses a direction, per solid angle; 0 where the light is seen from behind.

        square: of the distance to the light; cosine: between the direction and the light's normal.
        """
        return divide_where(cosine > 0, square, cosine * self.shape.area())
