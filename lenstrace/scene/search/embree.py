"""Triangles asked through Embree, in single precision, on a CPU: the program calls back to Python for all rays at once.

Which triangle a ray meets is Embree's answer; how far away it is, and all derivatives, are found again in the precision
of the scene. The callback is worth its price for ten thousand rays and more, and cannot stand in a loop over small
blocks of them (`compute.blocks`): a program with it runs under a plain `jax.jit`, tile after tile.
Source: I. Wald et al., ACM Transactions on Graphics 33 (4), 143 (2014); "robust" traversal after Woop et al. (2013).
"""

from __future__ import annotations

import collections
import functools
import importlib.util
import itertools
import os
import weakref
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.callback import call_back
from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.shapes.shape import touch
from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.scene.rays import NOWHERE, SceneRay
from lenstrace.scene.stacks import gathered

EPSILON = float(np.finfo(np.float32).eps)
# Rays in the share of a thread.
CHUNK = 1 << 14
# How often a ray is sent on that meets the triangle it begins on, which it should not.
TRIES = 3
# The end of a ray toward a light, in units of epsilon: so much nearer, what touches the light there does not hide it.
SHORT = 16.0


class Handle:
    """Keeps a scene of Embree alive. All are equal, for one compiled program serves every scene of a size."""

    def __init__(self, scene: Any, number: int) -> None:
        self.scene, self.number = scene, number
        _handles[number] = self
        _recent.append(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Handle)

    def __hash__(self) -> int:
        return hash(Handle)


# scenes by the number that their programs are given
_handles: weakref.WeakValueDictionary[int, Handle] = weakref.WeakValueDictionary()
_numbers = itertools.count()
# a program may still run when nobody holds its scene any more
_recent: collections.deque[Handle] = collections.deque(maxlen=4)


@pytree
class Embree:
    """Triangles in a scene of Embree. number: of the scene; handle: what keeps it."""

    number: jax.Array
    handle: Handle = static()

    def nearest(self, primitives: Any, ray: SceneRay, limit: jax.Array) -> tuple[jax.Array, jax.Array]:
        """Distance to the nearest triangle before `limit`, and its number; inf and NOWHERE where there is none."""
        place, single = _ask(self, primitives, ray, limit)
        rough = single.astype(limit.dtype)
        met = place >= 0
        triangle: Triangle = gathered(primitives.shape, place)
        distance = touch(triangle, ray.point, ray.direction, rough)
        # along the plane of the triangle its distance is not to be had so
        distance = jnp.where(jnp.isfinite(distance) & (distance > 0), distance, rough)
        met = met & (distance < limit)
        return jnp.where(met, distance, jnp.inf), jnp.where(met, gathered(primitives.number, place), NOWHERE)

    def any_before(self, primitives: Any, ray: SceneRay, limit: jax.Array, target: jax.Array) -> jax.Array:
        """Whether any triangle but number `target` stands before the distance `limit`."""
        place, _ = _ask(self, primitives, ray, limit * (1 - SHORT * EPSILON))
        return (place >= 0) & (gathered(primitives.number, place) != target)


def available() -> bool:
    """Whether Embree can be asked: it is installed, and the programs run on a CPU."""
    return jax.default_backend() == "cpu" and importlib.util.find_spec("embreex") is not None


def embree(triangles: Triangle) -> Embree:
    """A scene of stacked triangles with numbers (K,)."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    corners = [np.stack([np.asarray(a) for a in corner], -1) for corner in (triangles.a, triangles.b, triangles.c)]
    scene = EmbreeScene(robust=True)
    TriangleMesh(scene, np.stack(corners, 1).astype(np.float32))
    handle = Handle(scene, next(_numbers))
    # the first question builds the tree
    _rays(scene, np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32), np.ones(1, np.float32))
    return Embree(jnp.asarray(handle.number, jnp.int32), handle)


def _ask(search: Embree, primitives: Any, ray: SceneRay, limit: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Place of the nearest triangle among the stacked ones, -1 for none, and the distance to it as Embree has it."""
    start = jnp.where(ray.start >= primitives.number[0], ray.start - primitives.number[0], NOWHERE)
    point, direction = (jnp.stack([a.astype(jnp.float32) for a in vector], -1) for vector in (ray.point, ray.direction))
    place, distance = call_back(
        *(_answer, (np.int32, np.float32), search.number, point, direction),
        *(limit.astype(jnp.float32), start.astype(jnp.int32)),
    )
    return place, distance


def _answer(number: Any, point: Any, direction: Any, limit: Any, start: Any) -> tuple[np.ndarray, np.ndarray]:
    """For the callback: point and direction (..., 3), limit and start (...)."""
    scene = _handles[int(np.asarray(number).flat[0])].scene
    shape = np.shape(start)
    point, direction = (np.asarray(each).reshape(-1, 3) for each in (point, direction))
    limit, start = (np.asarray(each).reshape(-1) for each in (limit, start))
    place, distance = np.empty(start.shape, np.int32), np.empty(start.shape, np.float32)

    def share(begin: int) -> None:
        part = slice(begin, begin + CHUNK)
        place[part], distance[part] = _nearest(scene, point[part], direction[part], limit[part], start[part])

    begins = range(0, len(start), CHUNK)
    if len(begins) > 1:
        list(_threads().map(share, begins))
    elif len(begins):
        share(0)
    return place.reshape(shape), distance.reshape(shape)


def _nearest(
    scene: Any, point: np.ndarray, direction: np.ndarray, limit: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Of rays (N, 3). One that meets where it begins goes on behind that; one of no length is not asked about."""
    asked = np.flatnonzero(limit > 0)
    if len(asked) < len(limit):
        place, distance = np.full(len(limit), -1, np.int32), np.zeros(len(limit), np.float32)
        if len(asked):
            place[asked], distance[asked] = _nearest(scene, point[asked], direction[asked], limit[asked], start[asked])
        return place, distance
    place, distance = _rays(scene, point, direction, limit)
    for _ in range(TRIES):
        again = np.flatnonzero((place >= 0) & (place == start))
        if not len(again):
            return place, distance
        gone = distance[again] + SHORT * EPSILON * (np.abs(point[again]).max(-1) + distance[again])
        onward = point[again] + gone[:, None] * direction[again]
        place[again], further = _rays(scene, onward, direction[again], limit[again] - gone)
        distance[again] = gone + further
    place[place == start] = -1
    return place, distance


def _rays(scene: Any, point: np.ndarray, direction: np.ndarray, limit: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the triangles and distances; Embree writes on the limits that it is given."""
    answer = scene.run(point, direction, limit.copy(), output=True)
    return answer["primID"], answer["tfar"]


@functools.cache
def _threads() -> ThreadPoolExecutor:
    """Their own: a thread that waits for a program must not be one that the program waits for."""
    return ThreadPoolExecutor(os.cpu_count())
