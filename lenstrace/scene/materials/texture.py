"""Colours that change from place to place: one colour, or the fields of a board."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector
from lenstrace.scene.colours import Colour


@pytree
class Checker:
    """Cubes of two colours in turn, in the axes of the scene. size: of their edges; origin: a corner of one.

    A surface in the boundary of two cubes would be of both: choose the origin so that none is.
    """

    even: Any
    odd: Any
    size: Any = 1.0
    origin: Any = (0.0, 0.0, 0.0)

    def at(self, point: Vector) -> Colour:
        """The colour at a point of the scene."""
        cell = sum(jnp.floor((a - b) / self.size) for a, b in zip(point, self.origin, strict=True))
        is_odd = jnp.mod(cell, 2) > 0
        r, g, b = (jnp.where(is_odd, a, b) for a, b in zip(self.odd, self.even, strict=True))
        return r, g, b


def colour_at(colour: Any, point: Vector) -> Colour:
    """Of three numbers, or of a texture."""
    if isinstance(colour, Checker):
        return colour.at(point)
    r, g, b = (jnp.broadcast_to(each, point[0].shape) for each in colour)
    return r, g, b
