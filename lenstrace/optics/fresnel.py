"""Fresnel's reflectances: what part of the light a clean, smooth surface between two media sends back.

With a = n1 cos t1 and b = n2 cos t2 the amplitudes are

    r_s = (a - b) / (a + b),      r_p = (n2^2 cos t1 - n1 b) / (n2^2 cos t1 + n1 b),

and with D = n2^2 - n1^2, where b^2 = a^2 + D by the law of refraction,

    r_s = -D / (a + b)^2,         r_p = D ((n1^2 + n2^2) cos^2 t1 - n1^2) / (n2^2 cos t1 + n1 b)^2,

in which no digits cancel between media that are nearly alike. The reflectances are R = r^2; what is not reflected goes
on, T = 1 - R (the amplitudes of T need the factor n2 cos t2 / (n1 cos t1), for the beam changes its width and speed).
They are the same from either side of the surface at the angles of one ray.

Both media have |mu| = 1. A negative index then means mu = -1 and eps = -n^2 (of mu and eps just one negative, no light
goes on): the wave impedance mu / n is that of |n|, and so is every reflectance. A medium of n = -1 in air reflects
nothing.
Source: Born & Wolf, Principles of Optics (7th ed.), section 1.5.2, Eqs. (21) and (33)-(34); Veselago, Sov. Phys. Usp.
10, 509 (1968) for n < 0.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import divide_where, root_or_zero

# Of the smallest number of a precision: what can be raised to the fourth power without becoming 0.
SMALLEST_POWER = 0.25


def reflectances(cosine: jax.Array, index_before: jax.Array, index_after: jax.Array) -> tuple[jax.Array, jax.Array]:
    """R_s and R_p, of light polarized across the plane of incidence and in it; the mean of both is for natural light.

    cosine: of the angle of incidence, 0 to 1.    index_before, index_after: n1, n2, not 0. One shape, or scalars.
    At and beyond the critical angle both are 1, with derivatives 0; before it derivatives grow without bound, as
    1 / cos t2, and are finite. At grazing incidence both are 1, between equal media 0 at every angle.

    >>> s, p = reflectances(jnp.sqrt(jnp.asarray(0.5)), jnp.asarray(1.0), jnp.asarray(1.5))
    >>> round(float(s), 13), round(float(p), 13)
    (0.0920133630455, 0.0084664589789)
    """
    before, after = jnp.abs(index_before), jnp.abs(index_after)
    step = (after - before) * (after + before)
    a = before * cosine
    square = a * a + step
    b = root_or_zero(square)
    s, p = a + b, after * after * cosine + before * b
    total = (square <= 0) & (step < 0)
    # at grazing incidence between equal media both sums are 0, and near it their powers in the derivatives are
    sound = ~total & (s > after * jnp.finfo(square.dtype).tiny ** SMALLEST_POWER)
    tilt = (before * before + after * after) * cosine * cosine - before * before
    r_s, r_p = divide_where(sound, step, s * s), divide_where(sound, step * tilt, p * p)
    return jnp.where(total, 1, r_s * r_s), jnp.where(total, 1, r_p * r_p)
