"""How the edges of the pupil move when numbers of the lens change: what a fixed bound would leave out of derivatives.

Four rays of each film point go through the edge of the pupil, where its bound is farthest out in s and in t. At the
place q, in half axes of the bound, where such a ray meets a rim, g(q) = max over the surfaces of (r / R)^2 is 1, and

    dq = - dg / (dg / dq),

the derivative of g by the lens at a fixed q over that by q. The bound is moved and stretched as the four are, so that
what is blocked stays, to this order, where it was in it.
"""

from __future__ import annotations

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.rays import living
from lenstrace.optics.vectors import divide_where
from lenstrace.scene.cameras.pupil_bound import PupilBound
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace

STEPS = 6  # of Newton's method
# Where g is this near 1 an edge is found; else it is held fixed.
TOLERANCE = 1e-6
DIRECTIONS = ((1, 0), (-1, 0), (0, 1), (0, -1))


def moving(system: System, chief: jax.Array, marginal: jax.Array, bound: PupilBound) -> PupilBound:
    """The same bound, with derivatives. system: the reversed lens, its object the film."""
    fixed = jax.tree.map(lax.stop_gradient, system)
    held = lax.stop_gradient((chief, marginal))
    bound = jax.tree.map(lax.stop_gradient, bound)
    nodes = bound.centre_s.shape[0]
    height = (bound.step * jnp.asarray(np.arange(nodes), bound.step.dtype))[:, None]
    toward = np.array(DIRECTIONS, bound.step.dtype)

    def fullness(system: System, chief: jax.Array, marginal: jax.Array, q: jax.Array) -> jax.Array:
        """g, (K, 4)."""
        s = bound.centre_s[:, None] + q * bound.half_s[:, None] * toward[:, 0]
        t = bound.centre_t[:, None] + q * bound.half_t[:, None] * toward[:, 1]
        return _fullness(system, height, chief * height + marginal * s, marginal * t)

    def at(q: jax.Array) -> jax.Array:
        return fullness(fixed, *held, q)

    def step(_: int, q: jax.Array) -> jax.Array:
        g, slope = jax.jvp(at, (q,), (jnp.ones_like(q),))
        return q - jnp.clip(divide_where(slope != 0, g - 1, slope), -0.2, 0.2)

    q = lax.fori_loop(0, STEPS, step, jnp.ones((nodes, len(DIRECTIONS)), bound.step.dtype))
    g, slope = jax.jvp(at, (q,), (jnp.ones_like(q),))
    sound = (jnp.abs(g - 1) < TOLERANCE) & (slope > 0) & (q > 0)
    q, slope = lax.stop_gradient((jnp.where(sound, q, 1), jnp.where(sound, slope, 1)))
    change = fullness(system, chief, marginal, q)
    change = jnp.where(sound, -(change - lax.stop_gradient(change)) / slope, 0)
    wide = [1 + (change[:, i] + change[:, i + 1]) / (q[:, i] + q[:, i + 1]) for i in (0, 2)]
    moved = [(change[:, i] - change[:, i + 1]) / 2 for i in (0, 2)]
    return dataclasses.replace(
        bound,
        centre_s=bound.centre_s + bound.half_s * moved[0],
        centre_t=bound.centre_t + bound.half_t * moved[1],
        half_s=bound.half_s * wide[0],
        half_t=bound.half_t * wide[1],
    )


def _fullness(system: System, height: jax.Array, slope_x: jax.Array, slope_y: jax.Array) -> jax.Array:
    """The largest (r / R)^2 that rays from film points (height, 0) have at any surface; 0 where none is limited."""
    n = 1 / jnp.sqrt(1 + slope_x * slope_x + slope_y * slope_y)
    x = jnp.broadcast_to(height, slope_x.shape)
    distance = jnp.asarray(system.object_distance)
    ray = living(x, 0 * x, -distance, slope_x * n, slope_y * n, n)
    path = trace(system.without_apertures(), ray, last=system.surfaces, path=True)
    largest = jnp.zeros_like(slope_x)
    for i, kind in enumerate(system.kinds[: system.surfaces]):
        x, y, first, second = path.x[i + 1], path.y[i + 1], system.aperture[i, 0], system.aperture[i, 1]
        match kind.aperture:
            case ApertureKind.CIRCLE:
                full = (x * x + y * y) / (first * first)
            case ApertureKind.ANNULUS:
                full = (x * x + y * y) / (second * second)
            case ApertureKind.RECTANGLE:
                full = jnp.maximum((x / first) ** 2, (y / second) ** 2)
            case _:
                continue
        largest = jnp.maximum(largest, full)
    return largest
