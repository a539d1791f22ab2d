"""A smooth mirror that gives back the same share of the light at every angle."""

from __future__ import annotations

from typing import Any, ClassVar

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector
from lenstrace.scene.colours import Colour
from lenstrace.scene.materials.material import Branch, Place, Scattering, mirrored, no_branches, none
from lenstrace.scene.materials.texture import colour_at


@pytree
class Mirror:
    """reflectance: RGB, 0 to 1, or a texture; on both sides."""

    sends: ClassVar[tuple[bool, bool]] = (True, False)
    disperses: ClassVar[bool] = False
    reflectance: Any

    def sample(self, place: Place, outgoing: Vector, u: jax.Array, v: jax.Array, w: jax.Array) -> Scattering:
        """The mirrored direction; u, v and w make no difference."""
        del u, v, w
        return mirrored(outgoing), colour_at(self.reflectance, place.point), jnp.full_like(outgoing[2], jnp.inf)

    def evaluate(self, place: Place, outgoing: Vector, incoming: Vector) -> tuple[Colour, jax.Array]:
        """Nothing: no light comes by chance from just there."""
        del place, incoming
        return none(outgoing)

    def branches(self, place: Place, outgoing: Vector, gloss: Any) -> tuple[Branch, Branch]:
        """The mirrored ray."""
        del gloss
        return (mirrored(outgoing), colour_at(self.reflectance, place.point)), no_branches(outgoing)[1]
