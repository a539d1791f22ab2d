"""What a material may ask about the place where light meets it."""

from __future__ import annotations

from typing import NamedTuple

import jax

from lenstrace.optics.vectors import Vector


class Place(NamedTuple):
    """point: in the scene.    outside: whether the viewer is on the side of the outward normal.
    um: wavelength; None where no material asks for it."""

    point: Vector
    outside: jax.Array
    um: jax.Array | None
