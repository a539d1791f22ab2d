"""The part of a conic about its vertex, out to a semi-diameter."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.shapes.shape import Roots, along
from lenstrace.optics.vectors import Vector, divide_where, dot


@pytree
class ConicCap:
    """F = z - c (x^2 + y^2 + (1 + k) z^2) / 2, where x^2 + y^2 <= semi_diameter^2, on the sheet through the vertex.

    surface: the conic.      semi_diameter: mm, inf for the whole sheet.
    """

    surface: Conic
    semi_diameter: jax.Array

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """The crossings toward +z and toward -z, see `Conic.crossing` and `Shape.roots`.

        From the surface, where F = 0, the other crossing is at 2 G / A, with G and A of `Conic.crossing`.
        """
        forth, back = (self.surface.crossing(point, direction, jnp.full_like(point[0], side)) for side in (1, -1))
        c, k, n = self.surface.curvature, self.surface.conic, direction[2]
        bend = c * (1 + k * n * n)
        other = divide_where(bend != 0, 2 * dot(self.normal(point), direction), bend)
        there = along(point, direction, other)
        other_met = (bend != 0) & (self.normal(there)[2] >= 0) & self._covers(there)
        first = forth.met & self._covers(forth.point) & ~on
        second = jnp.where(on, other_met, back.met & self._covers(back.point))
        return (
            (jnp.where(first, forth.distance, 0), first),
            (jnp.where(second, jnp.where(on, other, back.distance), 0), second),
        )

    def value(self, point: Vector) -> jax.Array:
        """F, mm."""
        x, y, z = point
        c, one_k = self.surface.curvature, 1 + self.surface.conic
        return z - c * (x * x + y * y + one_k * z * z) / 2

    def normal(self, point: Vector) -> Vector:
        """(-c x, -c y, 1 - (1 + k) c z)."""
        return self.surface.normal(*point)

    def bounds(self) -> tuple[Vector, Vector]:
        """Out to the semi-diameter, or to the rim of the conic; from the vertex to the sag there."""
        c, one_k, s = self.surface.curvature, 1 + self.surface.conic, self.semi_diameter
        within = one_k * c * c * s * s < 1
        s = jnp.where(within, s, 1 / jnp.sqrt(jnp.where(within, 1, one_k * c * c)))
        flat = (c == 0) & jnp.isinf(s)
        sag = jnp.where(c == 0, 0, c * s * s / (1 + jnp.sqrt(jnp.maximum(1 - one_k * c * c * s * s, 0))))
        sag = jnp.where(jnp.isnan(sag) & ~flat, jnp.copysign(jnp.inf, c), sag)
        return (-s, -s, jnp.minimum(sag, 0)), (s, s, jnp.maximum(sag, 0))

    def _covers(self, point: Vector) -> jax.Array:
        x, y, _ = point
        return x * x + y * y <= self.semi_diameter * self.semi_diameter
