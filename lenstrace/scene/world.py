"""A scene as numbers: primitives, materials and lights, stacked by kind. What a scene lacks is not in its program."""

from __future__ import annotations

from typing import Any

import jax

from lenstrace.compute.pytree import pytree
from lenstrace.scene.frame import Frame
from lenstrace.scene.lights.environment import Environment
from lenstrace.scene.stacks import Stack


@pytree
class Primitive:
    """One shape where it stands. frame: None for one given in the scene's own axes; number: its own."""

    shape: Any
    frame: Frame | None
    number: Any


@pytree
class World:
    """What rays may meet.

    primitives:  their `Primitive`s, 0 to P - 1.
    material:    (P,), number of the material of each.        materials: the materials.
    light:       (P,), number of the light that a primitive is, -1 for none; None where no primitive shines.
    lights:      point, distant and area lights, or None.
    chosen:      (L,), chance that this light or one before it is chosen; grows up to 1. The environment is the last.
    environment: light from beyond everything, or None.
    """

    primitives: Stack
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
