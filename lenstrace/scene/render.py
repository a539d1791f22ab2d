"""Pictures of a scene: its pixels in batches, their samples in passes, until there are enough, or time is up."""

from __future__ import annotations

import dataclasses
import math
import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.blocks import each
from lenstrace.compute.tiles import each_tile
from lenstrace.errors import AccuracyWarning
from lenstrace.scene.lanes import Sums, Task, samples_of
from lenstrace.scene.number_rules import obeyed, positive, whole
from lenstrace.scene.number_rules import size as size_rule
from lenstrace.scene.objects import Scene
from lenstrace.scene.picture import Picture
from lenstrace.scene.pixels import part_of
from lenstrace.scene.search.kind import has_callback
from lenstrace.scene.tally import Tally
from lenstrace.scene.task import task_of

# Pixels of a thread's share, of small pictures and of others: few sizes, for a program is compiled for each.
SHARES = (1 << 7, 1 << 9, 1 << 11)
# Pixels of a call; samples of each in it, of a picture of fewer pixels the more; and where nothing is said.
BATCH, PASS = 1 << 15, 16
# Pixels of a tile, where the nearest triangle is asked for by calling back.
TILE = 1 << 14
SIZE = (256, 256)
NO_LIGHT = "the scene has no light and is black: give it lights, an environment, or an object with emission"
UNLIT = "{}: the environment is seen, but lights nothing: give the scene lights, or take distributed or path"


@dataclasses.dataclass(frozen=True)
class Progress:
    """done: share of the work, 0 to 1; None where only noise ends it.      samples: of each pixel so far.
    rays_per_second: without compilation.      noise: of the last whole pass, see `Picture`; inf before two samples.
    seconds_left: by what was done so far; None where that is not known."""

    done: float | None
    samples: float
    rays_per_second: float
    noise: float
    seconds_left: float | None


def render(
    scene: Scene,
    camera: Any,
    *,
    size: tuple[int, int] = SIZE,
    crop: tuple[int, int, int, int] | None = None,
    method: str = "path",
    samples: int | None = None,
    depth: int | None = None,
    threshold: float | None = None,
    key: int | jax.Array = 0,
    sampler: str = "independent",
    seconds: float | None = None,
    noise: float | None = None,
    dtype: Any = np.float32,
    progress: Callable[[Progress], None] | None = None,
) -> Picture:
    """The picture of a scene.

    size:       width and height, pixels.
    crop:       left, top, width, height: the part of the picture that is wanted, pixels; they are those of the whole.
    method:     "cast", "whitted", "distributed" or "path".
    samples:    of each pixel; 16, or as many as `seconds` and `noise` allow where one of them is given.
    depth:      longest chain of rays from the eye; None: 128 for trees; paths are ended by chance.
    threshold:  share of the light below which a tree of rays ends; None: 1/255.
    key:        of the random numbers, a whole number or a key of `jax.random`; the same key gives the same picture.
    sampler:    "independent", whose standard error is true, or "sobol", which is less noisy than it says.
    seconds, noise:  stop after this time, at this `Picture.noise`.
    dtype:      precision, float32 or float64.
    progress:   called after every batch of pixels.
    Ctrl-C ends the work with the picture so far. SceneError for what cannot be rendered.
    """
    size = obeyed("size", size_rule, size)
    samples = None if samples is None else obeyed("samples", whole, samples)
    for name, value in (("seconds", seconds), ("noise", noise)):
        if value is not None:
            obeyed(name, positive, value)
    limit = PASS if samples is None and seconds is None and noise is None else samples
    task = task_of(
        *(scene, camera, size), method=method, depth=depth, threshold=threshold, key=key, sampler=sampler, dtype=dtype
    )
    around = task.world.environment is not None
    notes = () if task.world.lights or around else (NO_LIGHT,)
    if around and not task.world.lights and method in ("cast", "whitted"):
        notes = (UNLIT.format(method),)
    for note in notes:
        warnings.warn(note, AccuracyWarning, stacklevel=2)
    part = part_of(size, crop)
    batch = _batch(part.size)
    tally = Tally(part.size, dtype)
    begin = time.perf_counter()
    # no samples, but the program is there
    jax.block_until_ready(_run(task, 0, batch, part, 0, 0))
    start = time.perf_counter()
    interrupted = False
    try:
        for now in _work(task, tally, part, batch, limit, noise):
            spent = time.perf_counter() - start
            if progress is not None:
                progress(_progress(tally, now, limit, seconds, spent))
            if seconds is not None and spent >= seconds:
                break
    except KeyboardInterrupt:
        interrupted = True
    shape = part.shape
    return Picture(
        tally.mean.reshape(*shape, 3),
        tally.standard_error().reshape(*shape, 3),
        *(tally.count.reshape(shape), tally.rays, time.perf_counter() - start, start - begin, interrupted, notes),
    )


def _work(
    task: Task, tally: Tally, part: np.ndarray, batch: int, limit: int | None, noise: float | None
) -> Iterator[float]:
    """Take samples, a pass over all batches after the other; gives the noise of the last pass after each batch."""
    first, now = 0, math.inf
    for number in _passes(limit, PASS * BATCH // batch):
        for pixel in range(0, part.size, batch):
            sums = _run(task, pixel, batch, part, first, number)
            size = min(batch, part.size - pixel)
            mean, spread = (np.stack([np.asarray(c) for c in colour], -1)[:size] for colour in (sums.mean, sums.spread))
            rays = int(np.sum(np.asarray(sums.rays)[:size], dtype=np.int64))
            tally.add(pixel, mean, spread, number, rays)
            yield now
        first, now = first + number, tally.noise()
        if noise is not None and now <= noise:
            return


def _run(task: Task, pixel: int, batch: int, part: np.ndarray, first: int, number: int) -> Sums:
    """Samples of a batch of pixels; those beyond the last repeat it."""
    numbers = part.ravel()[np.minimum(np.arange(pixel, pixel + batch), part.size - 1)]
    counted = {"first": jnp.asarray(first, jnp.int32), "count": jnp.asarray(number, jnp.int32)}
    task = dataclasses.replace(task, **counted)
    if has_callback(task.world.searches):
        return each_tile(samples_of, task, numbers, TILE)
    return each(samples_of, task, numbers, min(SHARES[-1], batch // 2))


def _batch(pixels: int) -> int:
    """Pixels of a call, two shares or more."""
    share = next((share for share in SHARES if pixels <= 2 * share), SHARES[-1])
    return min(BATCH, -(-pixels // (2 * share)) * 2 * share)


def _passes(limit: int | None, most: int) -> Iterator[int]:
    """Samples of each pass, at first as many as there are: soon there is a picture and an error."""
    done = 0
    while limit is None or done < limit:
        number = min(max(done, 1), most, most if limit is None else limit - done)
        yield number
        done += number


def _progress(tally: Tally, noise: float, limit: int | None, seconds: float | None, spent: float) -> Progress:
    samples = float(np.mean(tally.count))
    shares = [samples / limit] if limit is not None else []
    shares += [spent / seconds] if seconds is not None else []
    done = min(1.0, max(shares)) if shares else None
    left = spent * (1 - done) / done if done else None
    return Progress(done, samples, tally.rays / spent, noise, left)
