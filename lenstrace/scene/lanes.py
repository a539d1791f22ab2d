"""Samples of pixels: the program that runs for every pixel by itself, in blocks that stay in the cache."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.compute.pytree import pytree, static
from lenstrace.scene.colours import Colour, scaled, times
from lenstrace.scene.draws import MOMENT, PIXEL, Draws, Sampler
from lenstrace.scene.rays import SceneRay, nowhere
from lenstrace.scene.spectrum import sampled_wavelength
from lenstrace.scene.world import World


@pytree
class Task:
    """What is asked of every pixel.

    width, height:  of the picture, pixels.        key: of the random numbers.
    first, count:   samples first to first + count - 1 are taken.
    """

    world: World
    camera: Any
    method: Any
    width: jax.Array
    height: jax.Array
    key: jax.Array
    first: jax.Array
    count: jax.Array
    sampler: Sampler = static(default=Sampler.INDEPENDENT)


class Sums(NamedTuple):
    """Of the samples of each pixel: their mean, the sum of squared deviations from it, how many rays were traced."""

    mean: Colour
    spread: Colour
    rays: jax.Array


def samples_of(task: Task, pixels: jax.Array) -> Sums:
    """The samples of pixels, numbered row after row from the upper left corner; unsigned, (N,)."""
    zero = jnp.zeros(pixels.shape, task.world.chosen.dtype)
    begin = Sums((zero, zero, zero), (zero, zero, zero), jnp.zeros(pixels.shape, jnp.int32))

    def one_more(done: jax.Array, sums: Sums) -> Sums:
        radiance, rays = _sample(task, pixels, (task.first + done).astype(jnp.uint32))
        # Welford's update: no digits are lost where the samples are nearly alike
        share = 1 / (done + 1).astype(zero.dtype)
        mean = jax.tree.map(lambda m, r: m + (r - m) * share, sums.mean, radiance)
        spread = jax.tree.map(
            lambda s, r, before, after: s + (r - before) * (r - after), sums.spread, radiance, sums.mean, mean
        )
        return Sums(mean, spread, sums.rays + rays)

    return lax.fori_loop(0, task.count, one_more, begin)


def _sample(task: Task, pixels: jax.Array, sample: jax.Array) -> tuple[Colour, jax.Array]:
    """Radiance of one sample of each pixel, and rays traced."""
    dtype = task.world.chosen.dtype
    draws = Draws(pixels, jnp.broadcast_to(sample, pixels.shape), task.key, task.sampler)
    across, down, u, v = draws.four(PIXEL, dtype)
    column, row = _whole(pixels % task.width, dtype) + across, _whole(pixels // task.width, dtype) + down
    width, height = _whole(task.width, dtype), _whole(task.height, dtype)
    half = jnp.minimum(width, height)
    moment = um = None
    one = jnp.ones_like(u)
    colour: Colour = (one, one, one)
    if task.world.moves or task.world.disperses or task.camera.disperses:
        time, wave, *_ = draws.four(MOMENT, dtype)
        moment = time - 0.5 if task.world.moves else None
        if task.world.disperses or task.camera.disperses:
            um, colour = sampled_wavelength(wave)
    seen = task.camera.rays((2 * column - width) / half, (height - 2 * row) / half, u, v, um)
    ray = SceneRay(seen.point, seen.direction, nowhere(pixels), moment, um)
    radiance, rays = task.method.radiance(task.world, ray, draws)
    return times(scaled(radiance, seen.weight), colour), rays


def _whole(number: jax.Array, dtype: Any) -> jax.Array:
    # signed integers convert in one instruction
    return number.astype(jnp.int32).astype(dtype)
