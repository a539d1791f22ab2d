"""Where a camera stands and where it looks, and what every camera says of a place in the picture."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree
from lenstrace.errors import CameraError
from lenstrace.optics.turns import cos_sin
from lenstrace.optics.vectors import Vector, cross, minus, normalize


class CameraRay(NamedTuple):
    """Rays into the scene. weight: by what the radiance they bring is multiplied; 0 where the camera blocks them."""

    point: Vector
    direction: Vector
    weight: jax.Array


@pytree
class View:
    """A camera's frame. position: of its pupil; target: a point on its axis; up: what is upright in the picture.

    Lengths of the scene; `up` of any length, not along the axis.
    """

    position: Vector
    target: Vector
    up: Any = (0.0, 1.0, 0.0)

    @property
    def axes(self) -> tuple[Vector, Vector, Vector]:
        """Unit vectors: right and up in the picture, and forward."""
        forward = normalize(minus(self.target, self.position))
        right = normalize(cross(forward, self.up))
        return right, cross(right, forward), forward

    def require_axes(self) -> None:
        """CameraError where position, target and up do not say where the picture's axes are."""
        axis = np.subtract(self.target, self.position)
        if not np.isfinite(axis).all() or not axis.any():
            raise CameraError(f"target must be another point than position, got {self.target}")
        if not np.cross(axis, self.up).any():
            raise CameraError(f"up must not point along the axis, got {self.up}")

    def outer(self, local: Vector) -> Vector:
        """A direction (right, up, forward) in the scene."""
        right, up, forward = self.axes
        x, y, z = (local[0] * r + local[1] * u + local[2] * f for r, u, f in zip(right, up, forward, strict=True))
        return x, y, z

    def outer_point(self, local: Vector) -> Vector:
        """A point (right, up, forward) of the camera in the scene."""
        x, y, z = (a + p for a, p in zip(self.outer(local), self.position, strict=True))
        return x, y, z


def on_disk(u: jax.Array, v: jax.Array) -> tuple[jax.Array, jax.Array]:
    """A point of the unit disk, uniform, from two numbers in [0, 1); (1/2, 1/2) is its centre, neighbours stay so.

    Source: P. Shirley, K. Chiu, J. Graphics Tools 2 (3), 45 (1997).
    """
    a, b = 2 * u - 1, 2 * v - 1
    wide = jnp.abs(a) > jnp.abs(b)
    radius, other = jnp.where(wide, a, b), jnp.where(wide, b, a)
    turn = jnp.pi / 4 * other / jnp.where(radius == 0, 1, radius)
    cos, sin = cos_sin(turn)
    along, across = radius * cos, radius * sin
    return jnp.where(wide, along, across), jnp.where(wide, across, along)
