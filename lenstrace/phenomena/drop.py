"""A round drop in the light of the sun: rays through it, and how their light spreads over the sky.

Rays are reflected inside once or twice. The drop is a sphere of radius 1 whose vertex is the origin; light comes along
+z at the height b, the impact parameter.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.fresnel import reflectances
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.vectors import Vector, dot
from lenstrace.phenomena.surface import reflected, refracted

ORDERS = np.array([1, 2]).reshape(2, 1, 1)  # reflections inside


class DropRays(NamedTuple):
    """Rays of both orders, (2, K, N).

    way:     y and z of where they go, (2, ...).          left: what is left of their light, s and p, (2, ...).
    points:  y and z of the points they meet, (4, 2, ...); those of one reflection leave at the third.
    """

    way: jax.Array
    left: jax.Array
    points: jax.Array


def through_drop(b: jax.Array, n: jax.Array) -> DropRays:
    """Rays that are refracted, reflected once or twice, and refracted; b: impact parameters, n: index, (2, K, N)."""
    zero, one = jnp.zeros_like(b), jnp.ones_like(b)
    way: Vector = (zero, zero, one)
    met = Conic(one, zero).crossing((zero, b, zero), way, one)
    here, normal = met.point, met.normal
    left = 1 - jnp.stack(reflectances(met.cosine, one, n))
    way, _ = refracted(way, normal, one, n)

    def next_hit(state: tuple[Vector, Vector, Vector, Vector, jax.Array], hit: jax.Array) -> tuple[Any, jax.Array]:
        here, normal, way, gone, left = state
        # along the chord to its other end, where the normal toward the centre is known
        length = 2 * dot(normal, way)
        x, y, z = (p + length * d for p, d in zip(here, way, strict=True))
        normal = -x, -y, 1 - z
        back = jnp.stack(reflectances(jnp.abs(dot(normal, way)), n, one))
        behind, _ = refracted(way, normal, n, one)
        leaves = hit == ORDERS + 1
        left = left * jnp.where(leaves, 1 - back, jnp.where(hit <= ORDERS, back, 1))
        gone = tuple(jnp.where(leaves, new, old) for new, old in zip(behind, gone, strict=True))
        return ((x, y, z), normal, reflected(way, normal), gone, left), jnp.stack([y, z])

    # one program for all hits: written out it takes twice as long to compile
    state, points = jax.lax.scan(next_hit, (here, normal, way, way, left), jnp.arange(1, 4))
    *_, gone, left = state
    return DropRays(jnp.stack(gone[1:]), left, jnp.concatenate([jnp.stack(here[1:])[None], points]))


def spread(edges: np.ndarray, angles: np.ndarray, left: np.ndarray, impacts: np.ndarray) -> np.ndarray:
    """Light in the bins of the sky between `edges`, 1 if all that meets the drop went evenly to all sides.

    edges:                  (E + 1,), angles from one point of the sky, radians, ascending.
    angles, left, impacts:  (2, M), of rays of both orders: where they are seen, what is left of them, and their impact
                            parameters; a half of M on either side of the bow, from there.

    What enters between two rays leaves between them: the light that is piled up at a bow is summed, not sampled.
    """
    total = np.zeros(len(edges) - 1)
    for branch in np.split(np.array([angles, left, impacts]), 2, axis=2):
        for angle, part, b in branch.transpose(1, 0, 2):
            light = np.append(0, np.cumsum((part[1:] + part[:-1]) / 2 * np.abs(np.diff(b * b))))
            order = np.argsort(angle)
            total += np.abs(np.diff(np.interp(edges, angle[order], light[order])))
    return 2 * total / (np.cos(edges[:-1]) - np.cos(edges[1:]))
