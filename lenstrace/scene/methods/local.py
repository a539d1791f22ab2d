"""What a ray sees of light that came straight from the lights: what shines itself, and what they light."""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.optics.vectors import dot
from lenstrace.scene.colours import Colour, largest, plus, scaled, times
from lenstrace.scene.hits import Hit, blocked, intersect
from lenstrace.scene.lighting import background, emitted, lighting
from lenstrace.scene.rays import SceneRay
from lenstrace.scene.scattering import Surface, scattered, surface_of
from lenstrace.scene.world import World


class Seen(NamedTuple):
    """radiance: that comes straight from the lights.    hit, surface: what is met.    rays: how many were traced."""

    radiance: Colour
    hit: Hit
    surface: Surface
    rays: jax.Array


def look(world: World, ray: SceneRay, wanted: jax.Array, spread: tuple[jax.Array, jax.Array] | None) -> Seen:
    """What a ray sees. wanted: where it is asked; spread: see `_lit`."""
    hit = intersect(world, ray)
    met = wanted & hit.met
    shining, _ = emitted(world, hit.primitive, met, hit.distance, -dot(ray.direction, hit.normal))
    beyond, _ = background(world, ray.direction)
    seen = jax.tree.map(lambda a, b: jnp.where(met, a, jnp.where(wanted, b, 0)), shining, beyond)
    surface = surface_of(world, ray, hit)
    lit, asked = _lit(world, ray, hit, surface, met, spread)
    return Seen(plus(seen, lit), hit, surface, wanted.astype(jnp.int32) + asked)


def _lit(
    world: World,
    ray: SceneRay,
    hit: Hit,
    surface: Surface,
    wanted: jax.Array,
    spread: tuple[jax.Array, jax.Array] | None,
) -> tuple[Colour, jax.Array]:
    """The sum over all lights, and how many shadow rays that took.

    wanted: where the light is asked for.    spread: two numbers in [0, 1) for a point of each area light; None: its
    middle stands for all of it.
    """
    zero = jnp.zeros_like(hit.distance)
    dark = (zero, zero, zero), jnp.zeros(zero.shape, jnp.int32)
    if world.lights is None:
        return dark

    def one(number: jax.Array, found: tuple[Colour, jax.Array]) -> tuple[Colour, jax.Array]:
        light = lighting(world, number, hit.point, spread)
        value, _ = scattered(world, surface, light.direction)
        brought = times(value, light.arriving)
        asked = wanted & (largest(brought) > 0)
        shadow = ray.onward(hit.point, light.direction, hit.primitive)
        lit = asked & ~blocked(world, shadow, jnp.where(asked, light.distance, 0), light.target)
        return plus(found[0], scaled(brought, lit.astype(zero.dtype))), found[1] + asked.astype(jnp.int32)

    return lax.fori_loop(0, world.lights.kind.shape[0], one, dark)
