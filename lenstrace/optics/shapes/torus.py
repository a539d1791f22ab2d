"""The torus about the z axis."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.bracket import bracketed_root
from lenstrace.optics.shapes.pieces import crossings
from lenstrace.optics.shapes.shape import Roots, along
from lenstrace.optics.vectors import Vector, divide_where, dot, root_or_zero, safe_divide

# The ray is searched this many times R + r to either side of its point nearest to the centre: beyond all crossings.
BEYOND = 1.125


@pytree
class Torus:
    """F = (D^2 - r^2) / (2 r), D^2 = (rho - R)^2 + z^2, rho^2 = x^2 + y^2: all points within r of a circle.

    major: R, mm.      minor: r, 0 < r < R, mm.
    """

    major: jax.Array
    minor: jax.Array

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """Up to four; see `Shape.roots`.

        D is the distance to the circle, which is not expanded into a quartic: the powers of the coordinates would
        lose what a thin torus, a far start or a grazing ray leaves. Along the ray, t from its point nearest to the
        centre, half the derivative of D^2 is

            g(t) = t - R sqrt(A) s(t),   s = u / sqrt(u^2 + h^2),   u = sqrt(A) (t - t_a),   A = l^2 + m^2

        where h is the distance of the ray from the axis, nearest at t_a: a straight line less one bend. So D^2 has
        one least value on the side of the axis where the centre is, and on the other side either none, or one least
        and one greatest, on either side of

            (u^2 + h^2)^3 = (R A h^2)^2,

        the place where g turns. Between them D^2 is monotone, and a crossing is where it passes r^2, or, of a ray that
        starts on the torus, the value at its start.
        """
        far = -dot(point, direction)
        near = along(point, direction, far)
        rest = -dot(near, direction)
        foot = along(near, direction, rest)
        middle = far + rest
        size = self.major + self.minor
        width = 4 * jnp.finfo(far.dtype).eps * size
        start = -middle
        ends = self._turns(foot, direction, size, width)
        rim = jnp.where(on, self._distance_squared(along(foot, direction, start)), self.minor * self.minor)

        # going outward, it comes nearer again only beyond a place of greatest distance
        outward = on & (dot(self.normal(point), direction) >= 0)
        _, first, greatest, second, _ = ends
        ends[1] = jnp.where(outward, jnp.minimum(first, start), first)
        ends[3] = jnp.where(outward & (greatest <= start), jnp.minimum(second, start), second)

        def level(t: jax.Array) -> jax.Array:
            return self._distance_squared(along(foot, direction, t)) - rim

        return tuple((jnp.where(real, middle + t, 0), real) for t, real in crossings(level, ends, start, on, width))

    def value(self, point: Vector) -> jax.Array:
        """F, mm."""
        x, y, z = point
        across = root_or_zero(x * x + y * y) - self.major
        return (across * across + z * z - self.minor * self.minor) * (0.5 / self.minor)

    def normal(self, point: Vector) -> Vector:
        """From the nearest point of the circle, over r."""
        x, y, z = point
        inverse = 1 / self.minor
        share = inverse - safe_divide(self.major * inverse, root_or_zero(x * x + y * y))
        return x * share, y * share, z * inverse

    def bounds(self) -> tuple[Vector, Vector]:
        """The box about the torus."""
        size, r = self.major + self.minor, self.minor
        return (-size, -size, -r), (size, size, r)

    def _distance_squared(self, point: Vector) -> jax.Array:
        x, y, z = point
        across = jnp.sqrt(x * x + y * y) - self.major
        return across * across + z * z

    def _turns(self, foot: Vector, direction: Vector, size: jax.Array, width: jax.Array) -> list[jax.Array]:
        """Where D^2 is least, greatest and least again, between two ends beyond all crossings; ascending.

        Where there is but one least value the other two are at an end.
        """
        (x, y, _), (l, m, n) = foot, direction
        a = l * l + m * m
        root_a = jnp.sqrt(a)
        # all turns are well within this; no ray is searched that passes outside
        shadow = jnp.where(dot(foot, foot) < size * size, self.major * root_a + width, 0)
        nearest = -divide_where(a > 0, x * l + y * m, a)
        # the sense in which the axis comes before the centre: there the turn that always exists comes last
        sense = jnp.where(nearest > 0, -1, 1).astype(a.dtype)
        nearest = jnp.clip(sense * nearest, -shadow, shadow)
        turned = sense * l, sense * m, sense * n

        h = divide_where(a > 0, jnp.abs(x * m - y * l), root_a)
        bend = jnp.cbrt(self.major * a * h * h)
        # of a ray through the axis both places are there, where g leaps: a bracket begins clear of the leap
        aside = jnp.maximum(divide_where(a > 0, root_or_zero((bend - h) * (bend + h)), root_a), width)
        peak, valley = jnp.maximum(nearest - aside, -shadow), jnp.minimum(nearest + aside, shadow)

        def slope(t: jax.Array) -> jax.Array:
            x, y, z = along(foot, turned, t)
            rho = jnp.sqrt(x * x + y * y)
            inward = x * turned[0] + y * turned[1]
            return inward + z * turned[2] - self.major * divide_where(rho > 0, inward, rho)

        low = jnp.stack([-shadow, peak, valley])
        high = jnp.stack([peak, nearest, shadow])
        places, real = bracketed_root(slope, low, high, width)
        end = jnp.ones_like(a) * (BEYOND * size)
        # where g does not change its sign it is 0 at an end of the bracket
        greatest = jnp.where(real[1], places[1], nearest)
        turns = [jnp.where(real[0], p, -end) for p in (places[0], greatest)]
        turns += [jnp.where(real[2], places[2], valley)]
        ascending = [-end, *turns, end]
        return [jnp.where(sense > 0, p, -q) for p, q in zip(ascending, reversed(ascending), strict=True)]
