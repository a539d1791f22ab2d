"""The one law of interaction: tangential optical momentum is conserved.

With the normal N (any length, N2 = |N|^2), E = |N.d1|, s = sign(N.d1), mu = n1 / n2, kappa = 1 - mu^2:

    p = n1 (d1 - (d1.N) N / N2),      d2 = p / n2 + s sqrt(1 - |p / n2|^2) N / sqrt(N2)

which is d2 = mu d1 + g N with

    N2 g = s (sqrt((mu E)^2 + kappa N2) - mu E).

For mu > 0 the difference is cancelled analytically, g = s kappa / (mu E + sqrt(...)); for mu < 0 (one of the
media has a negative index) nothing cancels: the ray goes on forward and its tangential part flips. For a
mirror s flips and n2 = n1, so that g = -2 s E / N2. Total internal reflection is a negative root.

Source: Spencer & Murty, JOSA 52, 672 (1962), Eqs. (13)-(24), in another algebra; Veselago, Sov. Phys. Usp.
10, 509 (1968) for n < 0.
"""

from __future__ import annotations

import enum

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import Vector, divide_where, root_or_zero


class Interaction(enum.Enum):
    """What a surface does to light."""

    REFRACT = "refract"
    REFRACT_EITHER_SIGN = "refract, where n1 / n2 may be negative"
    REFLECT = "reflect"


def bend(
    interaction: Interaction,
    direction: Vector,
    normal: Vector,
    normal_squared: jax.Array | float,
    cosine: jax.Array,
    side: jax.Array,
    index_before: jax.Array,
    index_after: jax.Array,
) -> tuple[Vector, jax.Array]:
    """Direction behind a surface, and where there is one.

    direction:      unit vector d1.        normal: N, any length.        normal_squared: |N|^2.
    cosine:         E = |N.d1| >= 0.       side: s = sign(N.d1), +1 or -1.
    index_before, index_after:  n1, n2 relative to air; not used by a mirror.
    Returns d2, and a mask: False at total internal reflection, where d2 is finite and means nothing.
    """
    if interaction is Interaction.REFLECT:
        along = -2 * side * cosine / normal_squared
        x, y, z = (d + along * n for d, n in zip(direction, normal, strict=True))
        return (x, y, z), jnp.ones(along.shape, bool)
    mu = index_before / index_after
    # (n2 - n1)(n2 + n1) loses nothing when the indices are nearly equal, 1 - mu^2 would
    kappa = (index_after - index_before) * (index_after + index_before) / (index_after * index_after)
    root = root_or_zero(mu * mu * cosine * cosine + kappa * normal_squared)
    forward = mu * cosine + root
    if interaction is Interaction.REFRACT_EITHER_SIGN:
        near = mu > 0
        numerator = jnp.where(near, kappa, root - mu * cosine)
        along = side * numerator / jnp.where(near, jnp.where(root > 0, forward, 1), normal_squared)
    else:
        along = divide_where(root > 0, side * kappa, forward)
    x, y, z = (mu * d + along * n for d, n in zip(direction, normal, strict=True))
    return (x, y, z), root > 0
