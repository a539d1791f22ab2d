"""The part of an asphere about its vertex, out to a semi-diameter."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.bracket import bracketed_root
from lenstrace.optics.shapes.crossing import approach
from lenstrace.optics.shapes.pieces import crossings
from lenstrace.optics.shapes.shape import Roots
from lenstrace.optics.shapes.spans import slab, tube
from lenstrace.optics.vectors import Vector

# A bound of the sag is made wider by this part of itself, so that a ray crosses a surface before it leaves the bound.
MARGIN = 1 / 64


@pytree
class AsphereCap:
    """F = z - sag(x, y), where x^2 + y^2 <= semi_diameter^2, within the rim of the asphere's conic.

    surface: the asphere, of which `newton_steps` is not used here.      semi_diameter: mm, finite.
    """

    surface: Asphere
    semi_diameter: jax.Array

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """Eight candidates; see `Shape.roots`.

        The part of the ray in a cylinder about the cap is halved at its point nearest to the axis, each half at its
        inflection (there is taken to be no more than one), and each of these parts where F along the ray turns. On the
        pieces F is monotone, and a crossing lies where its sign changes.
        """
        before, near = approach(point, direction)
        before = jnp.where(on, 0, before)
        x, y, z = (jnp.where(on, p, q) for p, q in zip(point, near, strict=True))
        l, m, n = direction
        deepest = self._deepest()
        middle, half, met = tube(self._squared_radius(), x, y, l, m)
        z_near, z_far = slab(deepest * (1 + MARGIN), z, n)
        first, last = jnp.maximum(middle - half, z_near), jnp.minimum(middle + half, z_far)
        met &= first < last
        first, last = jnp.where(met, first, 0), jnp.where(met, last, 0)
        start = jnp.zeros_like(x)
        first, last = (jnp.where(on, jnp.maximum(end, start), end) for end in (first, last))
        middle = jnp.clip(middle, first, last)

        def level(t: jax.Array) -> jax.Array:
            return z + t * n - self.surface.slopes(x + t * l, y + t * m)[0]

        def rise(t: jax.Array) -> jax.Array:
            px, py = x + t * l, y + t * m
            return n - self.surface.slopes(px, py)[1] * (px * l + py * m)

        def bend(t: jax.Array) -> jax.Array:
            return jax.jvp(rise, (t,), (jnp.ones_like(t),))[1]

        width = jnp.finfo(x.dtype).eps * (self.semi_diameter + deepest) * 4
        straight, _ = bracketed_root(bend, jnp.stack([first, middle]), jnp.stack([middle, last]), width)
        parts = [first, jnp.clip(straight[0], first, middle), middle, jnp.clip(straight[1], middle, last), last]
        turns, turned = bracketed_root(rise, jnp.stack(parts[:-1]), jnp.stack(parts[1:]), width)
        ends, steady = [first], on
        for i, part in enumerate(parts[1:]):
            # of a ray that starts on the cap the first piece ends only where F turns
            turn = jnp.where(turned[i], turns[i], parts[i])
            ends += [jnp.where(steady & ~turned[i], start, turn)]
            steady &= ~turned[i]
            ends += [jnp.where(steady, start, part)]
        ends[-1] = last
        found = crossings(level, ends, start, on, width)
        return tuple((jnp.where(real & met, before + t, 0), real & met) for t, real in found)

    def value(self, point: Vector) -> jax.Array:
        """F, mm."""
        x, y, z = point
        return z - self.surface.slopes(x, y)[0]

    def normal(self, point: Vector) -> Vector:
        """(-dz/dx, -dz/dy, 1)."""
        return self.surface.normal(point[0], point[1])

    def bounds(self) -> tuple[Vector, Vector]:
        """Out to the semi-diameter; along z as far as the conic and all terms together could reach to either side."""
        s, deepest = jnp.sqrt(self._squared_radius()), self._deepest()
        return (-s, -s, -deepest), (s, s, deepest)

    def _squared_radius(self) -> jax.Array:
        """That of the semi-diameter, or of the rim of the conic where that is nearer."""
        least = (1 + self.surface.conic) * self.surface.curvature**2
        s2 = self.semi_diameter * self.semi_diameter
        within = least * s2 < 1
        return jnp.where(within, s2, 1 / jnp.where(within, 1, least))

    def _deepest(self) -> jax.Array:
        """No point of the cap is farther from the vertex plane, mm."""
        a, s2 = self.surface, self._squared_radius()
        root = jnp.sqrt(jnp.maximum(1 - (1 + a.conic) * a.curvature**2 * s2, 0))
        reach = jnp.sqrt(s2) / a.norm_radius
        terms = [jnp.abs(a.coefficients[i]) * reach**power for i, power in enumerate(a.powers)]
        return jnp.abs(a.curvature) * s2 / (1 + root) + a.norm_radius * sum(terms)
