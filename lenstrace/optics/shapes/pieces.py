"""Crossings on the pieces of a ray along which it comes steadily nearer to a surface, or goes away from it."""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp

from lenstrace.optics.shapes.bracket import bracketed_root
from lenstrace.optics.shapes.shape import Roots


def crossings(
    level: Callable[[jax.Array], jax.Array], ends: list[jax.Array], start: jax.Array, on: jax.Array, width: jax.Array
) -> Roots:
    """One candidate for each piece between two neighbours of `ends`: its place, and whether there is a crossing.

    level:  F along the ray, of (K, ...) places to as many values; monotone on every piece.
    ends:   K + 1 ascending places along the ray.
    start:  the place where the ray starts. A ray that starts `on` the surface is followed from there, and the piece on
            which it starts, whose only crossing that is, is left out.
    width:  a crossing is known well enough within this.
    """
    ends = [jnp.where(on, jnp.maximum(end, start), end) for end in ends]
    places, real = bracketed_root(level, jnp.stack(ends[:-1]), jnp.stack(ends[1:]), width)
    kept = [real[i] & ~(on & (ends[i] <= start)) for i in range(len(ends) - 1)]
    return tuple((jnp.where(keep, places[i], 0), keep) for i, keep in enumerate(kept))
