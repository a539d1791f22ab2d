"""A function of many rays, in blocks that stay in the processor's first-level cache, on all its cores.

On a CPU, XLA compiles a function of arrays into dozens of loops, each of which writes whole arrays to memory. Told
that the function is a "small call", it compiles one loop over blocks of rays, in which nothing leaves the cache:
the same numbers, several times sooner. Such a loop runs on one core; a call from Python with many rays is shared
out over threads. Where JAX traces the arguments, and on other devices, there are neither.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.experimental.xla_metadata import set_xla_metadata

from lenstrace.compute.compiled import COMPILER_OPTIONS, LONG_OPTIONS, compiled, with_precision
from lenstrace.compute.pytree import is_traced

# Bytes that one number of every ray of a block takes; a dozen such arrays are alive at a time in a trace.
BLOCK_BYTES = 512
# Rays in a block of a plain loop, which keeps the memory of a gradient in bounds.
WIDE_BLOCK = 1 << 13
# Rays in the share of a thread: what it reads and writes stays in the second-level cache.
CHUNK = 1 << 16
ALIGNMENT = 64  # bytes: memory that begins at a multiple of it becomes a JAX array without being copied

RayFunction = Callable[[Any, Any], Any]


def each(function: RayFunction, parameters: Any, rays: Any, chunk: int | None = None) -> Any:
    """function(parameters, rays), block by block.

    function:    one of a module: it is compiled once for every structure of its arguments (and, below two chunks,
                 number of rays). It maps numbers, and arrays of rays, to arrays of rays, every ray by itself.
    parameters:  any pytree.
    rays:        a pytree of arrays of one shape, not empty; `function` sees them as (N,), N at most all.
    chunk:       rays in the share of a thread, CHUNK else; fewer where the function takes long for each. It is then
                 optimized the more.
    Returns a pytree of arrays whose last axes are the shape of the rays. The derivatives are those of `function`.
    """
    run, fill, chunk = (
        _each(function, is_traced((parameters, rays))),
        _fill(function, chunk is not None),
        chunk or CHUNK,
    )
    if not is_shared(parameters, rays, chunk):
        return run(parameters, rays)
    shape = np.shape(jax.tree.leaves(rays)[0])
    rays = jax.tree.map(lambda a: np.asarray(a).reshape(-1), rays)
    count = ray_count(rays)
    shapes = _result_shapes(function, parameters, cut(rays, 0, chunk))
    results = jax.tree.map(lambda s: _aligned((*s.shape[:-1], count), s.dtype), shapes)
    chunks = iter(range(0, count, chunk))

    def share(_: int) -> None:
        # all results of a thread come to the same memory: it stays warm, and is neither cleared nor given back
        values = jax.tree.map(lambda s: jnp.zeros(s.shape, s.dtype), shapes)
        for first in chunks:
            # the last chunk begins earlier, so that it is full, and writes only what is new
            start = min(first, count - chunk)
            values = jax.block_until_ready(fill(parameters, cut(rays, start, chunk), values))
            for whole, part in zip(jax.tree.leaves(results), jax.tree.leaves(values), strict=True):
                # a view that JAX does not keep, or the memory could not be used again
                whole[..., first : start + chunk] = np.from_dlpack(part)[..., first - start :]

    list(threads().map(with_precision(share), range(os.cpu_count() or 1)))
    return jax.tree.map(lambda a: jnp.from_dlpack(a.reshape(*a.shape[:-1], *shape)), results)


@functools.cache
def _fill(function: RayFunction, takes_long: bool) -> Callable[[Any, Any, Any], Any]:
    """The function for a chunk, into the memory of earlier results, which are then gone."""
    traced_once = jax.jit(function)

    def filled(parameters: Any, rays: Any, results: Any) -> Any:
        return in_one_loop(_fill_blocks, traced_once, parameters, (rays, results), False)

    return jax.jit(filled, compiler_options=LONG_OPTIONS if takes_long else COMPILER_OPTIONS, donate_argnums=2)


def _result_shapes(function: RayFunction, parameters: Any, rays: Any) -> Any:
    """Shapes and types of what the function returns; found once, they take as long as tracing it."""
    leaves, structure = jax.tree.flatten((parameters, rays))
    wide = jax.config.jax_enable_x64  # pyright: ignore[reportAttributeAccessIssue]
    return _shapes_of(function, structure, tuple((np.shape(leaf), jnp.result_type(leaf)) for leaf in leaves), wide)


@functools.lru_cache
def _shapes_of(
    function: RayFunction, structure: Any, leaves: tuple[tuple[tuple[int, ...], Any], ...], _wide: bool
) -> Any:
    """Of one setting of 64-bit numbers."""
    return jax.eval_shape(function, *structure.unflatten([jax.ShapeDtypeStruct(*leaf) for leaf in leaves]))


@functools.cache
def _each(function: RayFunction, traced: bool) -> RayFunction:
    traced_once = jax.jit(function)

    @jax.custom_jvp
    def mapped(parameters: Any, rays: Any) -> Any:
        return in_one_loop(_map_blocks, traced_once, parameters, rays, traced)

    @mapped.defjvp
    def _(primals: Any, tangents: Any) -> Any:
        return jax.jvp(function, primals, tangents)

    def of_any_shape(parameters: Any, rays: Any) -> Any:
        shape = jax.tree.leaves(rays)[0].shape
        results = mapped(parameters, jax.tree.map(lambda a: a.reshape(-1), rays))
        return jax.tree.map(lambda a: a.reshape(*a.shape[:-1], *shape), results)

    return compiled(of_any_shape)


def in_one_loop(
    loop: Callable[..., Any], function: Callable[..., Any], parameters: Any, rays: Any, traced: bool
) -> Any:
    """A loop over blocks, compiled as a small call; where the caller's program is traced, and on other devices, a plain
    one over wide blocks. (XLA of jaxlib 0.10 aborts where a small call is given a constant, as a caller's program may.)
    """
    if traced or not _on_cpu():
        return loop(function, min(ray_count(rays), WIDE_BLOCK), parameters, rays)
    size = min(ray_count(rays), BLOCK_BYTES // max(leaf.dtype.itemsize for leaf in jax.tree.leaves(rays)))

    def unmarked(parameters: Any, rays: Any) -> Any:
        # what is jitted further inside is inlined
        with set_xla_metadata(xla_cpu_small_call=None, inlineable=None):
            return loop(function, size, parameters, rays)

    with set_xla_metadata(xla_cpu_small_call="true", inlineable="false"):
        return jax.jit(unmarked)(parameters, rays)


def _map_blocks(function: RayFunction, size: int, parameters: Any, rays: Any) -> Any:
    """Results of all rays; the last block begins earlier, so that it is full."""
    count = ray_count(rays)
    if count == size:
        return function(parameters, rays)
    shapes = jax.eval_shape(function, parameters, cut(rays, 0, size))
    nothing = jax.tree.map(lambda s: jnp.zeros((*s.shape[:-1], count), s.dtype), shapes)
    return _fill_blocks(function, size, parameters, (rays, nothing))


def _fill_blocks(function: RayFunction, size: int, parameters: Any, rays_and_results: Any) -> Any:
    """As `_map_blocks`, into results that are there."""
    rays, results = rays_and_results
    count = ray_count(rays)

    def step(i: jax.Array, results: Any) -> Any:
        start = jnp.minimum(i * size, count - size)
        values = function(parameters, cut(rays, start, size))
        return jax.tree.map(
            lambda whole, part: lax.dynamic_update_slice_in_dim(whole, part, start, -1), results, values
        )

    return lax.fori_loop(0, -(-count // size), step, results)


def is_shared(parameters: Any, rays: Any, chunk: int | None = None) -> bool:
    """True where threads are opened: for many rays, none of them traced by JAX, on a CPU."""
    return not is_traced((parameters, rays)) and ray_count(rays) >= 2 * (chunk or CHUNK) and _on_cpu()


def ray_count(rays: Any) -> int:
    """N of a pytree of arrays (N,)."""
    return np.size(jax.tree.leaves(rays)[0])


def cut(rays: Any, start: Any, size: int) -> Any:
    """`size` rays from `start` on, a number that JAX may trace."""
    if isinstance(start, int):
        return jax.tree.map(lambda a: a[start : start + size], rays)
    return jax.tree.map(lambda a: lax.dynamic_slice_in_dim(a, start, size), rays)


def _aligned(shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """An array not yet filled, of memory that JAX takes as it is."""
    size = int(np.prod(shape)) * dtype.itemsize
    raw = np.empty(size + ALIGNMENT, np.uint8)
    start = -raw.ctypes.data % ALIGNMENT
    return raw[start : start + size].view(dtype).reshape(shape)


def _on_cpu() -> bool:
    return jax.default_backend() == "cpu"


@functools.cache
def threads() -> ThreadPoolExecutor:
    """One for each processor."""
    return ThreadPoolExecutor(os.cpu_count())
