"""The bare blocked kernel: the least that a trace of spheres through JAX can do on this machine.

No status of a ray, no conic, no check, no derivative rule: x, y, l, m on the first vertex plane to x, y, l, m and the
optical path at the image. Blocks of rays stay in the first-level cache ("small call" of XLA's CPU backend), sixteen
chunks are shared out over as many threads as there are processors. What lenstrace adds to it is what its ratio to
this kernel shows.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.experimental.xla_metadata import set_xla_metadata

from lenstrace import Lens, Ray

WIDE = {"xla_cpu_prefer_vector_width": "512"}
BLOCK_BYTES = 512  # 64 rays in float64, 128 in float32
CHUNKS = 16


def traced(lens: Lens, rays: Ray, dtype: Any) -> Callable[[], list[tuple[jax.Array, ...]]]:
    """A call that traces the rays, given on the first vertex plane; compiled, and its chunks cut, beforehand.

    It returns x, y, l, m and optical path of each chunk; the last chunks repeat a few rays, so that all are equal.
    """
    numbers = [np.asarray(a, dtype) for a in (rays.x, rays.y, rays.l, rays.m)]
    block = BLOCK_BYTES // np.dtype(dtype).itemsize
    size = -(-numbers[0].size // (CHUNKS * block)) * block
    chunks = [
        [jnp.asarray(a) for a in part] for part in zip(*(np.resize(a, (CHUNKS, size)) for a in numbers), strict=True)
    ]
    table, last = _records(lens, dtype)
    run = _lowered(table, last, chunks[0]).compile(compiler_options=WIDE)
    threads = ThreadPoolExecutor(os.cpu_count())

    def share(chunk: list[jax.Array]) -> tuple[jax.Array, ...]:
        return jax.block_until_ready(run(table, last, *chunk))

    return lambda: list(threads.map(share, chunks))


def compile_seconds(lens: Lens, count: int) -> float:
    """Seconds to trace, lower and compile it for `count` rays in float64: the measure of the machine as a compiler."""
    table, last = _records(lens, np.float64)
    rays = [jnp.asarray(np.zeros(count - count % (BLOCK_BYTES // 8)))] * 4
    start = time.perf_counter()
    _lowered(table, last, rays).compile(compiler_options=WIDE)
    return time.perf_counter() - start


def _records(lens: Lens, dtype: Any) -> tuple[tuple[jax.Array, ...], jax.Array]:
    """Per surface: curvature, gap before, n1 / n2, 1 - (n1 / n2)^2 (in float64, then rounded), n1, n2 - n1; the gap to
    the image."""
    system = lens.astype("float64").system
    index, gap = np.asarray(system.index[system.primary]), np.asarray(system.thickness)
    before, after = index[:-1], index[1:]
    mu = before / after
    curvature = np.asarray(system.curvature)[:-1]
    table = curvature, np.concatenate([[0.0], gap[:-1]]), mu, 1 - mu**2, before, after - before
    return tuple(jnp.asarray(a, dtype) for a in table), jnp.asarray(gap[-1], dtype)


def _cross(state: Any, record: Any) -> tuple[Any, None]:
    """One surface: to its vertex plane, to the sphere, bend. Optical path is the excess over the axial path."""
    x, y, sag, l, m, w = state
    c, gap, mu, kappa, n1, dn = record
    n = jnp.sqrt(1 - l * l - m * m)
    to_plane = (gap - sag) / n
    x, y = x + to_plane * l, y + to_plane * m
    f, g = c * (x * x + y * y), n - c * (x * l + y * m)
    d = g * g - c * f
    cos1 = jnp.sqrt(jnp.where(d > 0, d, 1.0))
    t = f / (g + cos1)
    x, y, z = x + t * l, y + t * m, t * n
    w = w + n1 * (gap - sag + z) * (l * l + m * m) / (n * (1 + n)) - dn * z
    kick = kappa / (mu * cos1 + jnp.sqrt((mu * cos1) ** 2 + kappa))
    return (x, y, z, mu * l - kick * c * x, mu * m - kick * c * y, w), None


def _trace(table: Any, last: jax.Array, x: jax.Array, y: jax.Array, l: jax.Array, m: jax.Array) -> tuple[Any, ...]:
    (x, y, sag, l, m, w), _ = lax.scan(_cross, (x, y, jnp.zeros_like(x), l, m, l * x + m * y), table)
    n = jnp.sqrt(1 - l * l - m * m)
    t = (last - sag) / n
    return x + t * l, y + t * m, l, m, w + (last - sag) * (l * l + m * m) / (n * (1 + n))


def _blocks(table: Any, last: jax.Array, *rays: jax.Array) -> tuple[jax.Array, ...]:
    size = BLOCK_BYTES // rays[0].dtype.itemsize

    def body(i: jax.Array, out: Any) -> Any:
        block = _trace(table, last, *(lax.dynamic_slice(a, (i * size,), (size,)) for a in rays))
        return tuple(lax.dynamic_update_slice(o, b, (i * size,)) for o, b in zip(out, block, strict=True))

    return lax.fori_loop(0, rays[0].size // size, body, tuple(jnp.zeros_like(rays[0]) for _ in range(5)))


def _lowered(table: Any, last: jax.Array, rays: list[jax.Array]) -> Any:
    """The blocks as one function of XLA's CPU backend instead of dozens of array kernels."""

    def unmarked(*arguments: Any) -> Any:
        with set_xla_metadata(xla_cpu_small_call=None, inlineable=None):
            return _blocks(*arguments)

    def one_function(*arguments: Any) -> Any:
        with set_xla_metadata(xla_cpu_small_call="true", inlineable="false"):
            return jax.jit(unmarked)(*arguments)

    return jax.jit(one_function).lower(table, last, *rays)
