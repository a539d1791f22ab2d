"""What every light says of a point that it lights."""

from __future__ import annotations

from typing import NamedTuple

import jax

from lenstrace.optics.vectors import Vector
from lenstrace.scene.colours import Colour


class Lighting(NamedTuple):
    """One direction from which a light reaches a point.

    direction, distance:  unit vector toward the light; how far it is, inf for what is beyond everything.
    arriving:  radiance over the density of the direction, for a light without size its irradiance across the
               direction: times the cosine and the scattering it is the light that goes on. 0 where none arrives.
    density:   per solid angle, inf for a light without size: nothing else can hit upon it.
    target:    number of the primitive that shines, NOWHERE (-1) for none.
    """

    direction: Vector
    distance: jax.Array
    arriving: Colour
    density: jax.Array
    target: jax.Array
