"""Rays of a point of the axis, near or infinitely far, in the meridional plane: where they cross it, their caustic."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.analysis.rays import trace
from lenstrace.optics.rays import Ray, living
from lenstrace.sequential.lens import Lens


class Fan(NamedTuple):
    """Rays of one point of the axis, (N,), behind a lens; mm, z from the image surface.

    path:       at every surface, see `trace`.
    crossing:   z where each crosses the axis; on the axis itself the limit of its neighbours.
    caustic_z, caustic_y:  where each touches its neighbours in the plane.
    """

    path: Ray
    crossing: jax.Array
    caustic_z: jax.Array
    caustic_y: jax.Array


def fan(lens: Lens, angles: jax.Array) -> Fan:
    """Rays from the axial object point of a lens; angles: (N,), radians, against the axis."""
    assert lens.object_distance is not None
    source = -lens.object_distance
    return _followed(lens, angles, lambda t: (0 * t, 0 * t + source, jnp.sin(t), jnp.cos(t)))


def beam(lens: Lens, heights: jax.Array) -> Fan:
    """Rays parallel to the axis; heights: (N,), mm."""
    return _followed(lens, heights, lambda y: (y, 0 * y, 0 * y, 0 * y + 1))


def _followed(lens: Lens, parameters: jax.Array, start: Callable[[jax.Array], tuple[jax.Array, ...]]) -> Fan:
    """start: y, z, m and n of a ray by its parameter."""

    def end(parameters: jax.Array) -> tuple[tuple[jax.Array, jax.Array], Ray]:
        y, z, m, n = start(parameters)
        path = trace(lens, rays=living(0 * y, y, z, 0 * y, m, n))
        return (path.y[-1], path.m[-1] / path.n[-1]), path

    ones = jnp.ones_like(parameters)
    (y, slope), (y_change, slope_change), path = jax.jvp(end, (parameters,), (ones,), has_aux=True)
    touching = -y_change / slope_change
    on_axis = slope == 0
    crossing = jnp.where(on_axis, touching, -y / jnp.where(on_axis, 1, slope))
    return Fan(path, crossing, touching, y + slope * touching)
