"""Rough surfaces as small mirrors of many slopes: GGX, with Smith's shadows.

With the roughness a and the slopes' normal m = (x, y, z),

    D(m) = a^2 / (pi (x^2 + y^2 + a^2 z^2)^2),      G1(o) = 2 o_z / (o_z + sqrt(a^2 + (1 - a^2) o_z^2)).

Seen from o the normals have the density G1(o) (o.m) D(m) / o_z. a is Mitsuba's and Walter's alpha.
Source: B. Walter et al., EGSR 2007, Eqs. (33)-(34); E. Heitz, JCGT 3 (2), 32 (2014); the sampling: J. Dupuy,
A. Benyoub, HPG 2023, Listing 1.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.optics.turns import turned
from lenstrace.optics.vectors import Vector, normalize, root_or_zero


def distribution(roughness: jax.Array, normal: Vector) -> jax.Array:
    """D of a unit vector, per solid angle; 0 below the surface."""
    x, y, z = normal
    square = roughness * roughness
    # x^2 + y^2 + a^2 z^2 loses nothing near the pole, where a^2 z^2 - z^2 + 1 would
    spread = x * x + y * y + square * z * z
    return jnp.where(z > 0, square / (jnp.pi * spread * spread), 0)


def masking(roughness: jax.Array, direction: Vector) -> jax.Array:
    """G1: what part of the surface is seen from a direction of either side, 0 to 1."""
    z = jnp.abs(direction[2])
    square = roughness * roughness
    return 2 * z / (z + jnp.sqrt(square + (1 - square) * z * z))


def visible_normal(roughness: jax.Array, outgoing: Vector, u: jax.Array, v: jax.Array) -> Vector:
    """A normal as seen from `outgoing`, for u, v in [0, 1): a unit vector, z > 0."""
    x, y, z = normalize((roughness * outgoing[0], roughness * outgoing[1], outgoing[2]))
    height = (1 - u) * (1 + z) - z
    radius, (cos, sin) = root_or_zero(1 - height * height), turned(v)
    a, b, c = radius * cos + x, radius * sin + y, height + z
    # c >= 0, and 0 only where u is 1
    tiny = jnp.finfo(c.dtype).tiny
    return normalize((roughness * a, roughness * b, jnp.maximum(c, tiny)))


def reflected(outgoing: Vector, normal: Vector, cosine: jax.Array) -> Vector:
    """The direction whose mirror image in a small mirror is `outgoing`; cosine: of the angle between them."""
    x, y, z = (2 * cosine * n - o for n, o in zip(normal, outgoing, strict=True))
    return x, y, z
