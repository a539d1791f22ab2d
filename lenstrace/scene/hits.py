"""Whatever is hit first: the nearest primitive along a ray, whether anything stands in between, and what is there."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.optics.shapes.shape import along, touch
from lenstrace.optics.vectors import Vector, normalize
from lenstrace.scene.rays import NOWHERE, SceneRay
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


def intersect(world: World, ray: SceneRay) -> Hit:
    """The nearest primitive along each ray. Derivatives are those of the primitive that is met, not of its outline."""
    distance, primitive = nearest(*lax.stop_gradient((world, ray)))
    met = primitive != NOWHERE
    distance = jnp.where(met, distance, 0)

    def there(kind: Primitive) -> tuple[jax.Array, Vector, Vector]:
        point, direction = _local(kind, ray)
        reached = touch(kind.shape, point, direction, distance)
        normal = normalize(kind.shape.normal(along(point, direction, reached)))
        normal = normal if kind.frame is None else kind.frame.outer_direction(normal)
        return reached, along(ray.point, ray.direction, reached), normal

    distance, point, normal = world.primitives.chosen(primitive, there)
    return Hit(met, primitive, distance, point, normal)


def nearest(world: World, ray: SceneRay) -> tuple[jax.Array, jax.Array]:
    """Distance to the nearest primitive and its number; inf and NOWHERE where there is none."""

    def nearer(best: tuple[jax.Array, jax.Array], primitive: Primitive) -> tuple[jax.Array, jax.Array]:
        distance = _distance(primitive, ray)
        less = distance < best[0]
        return jnp.where(less, distance, best[0]), jnp.where(less, primitive.number, best[1])

    nothing = jnp.full_like(ray.point[0], jnp.inf), jnp.full(ray.start.shape, NOWHERE, jnp.int32)
    return _over(world, nearer, nothing)


def blocked(world: World, ray: SceneRay, distance: jax.Array, target: jax.Array) -> jax.Array:
    """Whether anything but the primitive `target` stands between the beginning of a ray and the point at a distance."""

    def stands(found: jax.Array, primitive: Primitive) -> jax.Array:
        return found | ((_distance(primitive, ray) < distance) & (primitive.number != target))

    return _over(world, stands, jnp.zeros(ray.start.shape, bool))


def _over(world: World, step: Callable[[Any, Primitive], Any], begin: Any) -> Any:
    """Through all primitives, kind after kind."""
    found = begin
    for kind in world.primitives.kinds:
        found, _ = lax.scan(lambda found, primitive: (step(found, primitive), None), found, kind)
    return found


def _distance(primitive: Primitive, ray: SceneRay) -> jax.Array:
    """To the nearest point of a primitive, inf where it is not met."""
    point, direction = _local(primitive, ray)
    distance = jnp.full_like(ray.point[0], jnp.inf)
    for root, real in primitive.shape.roots(point, direction, ray.start == primitive.number):
        distance = jnp.where(real & (root > 0) & (root < distance), root, distance)
    return distance


def _local(primitive: Primitive, ray: SceneRay) -> tuple[Vector, Vector]:
    if primitive.frame is None:
        return ray.point, ray.direction
    return primitive.frame.local(ray.point, ray.direction, ray.moment)
