"""Rays: where light is, where it goes, how far it has come, and whether it still lives."""

from __future__ import annotations

import enum
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree


class RayStatus(enum.IntEnum):
    """What became of a ray. The text of each is what a user reads."""

    OK = 0
    MISSED = 1
    CLIPPED = 2
    TIR = 3
    NOT_CONVERGED = 4

    @property
    def text(self) -> str:
        """The reason in words."""
        return _TEXT[self]


_TEXT = {
    RayStatus.OK: "ok",
    RayStatus.MISSED: "missed",
    RayStatus.CLIPPED: "clipped",
    RayStatus.TIR: "total internal reflection",
    RayStatus.NOT_CONVERGED: "not converged",
}

Integers = TypeVar("Integers", jax.Array, np.ndarray)

_REASONS = 8  # failure = surface * _REASONS + reason, one integer a ray


@pytree
class Ray:
    """One ray or an array of rays; all fields broadcast to one shape.

    x, y, z:    a point of the ray, mm.
    l, m, n:    direction cosines (a unit vector).
    failure:    0 for a living ray, else the first failure, see `status` and `surface`. A failed ray keeps
                finite numbers, so that gradients stay finite.
    opl:        optical path length from the launch point, mm; None where nobody asked for it.
    """

    x: jax.Array
    y: jax.Array
    z: jax.Array
    l: jax.Array
    m: jax.Array
    n: jax.Array
    failure: jax.Array
    opl: jax.Array | None = None

    @property
    def status(self) -> jax.Array:
        """`RayStatus` of each ray, as integers."""
        return status_of(self.failure)

    @property
    def surface(self) -> jax.Array:
        """Number of the surface where the ray failed; 0 for a living ray."""
        return self.failure // _REASONS

    @property
    def ok(self) -> jax.Array:
        """True where the ray lives."""
        return self.failure == 0

    @property
    def has_course(self) -> jax.Array:
        """True where the ray lives, or was only stopped by an aperture: its numbers are those of a real course."""
        return has_course(self.failure)


def failure_code(surface: jax.Array | int, status: jax.Array | RayStatus) -> jax.Array | int:
    """The integer that `Ray.failure` holds for a ray that failed at `surface` for the reason `status`."""
    return surface * _REASONS + status


def status_of(failure: Integers) -> Integers:
    """`RayStatus` of rays, as integers; failure: see `Ray`."""
    return failure % _REASONS


def has_course(failure: jax.Array) -> jax.Array:
    """True where the numbers of a ray are those of a real course; failure: see `Ray`."""
    status = status_of(failure)
    return (status == int(RayStatus.OK)) | (status == int(RayStatus.CLIPPED))


def split_failure(failure: int) -> tuple[int, RayStatus]:
    """Surface number and reason out of one value of `Ray.failure`."""
    return failure // _REASONS, RayStatus(failure % _REASONS)


def living(x: jax.Array, y: jax.Array, z: jax.Array, l: jax.Array, m: jax.Array, n: jax.Array) -> Ray:
    """Rays that have met nothing yet, all numbers broadcast to one shape. Points in mm, unit directions."""
    numbers = jnp.broadcast_arrays(x, y, z, l, m, n)
    return Ray(*numbers, failure=jnp.zeros(numbers[0].shape, jnp.int32))
