"""What the material of a primitive makes of light, in the axes of the scene."""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import Vector, dot
from lenstrace.scene.colours import Colour
from lenstrace.scene.hits import Hit
from lenstrace.scene.materials.frame import to_global, to_local
from lenstrace.scene.materials.material import Place
from lenstrace.scene.rays import SceneRay
from lenstrace.scene.world import World


class Surface(NamedTuple):
    """Where light is scattered, seen from where the ray comes.

    material: number.     place: what a material may ask for.     normal: unit vector on the side of the viewer.
    outgoing: the way back along the ray, in the axes of the surface, z along that normal.
    """

    material: jax.Array
    place: Place
    normal: Vector
    outgoing: Vector


class Scattered(NamedTuple):
    """A way that light may have come. direction: unit vector; weight: what the radiance from there is multiplied by;
    density: per solid angle, inf where the material leaves no other way."""

    direction: Vector
    weight: Colour
    density: jax.Array


def surface_of(world: World, ray: SceneRay, hit: Hit) -> Surface:
    """The surface that a ray meets."""
    cosine = dot(ray.direction, hit.normal)
    outside = cosine <= 0
    x, y, z = (jnp.where(outside, a, -a) for a in hit.normal)
    back = (-ray.direction[0], -ray.direction[1], -ray.direction[2])
    l, m, _ = to_local((x, y, z), back)
    material = world.material[jnp.maximum(hit.primitive, 0)]
    return Surface(material, Place(hit.point, outside, ray.um), (x, y, z), (l, m, jnp.abs(cosine)))


def scatter(world: World, surface: Surface, u: jax.Array, v: jax.Array, w: jax.Array) -> Scattered:
    """A direction chosen by the material with three numbers in [0, 1)."""
    incoming, weight, density = world.materials.chosen(
        surface.material, lambda material: material.sample(surface.place, surface.outgoing, u, v, w)
    )
    return Scattered(to_global(surface.normal, incoming), weight, density)


def scattered(world: World, surface: Surface, direction: Vector) -> tuple[Colour, jax.Array]:
    """Scattering of light that comes from a direction times |cosine|, and the density with which `scatter` chooses it;
    both 0 for materials that leave no choice."""
    incoming = to_local(surface.normal, direction)
    return world.materials.chosen(
        surface.material, lambda material: material.evaluate(surface.place, surface.outgoing, incoming)
    )


def branches(world: World, surface: Surface, gloss: tuple[jax.Array, jax.Array] | None) -> tuple[Scattered, Scattered]:
    """The ray that a surface reflects and the one it lets through, each with its share of the light; 0 for none.

    gloss: two numbers in [0, 1) for a direction of a rough material; None: it is taken for a smooth one.
    """
    ways = world.materials.chosen(
        surface.material, lambda material: material.branches(surface.place, surface.outgoing, gloss)
    )
    sure = jnp.full_like(surface.outgoing[2], jnp.inf)
    mirrored, refracted = (Scattered(to_global(surface.normal, way), weight, sure) for way, weight in ways)
    return mirrored, refracted
