"""The triangle; between two that share an edge no ray goes through."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.shape import Roots
from lenstrace.optics.vectors import Vector, dot, normalize, root_or_zero


@pytree
class Triangle:
    """F = N . (r - a), N the unit vector along (b - a) x (c - a).

    a, b, c: corners, mm, in the frame of the rays; not on one line.
    """

    a: Vector
    b: Vector
    c: Vector

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """The crossing with the triangle, both of whose sides count; see `Shape.roots`.

        The corners are seen from the ray: about its start, the axis along which it goes farthest taken for z, and
        sheared so that it runs along z. It goes through the triangle where the three

            U = c_x b_y - c_y b_x,   V = a_x c_y - a_y c_x,   W = b_x a_y - b_y a_x

        have one sign, 0 counting as either, at t = (U a_z + V b_z + W c_z) / (U + V + W) / d_z. The signs are those of
        comparisons between two products: in the neighbour, which has the edge in the other sense, they are the
        opposite to the last bit, also where the compiler fuses a product with a difference. At a corner all triangles
        see the same corner.
        Source: Woop, Benthin & Wald, Journal of Computer Graphics Techniques 2 (1), 65 (2013), sections 3 and 4.
        """
        l, m, n = (jnp.abs(d) for d in direction)
        most_x = (l >= m) & (l >= n)
        most_y = ~most_x & (m >= n)

        def turned(p: Vector) -> Vector:
            """The axes in cyclic order, so that the ray goes farthest along the last."""
            x, y, z = p
            return (
                jnp.where(most_x, y, jnp.where(most_y, z, x)),
                jnp.where(most_x, z, jnp.where(most_y, x, y)),
                jnp.where(most_x, x, jnp.where(most_y, y, z)),
            )

        along_x, along_y, along_z = turned(direction)
        inverse = 1 / along_z
        shear_x, shear_y = along_x * inverse, along_y * inverse

        def seen(corner: Vector) -> Vector:
            """A corner from the ray, which runs along z."""
            x, y, z = turned((corner[0] - point[0], corner[1] - point[1], corner[2] - point[2]))
            return x - shear_x * z, y - shear_y * z, z

        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = seen(self.a), seen(self.b), seen(self.c)
        edges = ((cx * by, cy * bx), (ax * cy, ay * cx), (bx * ay, by * ax))
        (left, right), *others = edges
        above, below = left >= right, left <= right
        for left, right in others:
            above, below = above & (left >= right), below & (left <= right)
        # where rounding has made a product the greater, the fused difference may have the other sign, or be 0
        u, v, w = (jnp.maximum(jnp.where(above, left - right, right - left), 0) for left, right in edges)
        total = u + v + w
        # of a triangle seen along its plane all three are 0
        real = (above ^ below) & (total > 0) & ~on
        distance = (u * az + v * bz + w * cz) * inverse / jnp.where(real, total, 1)
        return ((jnp.where(real, distance, 0), real),)

    def value(self, point: Vector) -> jax.Array:
        """F, mm."""
        return dot(normalize(self._across()), self._from_a(point))

    def normal(self, point: Vector) -> Vector:
        """N, everywhere."""
        x, y, z = (n + jnp.zeros_like(p) for n, p in zip(normalize(self._across()), point, strict=True))
        return x, y, z

    def bounds(self) -> tuple[Vector, Vector]:
        """The box about the corners."""
        corners = list(zip(self.a, self.b, self.c, strict=True))
        (x0, y0, z0), (x1, y1, z1) = (
            [pick(pick(p, q), r) for p, q, r in corners] for pick in (jnp.minimum, jnp.maximum)
        )
        return (x0, y0, z0), (x1, y1, z1)

    def area(self) -> jax.Array:
        """|(b - a) x (c - a)| / 2, mm^2."""
        across = self._across()
        return jnp.sqrt(dot(across, across)) / 2

    def place(self, u: jax.Array, v: jax.Array) -> Vector:
        """The point of two numbers in [0, 1): even numbers give points even by area.

        a + sqrt(u) ((1 - v) (b - a) + v (c - a)): the part of the triangle nearer to a than a line along b c grows as
        the square of its distance.
        Source: Turk, Graphics Gems (1990), p. 24.
        """
        s = root_or_zero(u)
        x, y, z = (p + s * ((1 - v) * (q - p) + v * (r - p)) for p, q, r in zip(self.a, self.b, self.c, strict=True))
        return x, y, z

    def _from_a(self, point: Vector) -> Vector:
        return point[0] - self.a[0], point[1] - self.a[1], point[2] - self.a[2]

    def _across(self) -> Vector:
        """(b - a) x (c - a), mm^2."""
        (x, y, z), (l, m, n) = self._from_a(self.b), self._from_a(self.c)
        return y * n - z * m, z * l - x * n, x * m - y * l
