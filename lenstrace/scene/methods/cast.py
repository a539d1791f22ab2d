"""Ray casting: the nearest surface, lit straight by the lights that it sees, and nothing beyond.

Source: A. Appel, AFIPS Spring Joint Computer Conference 32, 37 (1968).
"""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.scene.colours import Colour
from lenstrace.scene.draws import Draws
from lenstrace.scene.methods.local import look
from lenstrace.scene.rays import SceneRay
from lenstrace.scene.world import World


@pytree
class Cast:
    """One ray from the eye, and one to every light."""

    def radiance(self, world: World, ray: SceneRay, draws: Draws) -> tuple[Colour, jax.Array]:
        """Along rays, and how many rays were traced for each."""
        del draws
        seen = look(world, ray, jnp.ones(ray.start.shape, bool), None, False)
        return seen.radiance, seen.rays
