"""A matt surface: light goes on alike in all directions. Source: J. H. Lambert, Photometria (1760)."""

from __future__ import annotations

from typing import Any, ClassVar

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.turns import turned
from lenstrace.optics.vectors import Vector
from lenstrace.scene.colours import Colour, scaled
from lenstrace.scene.materials.material import Branch, Place, Scattering, no_branches
from lenstrace.scene.materials.texture import colour_at


@pytree
class Diffuse:
    """f = albedo / pi, on both sides. albedo: RGB, what part of the light goes on, 0 to 1, or a texture."""

    sends: ClassVar[tuple[bool, bool]] = (False, False)
    disperses: ClassVar[bool] = False
    albedo: Any

    def sample(self, place: Place, outgoing: Vector, u: jax.Array, v: jax.Array, w: jax.Array) -> Scattering:
        """A direction with density cos / pi; w makes no difference."""
        del outgoing, w
        incoming = about_normal(u, v)
        return incoming, colour_at(self.albedo, place.point), incoming[2] / jnp.pi

    def evaluate(self, place: Place, outgoing: Vector, incoming: Vector) -> tuple[Colour, jax.Array]:
        """f cos and density, 0 for light from behind."""
        del outgoing
        density = jnp.maximum(incoming[2], 0) / jnp.pi
        return scaled(colour_at(self.albedo, place.point), density), density

    def branches(self, place: Place, outgoing: Vector, gloss: Any) -> tuple[Branch, Branch]:
        """None: here Whitted's trees end."""
        del place, gloss
        return no_branches(outgoing)


def about_normal(u: jax.Array, v: jax.Array) -> Vector:
    """A direction about +z with density cos / pi, of u, v in [0, 1): a point of the disk, lifted. cos is never 0."""
    radius, (cos, sin) = jnp.sqrt(u), turned(v)
    return radius * cos, radius * sin, jnp.sqrt(1 - u)
