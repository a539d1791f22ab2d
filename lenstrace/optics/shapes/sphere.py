"""The sphere about the origin."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.shape import Roots, along
from lenstrace.optics.turns import turned
from lenstrace.optics.vectors import Vector, dot, root_or_zero


@pytree
class Sphere:
    """F = (x^2 + y^2 + z^2 - R^2) / (2 R).      radius: R > 0, mm."""

    radius: jax.Array

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """t = m -+ sqrt(R^2 - |f|^2), f = r + m d the ray's point nearest to the centre; see `Shape.roots`.

        The foot f is found in two steps, m = -r.d and what the rounding of that leaves over: R^2 - |f|^2 then loses no
        digits to the distance of the ray's start, as (r.d)^2 - |r|^2 + R^2 would. From the sphere itself, where
        |r| = R, the roots are 0 and -2 r.d.
        Source: Haines et al., Ray Tracing Gems (2019), ch. 7, Eq. (5).
        """
        far = -dot(point, direction)
        near = along(point, direction, far)
        rest = -dot(near, direction)
        foot = along(near, direction, rest)
        middle = far + rest
        half = root_or_zero(self.radius * self.radius - dot(foot, foot))
        met = half > 0
        return (
            (jnp.where(met, middle - half, 0), met & ~on),
            (jnp.where(on, 2 * far, jnp.where(met, middle + half, 0)), met | on),
        )

    def value(self, point: Vector) -> jax.Array:
        """F, mm."""
        return (dot(point, point) - self.radius * self.radius) * (0.5 / self.radius)

    def normal(self, point: Vector) -> Vector:
        """(x, y, z) / R."""
        x, y, z = point
        inverse = 1 / self.radius
        return x * inverse, y * inverse, z * inverse

    def bounds(self) -> tuple[Vector, Vector]:
        """-R to R."""
        r = self.radius
        return (-r, -r, -r), (r, r, r)

    def area(self) -> jax.Array:
        """4 pi R^2, mm^2."""
        return 4 * jnp.pi * self.radius * self.radius

    def place(self, u: jax.Array, v: jax.Array) -> Vector:
        """The point of two numbers in [0, 1): even numbers give points even by area.

        z / R = 1 - 2 u by Archimedes' theorem, and the angle 2 pi v about z.
        """
        across = 2 * self.radius * root_or_zero(u * (1 - u))
        cos, sin = turned(v)
        return across * cos, across * sin, self.radius * (1 - 2 * u)
