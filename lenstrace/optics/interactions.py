"""The one law of interaction: tangential optical momentum is conserved.

With the normal N (any length, N2 = |N|^2), E = |N.d1|, s = sign(N.d1), mu = n1 / n2, kappa = 1 - mu^2:

    p = n1 (d1 - (d1.N) N / N2),      d2 = p / n2 + s sqrt(1 - |p / n2|^2) N / sqrt(N2)

which is d2 = mu d1 + g N with

    N2 g = s (R - mu E),      R = sqrt((mu E)^2 + kappa N2).

For mu > 0 the difference is cancelled analytically, g = s kappa / (mu E + R); for mu < 0 (one of the media has a
negative index) nothing cancels: the ray goes on forward and its tangential part flips. A mirror is mu = 1, kappa = 0
with the other root, R = -E: g = -2 s E / N2. Total internal reflection is a negative R^2.

A thin screen that adds the path W(x, y) adds its gradient along the surface to the momentum, p + grad_t W. With
q = grad_t W / n2 that is d2 = mu d1 + q + g N, the same g, and kappa less by 2 mu d1.q + |q|^2; of a mirror, mu = 1,
kappa = 0, R is the negative root.

All g are roots of N2 g^2 + 2 s mu E g = kappa, whence their derivative

    dg = (s dkappa / 2 - g (mu dE + E dmu + s g dN2 / 2)) / R.

Source: Spencer & Murty, JOSA 52, 672 (1962), Eqs. (13)-(24), in another algebra; Veselago, Sov. Phys. Usp.
10, 509 (1968) for n < 0.
"""

from __future__ import annotations

import enum
import functools
from typing import Any

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import Vector, divide_finite_where, divide_where, dot, root_or_zero, safe_divide

# No light goes on where a screen is so steep: its momentum along the surface is far above any index.
STEEPEST = 1e6


class Interaction(enum.Enum):
    """What a surface does to light."""

    REFRACT = "refract"
    REFRACT_EITHER_SIGN = "refract, where n1 / n2 may be negative"
    REFLECT = "reflect"


def bend(
    interaction: Interaction,
    direction: Vector,
    normal: Vector,
    normal_squared: jax.Array,
    cosine: jax.Array,
    side: jax.Array,
    index_before: jax.Array,
    index_after: jax.Array,
    met: jax.Array,
    push: tuple[jax.Array, jax.Array] | None = None,
) -> tuple[Vector, jax.Array]:
    """Direction behind a surface, and where there is one.

    direction:      unit vector d1.        normal: N, any length.        normal_squared: |N|^2.
    cosine:         E = |N.d1| >= 0.       side: s = sign(N.d1), +1 or -1.
    index_before, index_after:  n1, n2 relative to air; without a push not used by a mirror.
    met:            False where the ray meets no surface.
    push:           dW/dx and dW/dy of a screen on the surface, pure numbers; counted up to STEEPEST.
    Returns d2, which is d1 where nothing is met or no light goes on (all of it is reflected totally, or a diffraction
    order does not exist), and a mask: False there.
    """
    mirror = interaction is Interaction.REFLECT
    if mirror:
        mu, kappa, index_after = 1.0, 0.0, index_before
    else:
        mu = index_before / index_after
        # (n2 - n1)(n2 + n1) loses nothing when the indices are nearly equal, 1 - mu^2 would
        kappa = (index_after - index_before) * (index_after + index_before) / (index_after * index_after)
    pushed = None if push is None else _tangential(push, normal, normal_squared, index_after)
    if pushed is not None:
        kappa = kappa - (2 * mu * dot(direction, pushed) + dot(pushed, pushed))
    if mirror and pushed is None:
        root, bends = -cosine, met
    else:
        root = root_or_zero(mu * mu * cosine * cosine + kappa * normal_squared)
        bends = met & (root > 0)
        root = -root if mirror else root
    along, share = _kick(interaction, normal_squared, cosine, mu, kappa, root, side, bends)
    if pushed is not None:
        # here g may be 0 where the ray is turned
        share = jnp.where(bends, mu, 1)
    x, y, z = (share * d + along * n for d, n in zip(direction, normal, strict=True))
    if pushed is not None:
        x, y, z = (a + jnp.where(bends, q, 0) for a, q in zip((x, y, z), pushed, strict=True))
    return (x, y, z), bends


def _tangential(
    push: tuple[jax.Array, jax.Array], normal: Vector, normal_squared: jax.Array, index: jax.Array
) -> Vector:
    """q, the part of the gradient of W along the surface, over the index behind it; finite also where |N|^2 is 0."""
    x, y = (jnp.clip(slope, -STEEPEST, STEEPEST) for slope in push)
    across = safe_divide(x * normal[0] + y * normal[1], normal_squared)
    return (x - across * normal[0]) / index, (y - across * normal[1]) / index, -across * normal[2] / index


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def _kick(
    interaction: Interaction,
    normal_squared: jax.Array,
    cosine: jax.Array,
    mu: Any,
    kappa: Any,
    root: jax.Array,
    side: jax.Array,
    bends: jax.Array,
) -> tuple[jax.Array, Any]:
    """g and mu; 0 and 1 where the ray goes straight on. `root` is R, given by the others: its tangent is not read."""
    if interaction is Interaction.REFLECT:
        return divide_where(bends, side * (root - cosine), normal_squared), mu
    forward = mu * cosine + root
    if interaction is Interaction.REFRACT_EITHER_SIGN:
        near = mu > 0
        numerator = jnp.where(near, kappa, root - mu * cosine)
        along = divide_where(bends, side * numerator, jnp.where(near, forward, normal_squared))
    else:
        along = divide_where(bends, side * kappa, forward)
    # no kick, no change of direction: mu is 1, or the ray goes straight on
    return along, jnp.where(along != 0, mu, 1)


@_kick.defjvp
def _(interaction: Interaction, primals: Any, tangents: Any) -> Any:
    _, cosine, mu, _, root, side, bends = primals
    d_square, d_cosine, d_mu, d_kappa, *_ = tangents
    along, share = _kick(interaction, *primals)
    change = side * d_kappa / 2 - along * (mu * d_cosine + cosine * d_mu + side * along * d_square / 2)
    d_share = d_mu if interaction is Interaction.REFLECT else jnp.where(bends, d_mu, 0)
    return (along, share), (divide_finite_where(bends, change, root), d_share)
