"""The two paraxial rays that bound the light of a lens: the marginal ray, and the chief ray of a field."""

from __future__ import annotations

import math

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import root_or_zero
from lenstrace.sequential import paraxial
from lenstrace.sequential.system import System


def rays_of_pupil(system: System, field: jax.Array) -> jax.Array:
    """Marginal and chief ray at the first vertex: [[y, ybar], [w, wbar]], mm and w = N u; the system at one wavelength.

    field: its tangent, or its height in mm; of image heights the height over `Front.scale`.
    With y at the stop = a y + b w the chief ray is a multiple of (-b, a), and the marginal one has the stop's radius.
    """
    a, b, *_ = paraxial.matrix(system, 1, system.stop, bend_last=False)
    radius, index = paraxial.stop_radius(system), paraxial.signed_index(system)[0]
    if system.object_distance is None:
        tangent = -field if system.field_kind == "image_height" else field
        marginal, share = (radius / a, jnp.zeros_like(a)), index * tangent / a
    else:
        gap = system.object_distance / index
        reach = a * gap + b
        marginal = radius * gap / reach, radius / reach
        share = index * field / a if system.field_kind == "angle" else -field / reach
    return jnp.stack([jnp.stack([marginal[0], -b * share]), jnp.stack([marginal[1], a * share])])


def heights_and_slopes(system: System, start: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Heights at the surfaces (2, S), mm, slopes w before them (2, S), and slopes behind the last one (2,), of two rays
    given as `rays_of_pupil` does."""
    index = paraxial.signed_index(system)

    def step(ray: jax.Array, surface: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        power, gap = surface
        y, w = ray[0], ray[1] - power * ray[0]
        return jnp.stack([y + gap * w, w]), ray

    last, rays = jax.lax.scan(step, start, (paraxial.surface_powers(system), system.thickness / index[1:]))
    return rays[:, 0].T, rays[:, 1].T, last[1]


def largest_field(system: System, fields: jax.Array) -> jax.Array:
    """Of fields (F, 2), the one farthest from the axis: the tangent of its angle (nan from 90 degrees on), or its
    height in mm."""
    if system.field_kind == "angle":
        below = jnp.abs(fields) < math.pi / 2
        fields = jnp.where(below, jnp.tan(jnp.where(below, fields, 0)), jnp.nan)
    return root_or_zero(jnp.max(jnp.sum(fields * fields, -1)))
