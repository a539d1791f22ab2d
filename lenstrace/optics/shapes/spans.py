"""The parts of a ray between two planes and inside a tube, of which solids are made."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import root_or_zero


def slab(half: jax.Array, x: jax.Array, l: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Where a ray enters and leaves |x| <= half: (-half sgn(l) - x) / l and (half sgn(l) - x) / l.

    x: the ray's coordinate across the slab.      l: that component of its direction, 0 and -0 among them.

    A ray along the slab has a component of the smallest number, outward: it is inside from before to beyond all
    crossings, or never; in a face it is outside. Never nan; the first is never above the second.
    Source: Kay & Kajiya, SIGGRAPH 1986, p. 269.
    """
    tiny = jnp.finfo(l.dtype).tiny
    steep = jnp.where(jnp.abs(l) < tiny, jnp.copysign(tiny, x), l)
    inverse = 1 / steep
    reach = jnp.copysign(half, steep)
    return (-reach - x) * inverse, (reach - x) * inverse


def tube(
    squared_radius: jax.Array, x: jax.Array, y: jax.Array, l: jax.Array, m: jax.Array
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """The middle and half the length of the part of a ray inside x^2 + y^2 <= R^2, and whether there is one.

        middle = -(x l + y m) / A,   half = sqrt(A R^2 - (x m - y l)^2) / A,   A = l^2 + m^2.

    Along the axis the middle is 0 and the half the greatest number.
    """
    limits = jnp.finfo(l.dtype)
    a = l * l + m * m
    across = a > limits.tiny / limits.eps
    inverse = 1 / jnp.where(across, a, 1)
    moment = x * m - y * l
    half = root_or_zero(a * squared_radius - moment * moment) * inverse
    inside = jnp.where(across, half > 0, x * x + y * y < squared_radius)
    return jnp.where(across, -(x * l + y * m) * inverse, 0), jnp.where(across, half, limits.max), inside
