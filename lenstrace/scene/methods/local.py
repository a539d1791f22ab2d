"""What a ray sees of light that came straight from the lights: what shines itself, and what they light."""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.optics.vectors import dot
from lenstrace.scene.colours import Colour, largest, plus, scaled, times
from lenstrace.scene.draws import Four
from lenstrace.scene.hits import Hit, blocked, intersect
from lenstrace.scene.lighting import background, emitted, lighting
from lenstrace.scene.lights.light import Lighting
from lenstrace.scene.rays import SceneRay
from lenstrace.scene.scattering import Surface, scattered, surface_of
from lenstrace.scene.world import World


class Seen(NamedTuple):
    """radiance: that comes straight from the lights.    hit, surface: what is met.    rays: how many were traced."""

    radiance: Colour
    hit: Hit
    surface: Surface
    rays: jax.Array


def look(world: World, ray: SceneRay, wanted: jax.Array, spread: Four | None, further: bool) -> Seen:
    """What a ray sees. wanted: where it is asked; spread, further: see `_lit`."""
    hit = intersect(world, ray)
    met = wanted & hit.met
    shining, _ = emitted(world, hit.primitive, met, hit.distance, -dot(ray.direction, hit.normal))
    beyond, _ = background(world, ray.direction)
    seen = jax.tree.map(lambda a, b: jnp.where(met, a, jnp.where(wanted, b, 0)), shining, beyond)
    surface = surface_of(world, ray, hit)
    lit, asked = _lit(world, ray, hit, surface, met, spread, further)
    return Seen(plus(seen, lit), hit, surface, wanted.astype(jnp.int32) + asked)


def _lit(
    world: World, ray: SceneRay, hit: Hit, surface: Surface, wanted: jax.Array, spread: Four | None, further: bool
) -> tuple[Colour, jax.Array]:
    """The sum over all lights, and how many shadow rays that took.

    wanted:   where the light is asked for.
    spread:   numbers in [0, 1) for a point of each area light and a direction of the environment; None: the middle of
              a light stands for all of it, and the environment lights nothing.
    further:  whether the rays are traced that materials send on: those find what has a size themselves.
    """
    zero = jnp.zeros_like(hit.distance)
    found = (zero, zero, zero), jnp.zeros(zero.shape, jnp.int32)
    finds = jnp.zeros(zero.shape, bool)
    if further and world.mirrors:
        finds = world.materials.chosen(surface.material, lambda kind: jnp.full_like(finds, kind.sends[0]))

    def also(light: Lighting, found: tuple[Colour, jax.Array]) -> tuple[Colour, jax.Array]:
        value, _ = scattered(world, surface, light.direction)
        brought = times(value, light.arriving)
        asked = wanted & (largest(brought) > 0) & ~(finds & jnp.isfinite(light.density))
        shadow = ray.onward(hit.point, light.direction, hit.primitive)
        lit = asked & ~blocked(world, shadow, jnp.where(asked, light.distance, 0), light.target)
        return plus(found[0], scaled(brought, lit.astype(zero.dtype))), found[1] + asked.astype(jnp.int32)

    if world.lights is not None:
        found = lax.fori_loop(
            *(0, world.lights.kind.shape[0]),
            lambda number, found: also(lighting(world, number, hit.point, spread, ray.moment), found),
            found,
        )
    if world.environment is not None and spread is not None:
        found = also(world.environment.toward(hit.point, *spread[:3]), found)
    return found
