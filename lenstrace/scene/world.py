"""A scene as numbers: primitives, materials and lights, stacked by kind. What a scene lacks is not in its program."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector
from lenstrace.scene.frame import Frame
from lenstrace.scene.lights.environment import Environment
from lenstrace.scene.rays import SceneRay
from lenstrace.scene.search.kind import Search
from lenstrace.scene.stacks import Stack


@pytree
class Primitive:
    """One shape where it stands. frame: None for one given in the scene's own axes; number: its own."""

    shape: Any
    frame: Frame | None
    number: Any

    def local(self, ray: SceneRay) -> tuple[Vector, Vector]:
        """Point and direction of a ray as the shape sees them."""
        if self.frame is None:
            return ray.point, ray.direction
        return self.frame.local(ray.point, ray.direction, ray.moment)

    def distance(self, ray: SceneRay) -> jax.Array:
        """To the nearest point of it, inf where it is not met."""
        point, direction = self.local(ray)
        distance = jnp.full_like(ray.point[0], jnp.inf)
        for root, real in self.shape.roots(point, direction, ray.start == self.number):
            distance = jnp.where(real & (root > 0) & (root < distance), root, distance)
        return distance


@pytree
class World:
    """What rays may meet.

    primitives:  their `Primitive`s, 0 to P - 1.
    searches:    for each kind of primitives how the nearest is found; see `search`.
    material:    (P,), number of the material of each.        materials: the materials.
    light:       (P,), number of the light that a primitive is, -1 for none; None where no primitive shines.
    lights:      point, distant and area lights, or None.
    chosen:      (L,), chance that this light or one before it is chosen; grows up to 1. The environment is the last.
    environment: light from beyond everything, or None.
    """

    primitives: Stack
    searches: tuple[Search, ...]
    material: jax.Array
    materials: Stack
    light: jax.Array | None
    lights: Stack | None
    chosen: jax.Array
    environment: Environment | None

    @property
    def mirrors(self) -> bool:
        """Whether any material sends a ray of its own on."""
        return any(kind.sends[0] for kind in self.materials.kinds)

    @property
    def refracts(self) -> bool:
        """Whether any material sends two."""
        return any(kind.sends[1] for kind in self.materials.kinds)

    @property
    def moves(self) -> bool:
        """Whether any primitive moves while the shutter is open."""
        return any(kind.frame is not None and kind.frame.motion is not None for kind in self.primitives.kinds)

    @property
    def disperses(self) -> bool:
        """Whether the wavelength makes a difference to any material."""
        return any(kind.disperses for kind in self.materials.kinds)
