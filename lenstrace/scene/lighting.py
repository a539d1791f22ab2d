"""Which light, and what it brings to a point."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import Vector
from lenstrace.scene.colours import Colour, scaled
from lenstrace.scene.draws import Four
from lenstrace.scene.lights.area import AreaLight
from lenstrace.scene.lights.light import Lighting
from lenstrace.scene.world import World

# Among so many lights the chosen one is found by asking them all, among more by halving.
FEW = 64


def light_sample(
    world: World, point: Vector, u: jax.Array, v: jax.Array, w: jax.Array, moment: jax.Array | None
) -> Lighting:
    """One direction of one light, both chosen: densities and radiances count the choice. u, v, w: in [0, 1)."""
    count = world.chosen.shape[0]
    if count == 1:
        return _of_light(world, jnp.zeros(u.shape, jnp.int32), point, u, v, w, moment)
    if count > FEW:
        number = jnp.searchsorted(world.chosen, w, side="right").astype(jnp.int32)
    else:
        number = jnp.sum((w[..., None] >= world.chosen), -1).astype(jnp.int32)
    number = jnp.clip(number, 0, count - 1)
    chance, before = _chance(world, number)
    found = _of_light(world, number, point, u, v, (w - before) / chance, moment)
    return found._replace(arriving=scaled(found.arriving, 1 / chance), density=found.density * chance)


def lighting(world: World, number: jax.Array, point: Vector, spread: Four | None, moment: jax.Array | None) -> Lighting:
    """Of one light. spread: numbers in [0, 1) for a point of an area light; None: its middle, for all of it."""
    middle = jnp.full_like(point[0], 0.5)
    u, v = (middle, middle) if spread is None else spread[:2]
    assert world.lights is not None
    return world.lights.chosen(jnp.broadcast_to(number, middle.shape), lambda light: light.toward(point, u, v, moment))


def emitted(
    world: World, primitive: jax.Array, met: jax.Array, distance: jax.Array, cosine: jax.Array
) -> tuple[Colour, jax.Array]:
    """Radiance that a primitive itself sends to a ray that meets it, and with what density `light_sample` chooses it.

    cosine: between the way back and the outward normal of the primitive; behind it nothing shines.
    """
    nothing = jnp.zeros_like(distance)
    if world.light is None or world.lights is None:
        return (nothing, nothing, nothing), nothing
    number = world.light[jnp.maximum(primitive, 0)]
    shines = met & (number >= 0) & (cosine > 0)

    def of(light: Any) -> tuple[Colour, jax.Array]:
        if not isinstance(light, AreaLight):
            return (nothing, nothing, nothing), nothing
        return light.radiance, light.density(distance * distance, cosine)

    colour, density = world.lights.chosen(number, of)
    if world.chosen.shape[0] > 1:
        density = density * _chance(world, jnp.maximum(number, 0))[0]
    r, g, b = (jnp.where(shines, each, 0) for each in colour)
    return (r, g, b), jnp.where(shines, density, 0)


def background(world: World, direction: Vector) -> tuple[Colour, jax.Array]:
    """Radiance from beyond everything, and with what density `light_sample` chooses it."""
    nothing = jnp.zeros_like(direction[0])
    if world.environment is None:
        return (nothing, nothing, nothing), nothing
    colour, density = world.environment.seen(direction)
    last = jnp.full(nothing.shape, world.chosen.shape[0] - 1, jnp.int32)
    return colour, density * _chance(world, last)[0]


def _chance(world: World, number: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Of choosing a light, and of choosing one before it."""
    before = jnp.where(number > 0, world.chosen[jnp.maximum(number - 1, 0)], 0)
    return world.chosen[number] - before, before


def _of_light(
    world: World, number: jax.Array, point: Vector, u: jax.Array, v: jax.Array, w: jax.Array, moment: jax.Array | None
) -> Lighting:
    far = None if world.environment is None else world.environment.toward(point, u, v, w)
    if world.lights is None:
        assert far is not None
        return far
    near = world.lights.chosen(number, lambda light: light.toward(point, u, v, moment))
    if far is None:
        return near
    last = number == world.chosen.shape[0] - 1
    return jax.tree.map(lambda a, b: jnp.where(last, b, a), near, far)
