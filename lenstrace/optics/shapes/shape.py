"""What every shape of a scene reports of a ray, and the distance to it that carries derivatives."""

from __future__ import annotations

from typing import Any, Protocol

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import Vector, divide_finite_where, divide_where, dot

# A Newton step is taken where the ray crosses the surface more steeply than this many square roots of eps: a flatter
# one divides the rounding of F by next to nothing.
STEEP = 8.0

# Candidate distances along a ray, mm, with their masks: finite numbers without meaning where a mask is False.
Roots = tuple[tuple[jax.Array, jax.Array], ...]


class Shape(Protocol):
    """A surface F(x, y, z) = 0 in its own frame, mm.

    The numbers of a shape are scalars, or arrays that broadcast with the rays, of the type of the rays.
    """

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """Signed distances along unit directions at which the rays meet the shape, in any order, not differentiated.

        on: True where the ray starts on this shape, up to rounding. That crossing is then left out: not by its
        distance, but by the algebra of the shape, so that no ray meets its own shape again where it starts.
        """
        ...

    def value(self, point: Vector) -> jax.Array:
        """F, negative inside solids; smooth near the surface, and about the distance to it where that is cheap."""
        ...

    def normal(self, point: Vector) -> Vector:
        """grad F at a point of the surface, of any length: outward of solids, +z at the vertex of open shapes."""
        ...

    def bounds(self) -> tuple[Vector, Vector]:
        """Lowest and highest corner of a box that holds the shape, mm; inf where there is none."""
        ...


def along(point: Vector, direction: Vector, distance: jax.Array) -> Vector:
    """The point `distance` along the ray."""
    x, y, z = (p + distance * d for p, d in zip(point, direction, strict=True))
    return x, y, z


@jax.custom_jvp
def touch(shape: Shape, point: Vector, direction: Vector, distance: jax.Array) -> jax.Array:
    """The distance t to a crossing that is known nearly, refined by one step of Newton's method:

        t - F(r + t d) / (grad F . d)

    where the ray is steep enough for that to be an improvement. The derivatives, by all numbers of the shape and of
    the ray and to every order, are those of the implicit function F(r + t d) = 0; they are 0 where the ray is tangent,
    and those of `distance` are not asked for.
    """
    place = along(point, direction, distance)
    normal = shape.normal(place)
    slope = dot(normal, direction)
    steep = slope * slope > STEEP**2 * jnp.finfo(slope.dtype).eps * dot(normal, normal)
    return distance - divide_where(steep, shape.value(place), slope)


@touch.defjvp
def _(primals: Any, tangents: Any) -> Any:
    """At the crossing dF = 0: the change of F at a place fixed on the ray, plus grad F . d dt."""
    distance = touch(*primals)

    def level(shape: Shape, point: Vector, direction: Vector) -> jax.Array:
        return shape.value(along(point, direction, distance))

    shape, point, direction, _ = primals
    _, change = jax.jvp(level, (shape, point, direction), tuple(tangents[:3]))
    slope = dot(shape.normal(along(point, direction, distance)), direction)
    return distance, divide_finite_where(slope != 0, -change, slope)
