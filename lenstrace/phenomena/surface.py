"""One ray at one surface, by the law of interaction of the tracer."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.optics.interactions import Interaction, bend
from lenstrace.optics.vectors import Vector, dot


def refracted(
    direction: Vector, normal: Vector, index_before: jax.Array, index_after: jax.Array
) -> tuple[Vector, jax.Array]:
    """Directions behind a surface, and where light goes on; the indices may be negative. normal: any length."""
    return _bent(Interaction.REFRACT_EITHER_SIGN, direction, normal, index_before, index_after)


def reflected(direction: Vector, normal: Vector) -> Vector:
    """Directions of the light that a surface sends back; normal: any length."""
    one = jnp.ones_like(dot(direction, normal))
    return _bent(Interaction.REFLECT, direction, normal, one, one)[0]


def _bent(
    interaction: Interaction, direction: Vector, normal: Vector, index_before: jax.Array, index_after: jax.Array
) -> tuple[Vector, jax.Array]:
    along = dot(direction, normal)
    side = jnp.where(along < 0, -1.0, 1.0)
    met = jnp.ones_like(along, bool)
    square = dot(normal, normal)
    return bend(interaction, direction, normal, square, jnp.abs(along), side, index_before, index_after, met)
