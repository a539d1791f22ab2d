"""Path tracing: light is carried along random walks from the eye, by an estimate that is right on average.

At every surface one light is looked at, and the walk goes on in one direction that the material chooses. A light that
could have been found either way is counted by both with weights that add up to 1, the squares of the densities over
their sum (the power heuristic). After `ROULETTE_FROM` segments a walk may be ended by chance, with the chance of what
its light has lost, and counts the more where it goes on.
Source: J. Kajiya, Computer Graphics 20 (4), 143 (1986); E. Veach, L. Guibas, SIGGRAPH 95, 419 (1995); J. Arvo, D. Kirk,
Computer Graphics 24 (4), 63 (1990).
"""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import dot
from lenstrace.scene.colours import Colour, largest, plus, scaled, times
from lenstrace.scene.draws import FIRST_BOUNCE, LIGHT, PER_BOUNCE, SCATTER, Draws, Four
from lenstrace.scene.hits import Hit, blocked, intersect
from lenstrace.scene.lighting import background, emitted, light_sample
from lenstrace.scene.rays import SceneRay
from lenstrace.scene.scattering import Surface, scatter, scattered, surface_of
from lenstrace.scene.world import World

ROULETTE_FROM = 4
SURVIVAL = 0.95  # the largest chance to go on, also of a walk that loses nothing


class _Walk(NamedTuple):
    """ray; weight: of the radiance it will find; radiance: found so far; alive: whether it goes on; density: with which
    its direction was chosen; rays: how many were traced; medium: n^2 where the ray is over n^2 at the eye, by which
    its weight is less though no light is lost, None where nothing refracts."""

    ray: SceneRay
    weight: Colour
    radiance: Colour
    alive: jax.Array
    density: jax.Array
    rays: jax.Array
    medium: jax.Array | None


@pytree
class Path:
    """depth: segments of a walk at most, 1 for what shines itself.     roulette: whether walks may end by chance."""

    depth: jax.Array
    roulette: jax.Array

    def radiance(self, world: World, ray: SceneRay, draws: Draws) -> tuple[Colour, jax.Array]:
        """Along rays, and how many rays were traced for each."""
        one = jnp.ones_like(ray.point[0])
        black = 0 * one, 0 * one, 0 * one
        here, none = jnp.ones(one.shape, bool), jnp.zeros(one.shape, jnp.int32)
        begin = _Walk(
            ray, (one, one, one), black, here, jnp.full_like(one, jnp.inf), none, one if world.refracts else None
        )

        def goes_on(state: tuple[_Walk, jax.Array]) -> jax.Array:
            walk, segment = state
            return (segment < self.depth) & jnp.any(walk.alive)

        def step(state: tuple[_Walk, jax.Array]) -> tuple[_Walk, jax.Array]:
            walk, segment = state
            purpose, after = FIRST_BOUNCE + PER_BOUNCE * segment, segment + 1
            for_light, for_way = (draws.four(purpose + each, one.dtype) for each in (LIGHT, SCATTER))
            chance = (after >= ROULETTE_FROM) & self.roulette
            return _segment(world, walk, after < self.depth, chance, for_light, for_way), after

        walk, _ = lax.while_loop(goes_on, step, (begin, jnp.asarray(0, jnp.int32)))
        return walk.radiance, walk.rays


def _segment(world: World, walk: _Walk, further: jax.Array, chance: jax.Array, for_light: Four, for_way: Four) -> _Walk:
    """One ray of a walk; further: whether another may follow; chance: whether roulette is played."""
    hit = intersect(world, walk.ray, walk.alive)
    met = walk.alive & hit.met
    rays = walk.rays + walk.alive.astype(jnp.int32)
    cosine = -dot(walk.ray.direction, hit.normal)
    shining, density = emitted(world, hit.primitive, met, hit.distance, cosine)
    beyond, far_density = background(world, walk.ray.direction)
    escaped = walk.alive & ~hit.met
    seen = jax.tree.map(lambda a, b: jnp.where(met, a, jnp.where(escaped, b, 0)), shining, beyond)
    share = _heuristic(walk.density, jnp.where(hit.met, density, far_density))
    radiance = plus(walk.radiance, times(walk.weight, scaled(seen, share)))

    surface = surface_of(world, walk.ray, hit)
    if world.chosen.shape[0]:
        lit, asked = _direct(world, walk.ray, hit, surface, met & further, for_light)
        radiance, rays = plus(radiance, times(walk.weight, lit)), rays + asked.astype(jnp.int32)
    way = scatter(world, surface, *for_way[:3])
    weight = times(walk.weight, way.weight)
    lost, medium = largest(weight), walk.medium
    if medium is not None:
        through = (dot(way.direction, surface.normal) < 0) & (largest(way.weight) > 0)
        medium = medium / jnp.where(through, largest(way.weight), 1)
        lost = lost * medium
    survival = jnp.where(chance, jnp.minimum(lost, SURVIVAL), 1)
    alive = met & further & (largest(weight) > 0) & (for_way[3] < survival)
    weight = scaled(weight, 1 / jnp.where(survival > 0, survival, 1))
    ray = walk.ray.onward(hit.point, way.direction, hit.primitive)
    return _Walk(ray, weight, radiance, alive, way.density, rays, medium)


def _direct(
    world: World, ray: SceneRay, hit: Hit, surface: Surface, wanted: jax.Array, for_light: Four
) -> tuple[Colour, jax.Array]:
    """Light of one light, and whether a ray was traced for it."""
    light = light_sample(world, hit.point, *for_light[:3], ray.moment)
    value, density = scattered(world, surface, light.direction)
    brought = times(value, light.arriving)
    asked = wanted & (largest(brought) > 0)
    # nothing stands in a way of no length
    far = jnp.where(asked, light.distance, 0)
    shadow = ray.onward(hit.point, light.direction, hit.primitive)
    lit = asked & ~blocked(world, shadow, far, light.target)
    share = jnp.where(lit, _heuristic(light.density, density), 0)
    return scaled(brought, share), asked


def _heuristic(density: jax.Array, other: jax.Array) -> jax.Array:
    """The power heuristic: what counts of a way chosen with one density that could be chosen with another as well."""
    sure = jnp.isinf(density)
    ratio = other / jnp.where(sure | (density == 0), 1, density)
    return jnp.where(sure, 1, 1 / (1 + ratio * ratio))
