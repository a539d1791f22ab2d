"""A solid given by a function of the place that is negative inside."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.shapes.bracket import bracketed_root
from lenstrace.optics.shapes.shape import Roots, along
from lenstrace.optics.shapes.spans import slab
from lenstrace.optics.vectors import Vector, divide_where, root_or_zero

# Steps of a march; a sphere of radius 1 that is passed or grazed at a ten thousandth of it takes about 450.
MOST_STEPS = 1024
# F is rounded by this many eps, in units of steepness times reach.
NOISE = 16.0
# Without a bound of its second derivatives F is taken to turn no more than once within this part of the reach.
PEEK = 1 / 16


class Found(NamedTuple):
    """How a search ended: the distance, whether the surface is there, and whether the steps were enough to tell."""

    distance: jax.Array
    real: jax.Array
    decided: jax.Array


@pytree
class Implicit:
    """F(x, y, z) = 0 inside the cube |x|, |y|, |z| <= reach.

    reach:      mm.
    steepness:  no gradient of F in the cube is longer than this (F in mm: about 1).
    bending:    no second derivative of F along a line in the cube is greater than this; inf where it is not known.
    numbers:    numbers that `function` also takes, by which derivatives may be asked for.
    function:   static, F of x, y, z and all `numbers`, each number by itself: made of jax.numpy, and one of a module,
                for a program is compiled for each. F is negative inside, and smooth near the surface.
    """

    reach: jax.Array
    steepness: jax.Array
    bending: jax.Array
    numbers: tuple[Any, ...] = ()
    function: Callable[..., jax.Array] = static(default=None)

    def roots(self, point: Vector, direction: Vector, on: jax.Array) -> Roots:
        """The first ahead of the start; see `Shape.roots` and `search`."""
        found = self.search(point, direction, on)
        return ((found.distance, found.real),)

    def search(self, point: Vector, direction: Vector, on: jax.Array) -> Found:
        """The first crossing ahead of the start.

        From a place where |F| = f the surface is at least

            max(f / L, 2 f / (-f' + sqrt(f'^2 + 2 M f)))

        away, L the steepness, M the bending and f' the derivative of f along the ray: a march by such steps passes no
        crossing, however near to the next. It ends where F is sure to have the other sign at twice the distance at
        which its tangent would be 0: where 2 M f < f'^2. (With M unknown: where that place is near, and F has the other
        sign there; of three crossings so near to each other it may then be the last that is found.) Between the two
        places the crossing is found to the last bit.
        A ray that passes so near that F is rounded to 0 takes all steps, and is then not decided: `real` is False. With
        M unknown that also befalls a ray that begins next to the surface, off it, and leaves it at a small angle.

        A ray that starts on the surface goes to the side where F has the sign of N.d. If the ray's second derivative of
        F leads it back, the march begins where the parabola of value 0, slope N.d and that curvature has turned; at
        its other crossing the search ends where all of it is lost in rounding.
        Source: Hart, The Visual Computer 12, 527 (1996); its step by second derivatives: Kalra & Barr, SIGGRAPH 1989.
        """
        eps = jnp.finfo(point[0].dtype).eps
        noise = NOISE * eps * self.steepness * self.reach
        least_step = eps * self.reach
        first, last = self._span(point, direction)

        def along_ray(t: jax.Array) -> jax.Array:
            return self.value(along(point, direction, t))

        def with_slope(t: jax.Array) -> tuple[jax.Array, jax.Array]:
            return jax.jvp(along_ray, (t,), (jnp.ones_like(t),))

        begin, returned, side = self._leave(with_slope, jnp.zeros_like(first), noise)
        first = jnp.where(on, begin, jnp.maximum(first, 0))
        side = jnp.where(on, side, jnp.where(along_ray(first) < 0, -1, 1).astype(first.dtype))

        def near(t: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
            """The step that is safe, the place beyond the crossing, and whether there is one between."""
            value, slope = with_slope(t)
            f, falls = side * value, -side * slope
            root = root_or_zero(falls * falls + 2 * jnp.where(self.bending < jnp.inf, self.bending, 0) * f)
            bound = jnp.where(self.bending < jnp.inf, divide_where(falls + root > 0, 2 * f, falls + root), 0)
            step = jnp.maximum(jnp.maximum(f / self.steepness, bound), least_step)
            span = divide_where(falls > 0, 2 * f, falls)
            beyond = jnp.minimum(t + span, last)
            close = jnp.where(self.bending < jnp.inf, 2 * self.bending * f < falls * falls, span < PEEK * self.reach)
            sure = (falls > 0) & close & (side * along_ray(beyond) < 0)
            return step, beyond, (f <= 0) | sure

        def unfinished(state: tuple[jax.Array, ...]) -> jax.Array:
            t, _, between, count = state
            return jnp.any(~between & (t < last)) & (count < MOST_STEPS)

        def advance(state: tuple[jax.Array, ...]) -> tuple[jax.Array, ...]:
            t, beyond, between, count = state
            going = ~between & (t < last)
            step, place, found = near(t)
            beyond, between = jnp.where(going, place, beyond), between | (going & found)
            return jnp.where(going & ~found, t + step, t), beyond, between, count + 1

        never = jnp.zeros(jnp.shape(first), bool)
        t, beyond, between, _ = lax.while_loop(unfinished, advance, (first, first, never, jnp.zeros((), int)))
        # the last step may have come to the other side by rounding
        low = jnp.where(between, t, 0)
        place, changes = bracketed_root(along_ray, low, jnp.where(between, beyond, 0), 4 * least_step)
        inside = last > 0
        place = jnp.where(returned & on, 2 * begin, jnp.where(changes, place, t))
        real = inside & (between | (returned & on))
        return Found(jnp.where(real, place, 0), real, real | (t >= last))

    def value(self, point: Vector) -> jax.Array:
        """F."""
        return self.function(*point, *self.numbers)

    def normal(self, point: Vector) -> Vector:
        """grad F, by automatic differentiation."""
        return jax.grad(lambda x, y, z: self.function(x, y, z, *self.numbers).sum(), (0, 1, 2))(*point)

    def bounds(self) -> tuple[Vector, Vector]:
        """The cube."""
        r = self.reach
        return (-r, -r, -r), (r, r, r)

    def _span(self, point: Vector, direction: Vector) -> tuple[jax.Array, jax.Array]:
        """Where the ray enters and leaves the cube; equal where it does not."""
        pairs = [slab(self.reach, p, d) for p, d in zip(point, direction, strict=True)]
        (x0, x1), (y0, y1), (z0, z1) = pairs
        first = jnp.maximum(jnp.maximum(x0, y0), z0)
        last = jnp.minimum(jnp.minimum(x1, y1), z1)
        met = (first < last) & (last > 0)
        return jnp.where(met, first, 0), jnp.where(met, last, 0)

    def _leave(
        self, with_slope: Callable[[jax.Array], tuple[jax.Array, jax.Array]], start: jax.Array, noise: jax.Array
    ) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Where a march from the surface begins; whether it is met again at twice that; the sign of F there."""
        (_, slope), (_, curve) = jax.jvp(with_slope, (start,), (jnp.ones_like(start),))
        side = jnp.where(slope < 0, -1, 1).astype(start.dtype)
        rate, back = jnp.abs(slope), -side * curve
        top = divide_where(back > 0, rate, back)
        returned = (back > 0) & (rate * top < 2 * noise)
        # F is then more than its rounding
        clear = jnp.minimum(
            2 * noise / jnp.maximum(rate, noise / self.reach),
            jnp.sqrt(2 * noise / jnp.maximum(jnp.abs(curve), noise / self.reach**2)),
        )
        safe = jnp.where(back > 0, jnp.minimum(top, PEEK * self.reach), 0)
        safe = jnp.where(self.bending < jnp.inf, rate / jnp.maximum(self.bending, noise / self.reach**2), safe)
        return jnp.where(returned, top, jnp.maximum(safe, clear)), returned, side
