"""What is asked of every pixel, out of what a person asks."""

from __future__ import annotations

import operator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import is_traced
from lenstrace.errors import SceneError
from lenstrace.scene.build import world_of
from lenstrace.scene.cameras.through_lens import LensCamera
from lenstrace.scene.draws import Sampler
from lenstrace.scene.lanes import Task
from lenstrace.scene.methods.method import method_of
from lenstrace.scene.number_rules import obeyed, whole
from lenstrace.scene.number_rules import size as size_rule
from lenstrace.scene.objects import Scene
from lenstrace.scene.outside import check_outside
from lenstrace.scene.rules import CAMERAS, checked


def task_of(
    scene: Scene,
    camera: Any,
    size: tuple[int, int],
    *,
    method: str = "path",
    depth: int | None = None,
    threshold: float | None = None,
    key: int | jax.Array = 0,
    sampler: str = "independent",
    dtype: Any = np.float32,
) -> Task:
    """The task of a picture, no samples yet; arguments as of `render`. SceneError for what cannot be rendered."""
    size = obeyed("size", size_rule, size)
    depth = None if depth is None else obeyed("depth", whole, depth)
    if sampler not in [each.value for each in Sampler]:
        raise SceneError(f"sampler: unknown {sampler!r}; one of {', '.join(each.value for each in Sampler)}")
    # of plain numbers, also where JAX traces those of the camera
    with jax.ensure_compile_time_eval():
        world = world_of(scene, dtype)
    eye = jax.tree.map(lambda a: jnp.asarray(a, dtype), checked(camera, CAMERAS))
    if not is_traced(camera.view.position):
        check_outside(camera.view.position, scene)
    if isinstance(camera, LensCamera) and not is_traced((camera.half_film, camera.bound.reach)):
        camera.require_covers(*size)
    how = method_of(method, depth, threshold, dtype)
    width, height, word = (jnp.asarray(number, jnp.uint32) for number in (*size, _word(key)))
    nothing = jnp.asarray(0, jnp.int32)
    return Task(world, eye, how, width, height, word, nothing, nothing, Sampler(sampler))


def _word(key: int | jax.Array) -> int:
    """32 bits of a key."""
    if not isinstance(key, jax.Array):
        return operator.index(key) % 2**32
    words = np.asarray(jax.random.key_data(key), np.uint32).ravel()
    return int(np.bitwise_xor.reduce(words * np.arange(1, 2 * len(words), 2, dtype=np.uint32)))
