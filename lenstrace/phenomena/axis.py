"""Rays in the meridional plane, from a point of the axis or parallel to it: where they cross it, and their caustic."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.analysis.rays import trace
from lenstrace.optics.rays import Ray, living
from lenstrace.sequential.lens import Lens


class Fan(NamedTuple):
    """Rays, (N,), behind a lens; mm, z from the image surface.

    path:       at every surface, see `trace`.
    slope_rate: how the slope dy/dz behind the lens changes with what tells the rays apart.
    crossing:   z where each crosses the axis; on the axis itself the limit of its neighbours.
    caustic_z, caustic_y:  where each touches its neighbours in the plane.
    """

    path: Ray
    slope_rate: jax.Array
    crossing: jax.Array
    caustic_z: jax.Array
    caustic_y: jax.Array


def fan(lens: Lens, angles: jax.Array) -> Fan:
    """Rays from the axial object point of a lens; angles: (N,), radians, against the axis."""
    distance = lens.object_distance
    assert distance is not None

    def launched(angle: jax.Array) -> Ray:
        zero = jnp.zeros_like(angle)
        return living(zero, zero, zero - distance, zero, jnp.sin(angle), jnp.cos(angle))

    return _traced(lens, launched, angles)


def beam(lens: Lens, heights: jax.Array) -> Fan:
    """Rays parallel to the axis; heights: (N,), mm."""

    def launched(height: jax.Array) -> Ray:
        zero = jnp.zeros_like(height)
        return living(zero, height, zero, zero, zero, zero + 1)

    return _traced(lens, launched, heights)


def _traced(lens: Lens, launched: Callable[[jax.Array], Ray], places: jax.Array) -> Fan:
    def end(places: jax.Array) -> tuple[tuple[jax.Array, jax.Array], Ray]:
        path = trace(lens, rays=launched(places))
        return (path.y[-1] - path.z[-1] * path.m[-1] / path.n[-1], path.m[-1] / path.n[-1]), path

    (y, slope), (y_rate, slope_rate), path = jax.jvp(end, (places,), (jnp.ones_like(places),), has_aux=True)
    touching = -y_rate / slope_rate
    on_axis = slope == 0
    crossing = jnp.where(on_axis, touching, -y / jnp.where(on_axis, 1, slope))
    return Fan(path, slope_rate, crossing, touching, y + slope * touching)
