"""Down a tree of boxes along a ray, the nearest box first.

In a block of rays on a CPU one ray after the other goes its way, with vectors over the children of a node; elsewhere
all rays go at once, each with a stack of its own.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.compute.blocks import BLOCK_BYTES
from lenstrace.optics.vectors import Vector
from lenstrace.scene.rays import NOWHERE, SceneRay
from lenstrace.scene.search.hierarchy import WIDE, Hierarchy
from lenstrace.scene.stacks import own_first

# Rays that go one after the other: a block of float32 numbers.
BLOCK = BLOCK_BYTES // 4
# Rounding errors of a ray's test against a triangle, in units of epsilon times the longest way to the end of the tree:
# a box is met where a triangle at its rim is. Source: S. Woop, C. Benthin, I. Wald, J. Computer Graphics Techniques 2
# (1), 65 (2013), section 4.
ROUNDINGS = 6


class _Way(NamedTuple):
    """A ray on its way down.

    near:   (depth, WIDE), distances to the children still to be seen of the nodes above; inf where there is none.
    node:   (depth,), those nodes.      level: how far down it is; negative when it is done.
    distance, primitive: the nearest so far.
    """

    near: jax.Array
    node: jax.Array
    level: jax.Array
    distance: jax.Array
    primitive: jax.Array


def nearest(tree: Hierarchy, primitives: Any, ray: SceneRay, limit: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Distance to the nearest primitive before `limit`, and its number; inf and NOWHERE where there is none.

    primitives: stacked, in the order of the tree; see `Primitive`.     Of two at one distance the lower number is met.
    """
    nothing = jnp.full_like(ray.start, NOWHERE - 1)
    distance, primitive = _each(
        lambda ray, limit, target: _walk(tree, primitives, ray, limit, target, False), ray, limit, nothing
    )
    met = primitive != NOWHERE
    return jnp.where(met, distance, jnp.inf), primitive


def any_before(tree: Hierarchy, primitives: Any, ray: SceneRay, limit: jax.Array, target: jax.Array) -> jax.Array:
    """Whether any primitive but number `target` stands before the distance `limit`."""
    _, primitive = _each(
        lambda ray, limit, target: _walk(tree, primitives, ray, limit, target, True), ray, limit, target
    )
    return primitive != NOWHERE


def _each(walk: Any, *rays: Any) -> Any:
    """For each ray, in the way that suits the machine."""
    count = rays[0].start.size
    if count <= BLOCK and jax.default_backend() == "cpu":
        return lax.map(lambda each: walk(*each), rays)
    return jax.vmap(walk)(*rays)


def _walk(
    tree: Hierarchy, primitives: Any, ray: SceneRay, limit: jax.Array, target: jax.Array, first: bool
) -> tuple[jax.Array, jax.Array]:
    """One ray; first: whether any primitive will do."""
    zero = jnp.zeros((), jnp.int32)
    entry = _entry(tree, ray)
    near = jnp.full((tree.depth, WIDE), jnp.inf, limit.dtype)
    begin = _Way(
        _put(near, zero, entry(zero, limit)),
        jnp.zeros(tree.depth, jnp.int32),
        # a ray of no length is done before it begins
        jnp.where(limit > 0, zero, -1),
        limit,
        jnp.asarray(NOWHERE, jnp.int32),
    )

    def step(way: _Way) -> _Way:
        open_boxes = _taken(way.near, way.level)
        slot = jnp.argmin(open_boxes).astype(jnp.int32)
        child = tree.child[way.node[jnp.maximum(way.level, 0)], slot]
        seen = lax.dynamic_update_slice(way.near, jnp.full((1, 1), jnp.inf, limit.dtype), (way.level, slot))
        way = way._replace(near=seen)

        def leaf(way: _Way) -> _Way:
            return _at_leaf(primitives, ray, way, -1 - child, target, first)

        def inner(way: _Way) -> _Way:
            below = way.level + 1
            nodes = lax.dynamic_update_slice(way.node, child[None], (below,))
            return way._replace(near=_put(way.near, below, entry(child, way.distance)), node=nodes, level=below)

        def up(way: _Way) -> _Way:
            return way._replace(level=way.level - 1)

        nothing_left = ~(jnp.min(open_boxes) <= way.distance) | jnp.isinf(jnp.min(open_boxes))
        return lax.switch(jnp.where(nothing_left, 2, jnp.where(child < 0, 0, 1)), [leaf, inner, up], way)

    way = lax.while_loop(lambda way: way.level >= 0, step, begin)
    return way.distance, way.primitive


def _entry(tree: Hierarchy, ray: SceneRay) -> Any:
    """For the children of a node, where the ray enters their boxes; inf for those that it misses, or enters too late.

    A box is widened by what the ray's test against a primitive may round; a ray along a side of it is inside.
    """
    epsilon = jnp.finfo(ray.point[0].dtype).eps
    root = tree.boxes[0]
    ends = jnp.where(jnp.isfinite(root), jnp.abs(root - jnp.stack(ray.point * 2)[:, None]), 0)
    slack = ROUNDINGS * epsilon * jnp.max(ends)
    tiny = jnp.asarray(jnp.finfo(ray.point[0].dtype).tiny ** 0.5, ray.point[0].dtype)
    inverse: Vector = tuple(1 / jnp.where(jnp.abs(d) < tiny, tiny, d) for d in ray.direction)  # type: ignore[assignment]
    forward = [i > 0 for i in inverse]
    starts = [jnp.where(f, p + slack, p - slack) for p, f in zip(ray.point, forward, strict=True)]
    finishes = [jnp.where(f, p - slack, p + slack) for p, f in zip(ray.point, forward, strict=True)]

    def entry(node: jax.Array, limit: jax.Array) -> jax.Array:
        box = _taken(tree.boxes, node)
        near, far = jnp.zeros(WIDE, limit.dtype), jnp.broadcast_to(limit, (WIDE,))
        for i in range(3):
            low, high = box[i], box[3 + i]
            near = jnp.maximum(near, (jnp.where(forward[i], low, high) - starts[i]) * inverse[i])
            far = jnp.minimum(far, (jnp.where(forward[i], high, low) - finishes[i]) * inverse[i])
        return jnp.where(near <= far * (1 + 4 * epsilon), near, jnp.inf)

    return entry


def _at_leaf(primitives: Any, ray: SceneRay, way: _Way, leaf: jax.Array, target: jax.Array, first: bool) -> _Way:
    """After the primitives of a leaf."""
    begin, last = leaf // WIDE, leaf % WIDE
    total = primitives.number.shape[0]
    start = jnp.minimum(begin, total - WIDE)
    some = own_first(jax.tree.map(lambda a: lax.dynamic_slice_in_dim(a, start, WIDE), primitives))
    place = jnp.arange(WIDE, dtype=jnp.int32) + start
    asked = (place >= begin) & (place <= begin + last) & (some.number != target)
    distance = jnp.where(asked, some.distance(ray), jnp.inf)
    least = jnp.min(distance)
    number = jnp.min(jnp.where(distance == least, some.number, jnp.iinfo(jnp.int32).max))
    better = (least < way.distance) | ((least == way.distance) & (number < way.primitive))
    level = jnp.where(better, -1, way.level) if first else way.level
    return way._replace(
        level=level,
        distance=jnp.where(better, least, way.distance),
        primitive=jnp.where(better, number, way.primitive),
    )


def _taken(rows: jax.Array, row: jax.Array) -> jax.Array:
    return lax.dynamic_index_in_dim(rows, row, keepdims=False)


def _put(rows: jax.Array, row: jax.Array, value: jax.Array) -> jax.Array:
    return lax.dynamic_update_index_in_dim(rows, value, row, 0)
