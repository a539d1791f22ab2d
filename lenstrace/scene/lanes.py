"""Samples of pixels: the program that runs for every pixel by itself, in blocks that stay in the cache."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.compute.pytree import pytree, static
from lenstrace.scene.colours import Colour, scaled
from lenstrace.scene.draws import MOMENT, PIXEL, Draws, Sampler
from lenstrace.scene.methods.path import path
from lenstrace.scene.rays import SceneRay, nowhere
from lenstrace.scene.world import World


@pytree
class Task:
    """What is asked of every pixel.

    width, height:  of the picture, pixels.        key: of the random numbers.
    first, count:   samples first to first + count - 1 are taken.
    depth:          segments of a path.
    """

    world: World
    camera: Any
    width: jax.Array
    height: jax.Array
    key: jax.Array
    first: jax.Array
    count: jax.Array
    depth: jax.Array
    method: str = static(default="path")
    sampler: Sampler = static(default=Sampler.INDEPENDENT)


class Sums(NamedTuple):
    """Of the samples of each pixel: their mean, the sum of squared deviations from it, how many rays were traced."""

    mean: Colour
    spread: Colour
    rays: jax.Array


def samples(task: Task, pixels: jax.Array) -> Sums:
    """The samples of pixels, numbered row after row from the upper left corner; unsigned, (N,)."""
    dtype = task.world.chosen.dtype
    zero = jnp.zeros(pixels.shape, dtype)
    begin = Sums((zero,) * 3, (zero,) * 3, jnp.zeros(pixels.shape, jnp.int32))

    def one_more(done: jax.Array, sums: Sums) -> Sums:
        radiance, rays = _sample(task, pixels, (task.first + done).astype(jnp.uint32), dtype)
        # Welford's update: no digits are lost where the samples are nearly alike
        share = 1 / (done + 1).astype(dtype)
        mean = tuple(m + (r - m) * share for m, r in zip(sums.mean, radiance, strict=True))
        spread = tuple(
            s + (r - before) * (r - after)
            for s, r, before, after in zip(sums.spread, radiance, sums.mean, mean, strict=True)
        )
        return Sums(mean, spread, sums.rays + rays)  # type: ignore[arg-type]

    return lax.fori_loop(0, task.count, one_more, begin)


def _sample(task: Task, pixels: jax.Array, sample: jax.Array, dtype: Any) -> tuple[Colour, jax.Array]:
    """Radiance of one sample of each pixel, and rays traced."""
    draws = Draws(pixels, jnp.broadcast_to(sample, pixels.shape), task.key, task.sampler)
    across, down, u, v = draws.four(PIXEL, dtype)
    column = (pixels % task.width).astype(jnp.int32).astype(dtype) + across
    row = (pixels // task.width).astype(jnp.int32).astype(dtype) + down
    width, height = (each.astype(jnp.int32).astype(dtype) for each in (task.width, task.height))
    half = jnp.minimum(width, height)
    seen = task.camera.rays((2 * column - width) / half, (height - 2 * row) / half, u, v, None)
    ray = SceneRay(seen.point, seen.direction, nowhere(pixels))
    radiance, rays = path(task.world, ray, draws, task.depth, jnp.asarray(False))
    return scaled(radiance, seen.weight), rays
