"""The light of pixels as one function of numbers, which JAX may trace and differentiate."""

from __future__ import annotations

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.compiled import compiled
from lenstrace.errors import SceneError
from lenstrace.scene.lanes import samples_of
from lenstrace.scene.number_rules import obeyed, whole
from lenstrace.scene.objects import Scene
from lenstrace.scene.task import task_of


def radiance(
    scene: Scene, camera: Any, size: tuple[int, int], *, crop: Any = None, samples: int = 16, **more: Any
) -> jax.Array:
    """What `render` makes of the same samples, (rows, columns, 3): for derivatives by the numbers of the camera.

    Of a lens camera those are all numbers of its lens. Derivatives are forward ones, by `jax.jvp` or `jax.jacfwd`: a
    walk of unknown length cannot be gone back. They are those of each sample: where the outline of something crosses
    a pixel, what it covers is not in them; what is out of focus, or goes over smoothly, is.

    crop, and more (method, depth, threshold, key, sampler, dtype): see `render`. SceneError as there.

    >>> from lenstrace.scene import Diffuse, Object, Pinhole, Plane, PointLight, View
    >>> floor = Scene([Object(Plane(), Diffuse(1.0), rotation=(-90, 0, 0))], [PointLight((0, 2, 0), 4.0)])
    >>> def seen(angle):
    ...     return radiance(floor, Pinhole(View((0, 3, 3), (0, 0, 0)), angle), (4, 4), dtype=float)[0, 0, 0]
    >>> value, slope = jax.jvp(seen, (40.0,), (1.0,))
    >>> bool(abs(slope - (seen(40.001) - seen(39.999)) / 0.002) < 1e-7)
    True
    """
    task = task_of(scene, camera, size, **more)
    part = part_of(size, crop)
    count = jnp.asarray(obeyed("samples", whole, samples), jnp.int32)
    sums = _sums(dataclasses.replace(task, count=count), jnp.asarray(part.ravel()))
    return jnp.stack(sums.mean, -1).reshape(*part.shape, 3)


_sums = compiled(samples_of)


def part_of(size: tuple[int, int], crop: tuple[int, int, int, int] | None) -> np.ndarray:
    """Numbers of the pixels that are wanted, (rows, columns), row after row from the upper left corner of the whole."""
    left, top, width, height = crop or (0, 0, *size)
    if min(left, top) < 0 or min(width, height) < 1 or left + width > size[0] or top + height > size[1]:
        raise SceneError(f"crop: left, top, width, height must lie in the {size[0]}x{size[1]} pixels, got {crop}")
    rows, columns = np.arange(top, top + height, dtype=np.uint32), np.arange(left, left + width, dtype=np.uint32)
    return rows[:, None] * np.uint32(size[0]) + columns
