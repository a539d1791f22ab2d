"""Trees of rays: every smooth surface sends one ray on by reflection and one by refraction.

A ray ends where it meets nothing, where its surface sends none on, where the share of the light that would go on is
below a threshold, and at a depth: each of the four can end it alone. Shares are of the light's power.

The tree is walked without recursion. Of two rays that go on the weaker one is followed and the other kept; kept rays
are taken up again last in, first out. The weaker has at most half of the light of both, so that never more are kept
than the threshold has binary digits: `levels_for`.
Source: T. Whitted, Comm. ACM 23, 343 (1980); for rays spread over lights, gloss and moments R. Cook, T. Porter,
L. Carpenter, Computer Graphics 18 (3), 137 (1984).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.compute.pytree import pytree, static
from lenstrace.scene.colours import Colour, largest, plus, times
from lenstrace.scene.draws import FIRST_BOUNCE, LIGHT, PER_BOUNCE, SCATTER, Draws
from lenstrace.scene.methods.local import look
from lenstrace.scene.rays import SceneRay
from lenstrace.scene.scattering import branches
from lenstrace.scene.world import World

# Whitted's, and the least difference of eight-bit pictures.
THRESHOLD = 1 / 255


@pytree
class Tree:
    """depth: of the tree, 1 for no further rays.     threshold: share of the light below which no ray goes on.
    levels: rays kept at most.      spread: whether lights, gloss and moments are sampled, instead of one of each.
    """

    depth: jax.Array
    threshold: jax.Array
    levels: int = static()
    spread: bool = static(default=False)

    def radiance(self, world: World, ray: SceneRay, draws: Draws) -> tuple[Colour, jax.Array]:
        """Along rays, and how many rays were traced for each."""
        one = jnp.ones_like(ray.point[0])
        root = _Node(ray, (one, one, one), jnp.ones(one.shape, jnp.int32))
        kept = jax.tree.map(lambda a: jnp.zeros((self.levels if world.refracts else 0, *a.shape), a.dtype), root)
        here, none = jnp.ones(one.shape, bool), jnp.zeros(one.shape, jnp.int32)
        begin = _Walk(root, here, kept, none, (0 * one, 0 * one, 0 * one), none)

        def step(state: tuple[_Walk, jax.Array]) -> tuple[_Walk, jax.Array]:
            walk, number = state
            return _visit(world, walk, draws, FIRST_BOUNCE + PER_BOUNCE * number, self), number + 1

        walk, _ = lax.while_loop(lambda state: jnp.any(state[0].alive), step, (begin, jnp.asarray(0, jnp.int32)))
        return walk.radiance, walk.rays


class _Node(NamedTuple):
    """A ray that is still to be traced: its light counts by `weight`; depth: 1 for the ray from the eye."""

    ray: SceneRay
    weight: Colour
    depth: jax.Array


class _Walk(NamedTuple):
    """node: now; alive: whether there is one; kept, height: nodes for later, the last at height - 1."""

    node: _Node
    alive: jax.Array
    kept: _Node
    height: jax.Array
    radiance: Colour
    rays: jax.Array


def levels_for(threshold: float, depth: int) -> int:
    """How many rays a tree has to keep."""
    return max(0, min(depth - 1, math.ceil(-math.log2(threshold)) if threshold > 0 else depth - 1))


def _visit(world: World, walk: _Walk, draws: Draws, purpose: jax.Array, settings: Tree) -> _Walk:
    """Trace the ray of a node, add what it sees, and go on to the next."""
    node, alive = walk.node, walk.alive
    dtype = node.ray.point[0].dtype
    seen = look(world, node.ray, alive, draws.four(purpose + LIGHT, dtype) if settings.spread else None, True)
    hit, surface = seen.hit, seen.surface
    radiance = plus(walk.radiance, times(node.weight, seen.radiance))
    walk = walk._replace(radiance=radiance, rays=walk.rays + seen.rays)
    if not world.mirrors:
        return walk._replace(alive=jnp.zeros_like(alive))
    gloss = draws.four(purpose + SCATTER, dtype)[:2] if settings.spread else None
    mirrored, refracted = (
        _Node(node.ray.onward(hit.point, way.direction, hit.primitive), times(node.weight, way.weight), node.depth + 1)
        for way in branches(world, surface, gloss)
    )
    deeper = alive & hit.met & (node.depth < settings.depth)
    goes, parts = (
        deeper & (largest(each.weight) >= settings.threshold) & (largest(each.weight) > 0)
        for each in (mirrored, refracted)
    )
    if not world.refracts:
        return walk._replace(node=_where(goes, mirrored, node), alive=goes)
    weaker = largest(mirrored.weight) < largest(refracted.weight)
    first, second = _where(weaker, mirrored, refracted), _where(weaker, refracted, mirrored)
    first_goes, second_goes = jnp.where(weaker, goes, parts), jnp.where(weaker, parts, goes)
    pushed, popped = first_goes & second_goes, alive & ~first_goes & ~second_goes & (walk.height > 0)
    level = jnp.arange(settings.levels, dtype=jnp.int32)[:, None]
    kept = _where(pushed & (walk.height == level), second, walk.kept)
    on_top = walk.height - 1 == level
    last = jax.tree.map(lambda a: jnp.sum(jnp.where(on_top, a, 0), 0, dtype=a.dtype), walk.kept)
    following = _where(first_goes, first, _where(popped, last, second))
    height = walk.height + pushed.astype(jnp.int32) - popped.astype(jnp.int32)
    return walk._replace(node=following, alive=first_goes | second_goes | popped, kept=kept, height=height)


def _where(condition: jax.Array, a: _Node, b: _Node) -> _Node:
    return jax.tree.map(lambda x, y: jnp.where(condition, x, y), a, b)
