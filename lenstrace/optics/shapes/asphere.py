"""The conic with a power series in r added; even and odd powers.

The series is taken in r / r_norm, so that its highest powers overflow in no precision, and a lens scaled by a power of
two gives the same bits.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.rays import RayStatus
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.shapes.crossing import Crossing, approach
from lenstrace.optics.vectors import Vector, safe_divide, safe_sqrt

MOST_NEWTON_STEPS = 12
# No step follows one below this many square roots of eps, in units of the numbers involved: each step is about the
# square of the one before, over the radius of curvature.
LAST_STEP = 0.03
# A crossing is found where the step that would follow is below this many eps: what cancels in a steep series is noise
# in that step, not an error left over.
NEWTON_TOLERANCE = 1e4
# A crossing lies within this many times the ray's own distance from the vertex; farther away a series overflows.
FARTHEST = 1e3


@pytree
class Asphere:
    """z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)) + r_norm sum over p of b_p (r / r_norm)^p.

    curvature:     c = 1 / R, 1/mm.                 conic: k.
    coefficients:  (T,), b_p = a_p r_norm^(p - 1), pure numbers, for a term a_p r^p.
    norm_radius:   r_norm, mm.                      powers: T ascending positive integers p, static.
    newton_steps:  static; None: as many as any ray of a block gains by, at most 12, else NOT_CONVERGED. A number: at
                   most so many, and the ray is taken as it then is.
    """

    curvature: jax.Array
    conic: jax.Array
    coefficients: jax.Array
    norm_radius: jax.Array
    powers: tuple[int, ...] = static()
    newton_steps: int | None = static(default=None)

    def sag(self, x: jax.Array, y: jax.Array) -> jax.Array:
        """Height above the vertex plane, mm; nan beyond the rim of the conic. x, y: mm, one shape."""
        return Conic(self.curvature, self.conic).sag(x, y) + self._departure(x * x + y * y)

    def slopes(self, x: jax.Array, y: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Sag (mm), and its slope divided by r (1/mm), finite everywhere; and whether r is inside the rim."""
        r2 = x * x + y * y
        inside = 1 - (1 + self.conic) * self.curvature**2 * r2
        root = safe_sqrt(inside)
        sag = self.curvature * r2 / (1 + root) + self._departure(r2)
        return sag, self.curvature / root + self._departure_slope(r2), inside > 0

    def normal(self, x: jax.Array, y: jax.Array) -> Vector:
        """(-dz/dx, -dz/dy, 1), not normalized."""
        _, slope, _ = self.slopes(x, y)
        return -x * slope, -y * slope, jnp.ones_like(x)

    def crossing(self, point: Vector, direction: Vector, side: jax.Array) -> Crossing:
        """The crossing with the sheet through the vertex; arguments as for `Conic.crossing`.

        Newton's method on z + t n - sag(x + t l, y + t m), from the conic's crossing or from the place near the
        vertex plane, whichever is nearer the surface, until no ray of the block gains by another step. The
        derivative is that of the implicit function, to every order, and does not pass through the iteration.
        """
        before, near = approach(point, direction)
        (x, y, z), (l, m, n) = near, direction

        def residual(t: jax.Array) -> jax.Array:
            return z + t * n - self.slopes(x + t * l, y + t * m)[0]

        def step(t: jax.Array) -> jax.Array:
            px, py = x + t * l, y + t * m
            sag, slope, _ = self.slopes(px, py)
            return safe_divide(z + t * n - sag, n - slope * (px * l + py * m))

        start = Conic(self.curvature, self.conic).crossing(near, direction, side)
        use_conic = start.met & (jnp.abs(residual(start.distance)) < jnp.abs(residual(jnp.zeros_like(x))))
        first = jnp.where(use_conic, start.distance, 0.0)

        eps = jnp.finfo(x.dtype).eps
        most = MOST_NEWTON_STEPS if self.newton_steps is None else self.newton_steps
        scale = jnp.abs(x) + jnp.abs(y) + jnp.abs(z)

        def unfinished(state: tuple[jax.Array, jax.Array, jax.Array]) -> jax.Array:
            t, last, count = state
            return jnp.any(jnp.abs(last) > LAST_STEP * eps**0.5 * (scale + jnp.abs(t))) & (count < most)

        def advance(state: tuple[jax.Array, jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array, jax.Array]:
            t, _, count = state
            change = step(t)
            # one that runs away stays where it is: its numbers remain finite
            change = jnp.where(jnp.abs(t - change) < FARTHEST * scale, change, 0)
            return t - change, change, count + 1

        def solve(_: object, guess: jax.Array) -> jax.Array:
            return lax.while_loop(unfinished, advance, (guess, jnp.full_like(guess, jnp.inf), jnp.zeros((), int)))[0]

        t = lax.custom_root(residual, lax.stop_gradient(first), solve, _elementwise_solve)
        converged = jnp.abs(step(t)) <= NEWTON_TOLERANCE * eps * (scale + jnp.abs(t))
        x, y, z = x + t * l, y + t * m, z + t * n
        _, slope, inside = self.slopes(x, y)
        normal = (-x * slope, -y * slope, jnp.ones_like(x))
        normal_squared = normal[0] ** 2 + normal[1] ** 2 + 1
        cosine = side * (normal[0] * l + normal[1] * m + n)
        # beyond the rim there is no surface; a crossing in the wrong sense leaves open whether there is a right one
        found = inside & (cosine > 0)
        reason: jax.Array | int = int(RayStatus.MISSED)
        if self.newton_steps is None:
            found &= converged
            reason = jnp.where(inside, int(RayStatus.NOT_CONVERGED), reason)
        return Crossing(before + t, (x, y, z), normal, normal_squared, jnp.abs(cosine), found, reason)

    def _departure(self, r2: jax.Array) -> jax.Array:
        """r_norm sum b_p (r / r_norm)^p."""
        terms = [self.coefficients[i] for i in range(len(self.powers))]
        return self.norm_radius * self._series(terms, self.powers, self._normalized(r2))

    def _departure_slope(self, r2: jax.Array) -> jax.Array:
        """(1 / r) d/dr of the series: sum p b_p (r / r_norm)^(p - 2) / r_norm."""
        terms = [p * self.coefficients[i] for i, p in enumerate(self.powers)]
        return self._series(terms, tuple(p - 2 for p in self.powers), self._normalized(r2)) * (1 / self.norm_radius)

    def _normalized(self, r2: jax.Array) -> jax.Array:
        """(r / r_norm)^2; the reciprocal of a power of two is exact, and is taken once for all rays."""
        return r2 * (1 / (self.norm_radius * self.norm_radius))

    @staticmethod
    def _series(terms: list[jax.Array], powers: tuple[int, ...], r2: jax.Array) -> jax.Array:
        """sum of terms[i] r^powers[i], by Horner's rule in r^2, or in r where a power is odd."""
        total = jnp.zeros_like(r2)
        for i in reversed(range(len(powers))):
            total = terms[i] + total
            total = total * _power(r2, powers[i] - (powers[i - 1] if i else 0))
        return total


def _power(r2: jax.Array, power: int) -> jax.Array | float:
    """r^power for a static integer; r^-1 is 0 at the vertex, where a cone has no slope."""
    if power == 0:
        return 1.0
    if power == -1:
        return safe_divide(jnp.where(r2 > 0, 1.0, 0.0).astype(r2.dtype), safe_sqrt(r2))
    if power % 2 == 0:
        return r2 ** (power // 2)
    return jnp.where(r2 > 0, safe_sqrt(r2), 0.0) * (r2 ** (power // 2) if power > 1 else 1.0)


def _elementwise_solve(linear: object, value: jax.Array) -> jax.Array:
    """Solve g(t) = value for a linear g that acts on every ray by itself."""
    return safe_divide(value, linear(jnp.ones_like(value)))  # type: ignore[operator]
