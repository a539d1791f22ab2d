"""Whatever is hit first: the nearest primitive along a ray, whether anything stands in between, and what is there."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.optics.shapes.shape import along, touch
from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.optics.vectors import Vector, dot, normalize
from lenstrace.scene.rays import NOWHERE, SceneRay
from lenstrace.scene.search import embree, walk
from lenstrace.scene.search.embree import Embree
from lenstrace.scene.search.hierarchy import Hierarchy
from lenstrace.scene.search.kind import Search
from lenstrace.scene.search.starts import off_triangle
from lenstrace.scene.stacks import gathered
from lenstrace.scene.world import Primitive, World


class Hit(NamedTuple):
    """What a ray meets; where it meets nothing the numbers are finite and without meaning.

    met:        whether there is something.        primitive: its number.
    distance, point:  along the ray; where, lengths of the scene.
    normal:     unit vector, outward for a solid, whatever side the ray comes from.
    """

    met: jax.Array
    primitive: jax.Array
    distance: jax.Array
    point: Vector
    normal: Vector


def intersect(world: World, ray: SceneRay, wanted: jax.Array | None = None) -> Hit:
    """The nearest primitive along each ray. Derivatives are those of the primitive that is met, not of its outline.

    wanted: whether a ray is to be traced at all, which saves the time for those that are not; they meet nothing.
    """
    distance, primitive = nearest(*lax.stop_gradient((world, ray)), wanted)
    met = primitive != NOWHERE
    distance = jnp.where(met, distance, 0)

    def there(kind: Primitive) -> tuple[jax.Array, Vector]:
        point, direction = kind.local(ray)
        reached = touch(kind.shape, point, direction, distance)
        normal = kind.shape.normal(along(point, direction, reached))
        return reached, normal if kind.frame is None else kind.frame.outer_direction(normal)

    distance, normal = world.primitives.chosen(primitive, there)
    # where nothing is met, and where the shape has no normal, it is any one
    sound = met & (dot(normal, normal) > 0)
    x, y, z = (jnp.where(sound, each, other) for each, other in zip(normal, (0, 0, 1), strict=True))
    return Hit(met, primitive, distance, along(ray.point, ray.direction, distance), normalize((x, y, z)))


def nearest(world: World, ray: SceneRay, wanted: jax.Array | None = None) -> tuple[jax.Array, jax.Array]:
    """Distance to the nearest primitive and its number; NOWHERE where there is none."""
    far = jnp.full_like(ray.point[0], jnp.inf)
    best = far if wanted is None else jnp.where(wanted, far, 0), jnp.full(ray.start.shape, NOWHERE, jnp.int32)
    for kind, search, begun in _kinds(world, ray):
        found = _nearest_of(kind, search, begun, best[0])
        less = found[0] < best[0]
        best = jnp.where(less, found[0], best[0]), jnp.where(less, found[1], best[1])
    return best


def blocked(world: World, ray: SceneRay, distance: jax.Array, target: jax.Array) -> jax.Array:
    """Whether anything but the primitive `target` stands between the beginning of a ray and the point at a distance."""
    world, ray, distance = lax.stop_gradient((world, ray, distance))
    found = jnp.zeros(ray.start.shape, bool)
    for kind, search, begun in _kinds(world, ray):
        found = found | _any_of(kind, search, begun, distance, target)
    return found


def _kinds(world: World, ray: SceneRay) -> Iterator[tuple[Primitive, Search, SceneRay]]:
    """The primitives of each kind, how they are searched, and where the ray begins for them."""
    primitives = world.primitives
    for i, (kind, search) in enumerate(zip(primitives.kinds, world.searches, strict=True)):
        begun = ray
        if isinstance(kind.shape, Triangle) and kind.frame is None:
            number = jnp.maximum(ray.start, 0)
            on = (ray.start != NOWHERE) & (primitives.kind[number] == i)
            epsilon = embree.EPSILON if isinstance(search, Embree) else float(jnp.finfo(ray.point[0].dtype).eps)
            begun = off_triangle(gathered(kind.shape, primitives.place[number]), ray, on, epsilon)
        yield kind, search, begun


def _nearest_of(kind: Primitive, search: Search, ray: SceneRay, limit: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Of one kind, before a limit."""
    if isinstance(search, Embree):
        return search.nearest(kind, ray, limit)
    if isinstance(search, Hierarchy):
        return walk.nearest(search, kind, ray, limit)

    def nearer(best: tuple[jax.Array, jax.Array], primitive: Primitive) -> tuple[tuple[jax.Array, jax.Array], None]:
        distance = primitive.distance(ray)
        less = distance < best[0]
        return (jnp.where(less, distance, best[0]), jnp.where(less, primitive.number, best[1])), None

    return lax.scan(nearer, (limit, jnp.full(ray.start.shape, NOWHERE, jnp.int32)), kind)[0]


def _any_of(kind: Primitive, search: Search, ray: SceneRay, limit: jax.Array, target: jax.Array) -> jax.Array:
    """Of one kind, before a limit, but for the target."""
    if isinstance(search, Embree):
        return search.any_before(kind, ray, limit, target)
    if isinstance(search, Hierarchy):
        return walk.any_before(search, kind, ray, limit, target)

    def stands(found: jax.Array, primitive: Primitive) -> tuple[jax.Array, None]:
        return found | ((primitive.distance(ray) < limit) & (primitive.number != target)), None

    return lax.scan(stands, jnp.zeros(ray.start.shape, bool), kind)[0]
