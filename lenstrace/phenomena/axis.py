"""Rays that leave a point of the axis in the meridional plane: where they cross it again, and their caustic."""

from __future__ import annotations

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

    def end(angles: jax.Array) -> tuple[tuple[jax.Array, jax.Array], Ray]:
        path = _path(lens, angles)
        return (path.y[-1], path.m[-1] / path.n[-1]), path

    (y, slope), (y_change, slope_change), path = jax.jvp(end, (angles,), (jnp.ones_like(angles),), has_aux=True)
    touching = -y_change / slope_change
    on_axis = slope == 0
    crossing = jnp.where(on_axis, touching, -y / jnp.where(on_axis, 1, slope))
    return Fan(path, crossing, touching, y + slope * touching)


def _path(lens: Lens, angles: jax.Array) -> Ray:
    assert lens.object_distance is not None
    zero = jnp.zeros_like(angles)
    start = living(zero, zero, zero - lens.object_distance, zero, jnp.sin(angles), jnp.cos(angles))
    return trace(lens, rays=start)
