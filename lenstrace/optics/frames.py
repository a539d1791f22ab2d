"""Poses: a frame that stands shifted and tilted in another one."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector, rotate, rotate_back, rotation


@pytree
class Pose:
    """Where a local frame stands: first shifted, then tilted about its moved origin.

    decenter: (2,), mm along the outer x and y.     tilt: (3,), radians.
    global_from_local = Rx Ry Rz, right-handed.
    """

    decenter: jax.Array
    tilt: jax.Array

    @property
    def matrix(self) -> jax.Array:
        """The rotation, (3, 3), global from local."""
        return rotation(self.tilt)

    def local_point(self, point: Vector) -> Vector:
        """A point of the outer frame, in mm, seen from the local one."""
        shifted = (point[0] - self.decenter[0], point[1] - self.decenter[1], point[2])
        return rotate_back(self.matrix, shifted)

    def local_direction(self, direction: Vector) -> Vector:
        """A direction of the outer frame seen from the local one."""
        return rotate_back(self.matrix, direction)

    def global_point(self, point: Vector) -> Vector:
        """A point of the local frame, in mm, seen from the outer one."""
        x, y, z = rotate(self.matrix, point)
        return x + self.decenter[0], y + self.decenter[1], z

    def global_direction(self, direction: Vector) -> Vector:
        """A direction of the local frame seen from the outer one."""
        return rotate(self.matrix, direction)


def placed(rotation_before: jax.Array, origin: jax.Array, pose: Pose) -> tuple[jax.Array, jax.Array]:
    """Rotation (3, 3) and origin (3,) in global axes of a frame posed in one that stands there."""
    shift = jnp.append(pose.decenter, jnp.zeros((), pose.decenter.dtype))
    return rotation_before @ pose.matrix, origin + rotation_before @ shift
