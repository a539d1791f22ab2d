"""Ray aiming: the ray of a field that meets the stop at a given point, by Newton's method with continuation.

For every ray two unknowns (a shift in front of the lens) are to bring two numbers (the place on the stop) to
their targets. Newton's method with the derivative of the traced ray starts at the paraxial ray. Where it
fails, field and pupil are scaled down together to a share that succeeds, and brought up from there in steps
that adapt; every ray has its own step. At share 0 is the axial ray.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.optics.vectors import safe_divide

Pair = tuple[jax.Array, jax.Array]

NEWTON_STEPS = 8
SMALLEST_STEP = 1e-4
MOST_STEPS = 200
# A ray is aimed when it meets the stop to within this many eps of the stop's radius.
TOLERANCE = 2e4


def aim(
    miss: Callable[[Pair, jax.Array], tuple[jax.Array, jax.Array, jax.Array]],
    guess: Callable[[jax.Array], Pair],
    like: jax.Array,
) -> tuple[Pair, jax.Array]:
    """Solve miss(shift, 1) = 0 for every ray.

    miss(shift, share):  how far, in stop radii, a ray passes the target at this share of field and pupil, in x
                         and y, and whether it reached the stop at all; all of the shape of `like`.
    guess(share):        a shift to start from.
    Returns the shifts and whether each ray is aimed. The derivative is that of the implicit function.
    """
    one = jnp.ones_like(like)
    basis = (jnp.stack([one, 0 * one]), jnp.stack([0 * one, one]))
    tolerance = TOLERANCE * jnp.finfo(like.dtype).eps

    def newton(shift: Pair, share: jax.Array) -> tuple[Pair, jax.Array]:
        def step(_: int, shift: Pair) -> Pair:
            def both(shift: Pair) -> Pair:
                return miss(shift, share)[:2]

            wrong, (columns_x, columns_y) = jax.vmap(lambda d: jax.jvp(both, (shift,), (d,)), out_axes=(None, 0))(basis)
            return _minus(shift, _solve(columns_x, columns_y, wrong))

        shift = lax.fori_loop(0, NEWTON_STEPS, step, shift)
        x, y, arrived = miss(shift, share)
        return shift, arrived & (jnp.abs(x) <= tolerance) & (jnp.abs(y) <= tolerance)

    def solve(_: object, __: Pair) -> Pair:
        def unfinished(state: tuple[jax.Array, jax.Array, Pair, jax.Array]) -> jax.Array:
            share, step, _, count = state
            return jnp.any((share < 1) & (step >= SMALLEST_STEP)) & (count < MOST_STEPS)

        def advance(
            state: tuple[jax.Array, jax.Array, Pair, jax.Array],
        ) -> tuple[jax.Array, jax.Array, Pair, jax.Array]:
            share, step, shift, count = state
            target = jnp.minimum(share + step, 1.0)
            (gx, gy), (hx, hy) = guess(target), guess(share)
            trial, good = newton((shift[0] + gx - hx, shift[1] + gy - hy), target)
            good = good & (share < 1)
            kept = jnp.where(good, trial[0], shift[0]), jnp.where(good, trial[1], shift[1])
            return jnp.where(good, target, share), jnp.where(good, 2 * step, step / 4), kept, count + 1

        state = (0 * one, one, guess(0 * one), jnp.zeros((), jnp.int32))
        return lax.while_loop(unfinished, advance, state)[2]

    shift = lax.custom_root(lambda s: miss(s, one)[:2], (0 * one, 0 * one), solve, _solve_pair)
    x, y, arrived = miss(shift, one)
    return shift, arrived & (jnp.abs(x) <= tolerance) & (jnp.abs(y) <= tolerance)


def _solve_pair(linear: Callable[[Pair], Pair], value: Pair) -> Pair:
    """Solve g(d) = value for a linear g that takes the two unknowns of every ray to two numbers of that ray."""
    one, zero = jnp.ones_like(value[0]), jnp.zeros_like(value[0])
    (a, c), (b, d) = linear((one, zero)), linear((zero, one))
    return _solve((a, b), (c, d), value)


def _solve(first: Sequence[jax.Array], second: Sequence[jax.Array], value: Pair) -> Pair:
    """The pair whose products with the two rows are `value`, by Cramer's rule; 0 where there is none."""
    (a, b), (c, d) = first, second
    determinant = a * d - b * c
    return (
        safe_divide(d * value[0] - b * value[1], determinant),
        safe_divide(a * value[1] - c * value[0], determinant),
    )


def _minus(a: Pair, b: Pair) -> Pair:
    return a[0] - b[0], a[1] - b[1]
