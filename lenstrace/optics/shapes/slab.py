"""The space between two parallel planes, of which boxes and cylinders are made."""

from __future__ import annotations

import jax
import jax.numpy as jnp


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
