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
from jax.custom_derivatives import SymbolicZero
from jax.experimental.xla_metadata import set_xla_metadata

from lenstrace.compute.compiled import compiled, with_precision
from lenstrace.compute.pytree import is_traced

# Bytes that one number of every ray of a block takes; a dozen such arrays are alive at a time in a trace.
BLOCK_BYTES = 512
# Rays in a block of a plain loop, which keeps the memory of a gradient in bounds.
WIDE_BLOCK = 1 << 13
# Rays in the share of a thread: what it reads and writes stays in the second-level cache.
CHUNK = 1 << 16
ALIGNMENT = 64  # bytes: memory that begins at a multiple of it becomes a JAX array without being copied

RayFunction = Callable[[Any, Any], Any]


def each(function: RayFunction, parameters: Any, rays: Any) -> Any:
    """function(parameters, rays), block by block.

    function:    one of a module: it is compiled once for every structure of its arguments (and, below 2 CHUNK, number
                 of rays). It maps numbers, and arrays of rays, to arrays of rays, every ray by itself.
    parameters:  any pytree.
    rays:        a pytree of arrays of one shape, not empty; `function` sees them as (N,), N at most all.
    Returns a pytree of arrays whose last axes are the shape of the rays. The derivatives are those of `function`.
    """
    run = _each(function, is_traced((parameters, rays)))
    if not _is_shared(parameters, rays):
        return run(parameters, rays)
    shape = np.shape(jax.tree.leaves(rays)[0])
    rays = jax.tree.map(lambda a: np.asarray(a).reshape(-1), rays)
    count = _count(rays)
    shapes = jax.eval_shape(run, parameters, _cut(rays, 0, CHUNK))
    results = jax.tree.map(lambda s: _aligned((*s.shape[:-1], count), s.dtype), shapes)

    def share(first: int) -> None:
        # the last share begins earlier, so that it is full, and writes only what is new
        start = min(first, count - CHUNK)
        values = run(parameters, _cut(rays, start, CHUNK))
        jax.tree.map(lambda whole, part: _put(whole, first, np.asarray(part)[..., first - start :]), results, values)

    list(_threads().map(with_precision(share), range(0, count, CHUNK)))
    return jax.tree.map(lambda a: jnp.from_dlpack(a.reshape(*a.shape[:-1], *shape)), results)


def total(function: Callable[..., Any], parameters: Any, cases: Any, rays: Any) -> Any:
    """The sums over all rays of function(parameters, case, rays), for each of several cases; no ray is kept.

    function:    one of a module; returns a pytree of arrays of the shape of the rays it is given, (N,) or ().
    parameters:  any pytree of floating-point numbers.
    cases:       a pytree of arrays with a leading axis (C,).
    rays:        a pytree of arrays (N,), N at least 1.
    Returns sums (C,). Differentiable by the parameters, for each of the sums at the cost of one derivative in reverse;
    neither by the cases nor by the rays (TypeError).
    """
    return _total(function)(parameters, cases, rays)


@functools.cache
def _each(function: RayFunction, traced: bool) -> RayFunction:
    traced_once = jax.jit(function)

    @jax.custom_jvp
    def mapped(parameters: Any, rays: Any) -> Any:
        return _in_one_loop(_map_blocks, traced_once, parameters, rays, traced)

    @mapped.defjvp
    def _(primals: Any, tangents: Any) -> Any:
        return jax.jvp(function, primals, tangents)

    def of_any_shape(parameters: Any, rays: Any) -> Any:
        shape = jax.tree.leaves(rays)[0].shape
        results = mapped(parameters, jax.tree.map(lambda a: a.reshape(-1), rays))
        return jax.tree.map(lambda a: a.reshape(*a.shape[:-1], *shape), results)

    return compiled(of_any_shape)


def moving(primal: Any, tangent: Any) -> tuple[tuple[Any, ...], tuple[Any, ...], Callable[[Any], Any]]:
    """The leaves of a pytree whose symbolic tangents are not zero, these tangents, and what puts other leaves there."""
    leaves, structure = jax.tree.flatten(primal)
    tangents = jax.tree.leaves(tangent)
    which = [i for i, tangent in enumerate(tangents) if not _is_zero(tangent)]

    def rebuilt(moved: Any) -> Any:
        return structure.unflatten([moved[which.index(i)] if i in which else leaf for i, leaf in enumerate(leaves)])

    return tuple(leaves[i] for i in which), tuple(tangents[i] for i in which), rebuilt


@functools.cache
def _total(function: Callable[..., Any]) -> Callable[..., Any]:
    @jax.jit
    def sums(parameters: Any, case: Any, rays: Any, counted: jax.Array) -> Any:
        return jax.tree.map(lambda a: jnp.sum(jnp.where(counted, a, 0), -1), function(parameters, case, rays))

    @functools.partial(jax.jit, static_argnums=0)
    def sums_and_slopes(which: tuple[int, ...], parameters: Any, case: Any, rays: Any, counted: jax.Array) -> Any:
        leaves, structure = jax.tree.flatten(parameters)

        def of_ray(ray: Any) -> Any:
            def values(moved: list[Any]) -> Any:
                all = [moved[which.index(i)] if i in which else leaf for i, leaf in enumerate(leaves)]
                return function(structure.unflatten(all), case, ray)

            value, pull = jax.vjp(values, [leaves[i] for i in which])
            return value, [pull(unit)[0] for unit in _units(value)]

        # one ray at a time, and the sum over the rays last: a sum at every surface would cost more than the trace
        return jax.tree.map(lambda a: jnp.tensordot(counted.astype(a.dtype), a, 1), jax.vmap(of_ray)(rays))

    @functools.cache
    def over_all(which: tuple[int, ...] | None, traced: bool) -> Callable[..., Any]:
        of_block = sums if which is None else functools.partial(sums_and_slopes, which)

        @jax.custom_jvp
        def added(parameters: Any, rays: Any) -> Any:
            return _in_one_loop(_add_blocks, of_block, parameters, rays, traced)

        @added.defjvp
        def _(primals: Any, tangents: Any) -> Any:
            """Of second and higher derivatives: all rays as one block."""
            return jax.jvp(functools.partial(_add_one_block, of_block), primals, tangents)

        return compiled(added)

    @jax.custom_jvp
    def result(parameters: Any, cases: Any, rays: Any) -> Any:
        run = over_all(None, is_traced((parameters, cases, rays)))
        return _added(run, parameters, cases, rays)

    def rule(primals: Any, tangents: Any) -> Any:
        moved, *fixed = tangents
        if not all(map(_is_zero, jax.tree.leaves(fixed))):
            raise TypeError("a total is differentiated by its parameters: give there what the rays and cases depend on")
        tangents = jax.tree.leaves(moved)
        which = tuple(i for i, tangent in enumerate(tangents) if not _is_zero(tangent))
        value, slopes = _added(over_all(which, is_traced(primals)), *primals)
        leaves, structure = jax.tree.flatten(value)
        along = [tangents[i] for i in which]
        return value, structure.unflatten(map(_along, slopes, [along] * len(leaves), leaves))

    result.defjvp(rule, symbolic_zeros=True)
    return result


def _units(value: Any) -> list[Any]:
    """Cotangents that pick one leaf each."""
    leaves, structure = jax.tree.flatten(value)
    return [
        structure.unflatten([jnp.ones_like(leaf) if i == j else jnp.zeros_like(leaf) for j, leaf in enumerate(leaves)])
        for i in range(len(leaves))
    ]


def _in_one_loop(
    loop: Callable[..., Any], function: Callable[..., Any], parameters: Any, rays: Any, traced: bool
) -> Any:
    """A loop over blocks, compiled as a small call; where the caller's program is traced, and on other devices, a plain
    one over wide blocks. (XLA of jaxlib 0.10 aborts where a small call is given a constant, as a caller's program may.)
    """
    if traced or not _on_cpu():
        return loop(function, min(_count(rays), WIDE_BLOCK), parameters, rays)
    size = min(_count(rays), BLOCK_BYTES // max(leaf.dtype.itemsize for leaf in jax.tree.leaves(rays)))

    def unmarked(parameters: Any, rays: Any) -> Any:
        # what is jitted further inside is inlined
        with set_xla_metadata(xla_cpu_small_call=None, inlineable=None):
            return loop(function, size, parameters, rays)

    with set_xla_metadata(xla_cpu_small_call="true", inlineable="false"):
        return jax.jit(unmarked)(parameters, rays)


def _map_blocks(function: RayFunction, size: int, parameters: Any, rays: Any) -> Any:
    """Results of all rays; the last block begins earlier, so that it is full."""
    count = _count(rays)
    if count == size:
        return function(parameters, rays)
    shapes = jax.eval_shape(function, parameters, _cut(rays, 0, size))

    def step(i: jax.Array, results: Any) -> Any:
        start = jnp.minimum(i * size, count - size)
        values = function(parameters, _cut(rays, start, size))
        return jax.tree.map(
            lambda whole, part: lax.dynamic_update_slice_in_dim(whole, part, start, -1), results, values
        )

    nothing = jax.tree.map(lambda s: jnp.zeros((*s.shape[:-1], count), s.dtype), shapes)
    return lax.fori_loop(0, -(-count // size), step, nothing)


def _add_blocks(sums: Callable[..., Any], size: int, parameters: Any, rays: Any) -> Any:
    """Sums over all rays but the first `old` ones; the last block begins earlier and counts what is new in it."""
    parameters, cases, old = parameters
    count = _count(rays)

    def of_case(case: Any) -> Any:
        shapes = jax.eval_shape(sums, parameters, case, _cut(rays, 0, size), jnp.arange(size) >= old)

        def step(i: jax.Array, so_far: Any) -> Any:
            start = jnp.minimum(i * size, count - size)
            counted = start + jnp.arange(size) >= jnp.maximum(i * size, old)
            return jax.tree.map(jnp.add, so_far, sums(parameters, case, _cut(rays, start, size), counted))

        nothing = jax.tree.map(lambda s: jnp.zeros(s.shape, s.dtype), shapes)
        return lax.fori_loop(old // size, -(-count // size), step, nothing)

    return lax.map(of_case, cases)


def _add_one_block(sums: Callable[..., Any], parameters: Any, rays: Any) -> Any:
    """The same sums, without a loop over blocks."""
    parameters, cases, old = parameters
    return lax.map(lambda case: sums(parameters, case, rays, jnp.arange(_count(rays)) >= old), cases)


def _added(run: Callable[..., Any], parameters: Any, cases: Any, rays: Any) -> Any:
    """The sums over all rays, out of those over chunks."""
    if not _is_shared((parameters, cases), rays):
        return run((parameters, cases, 0), rays)
    count, rays = _count(rays), jax.tree.map(np.asarray, rays)

    def share(number: int) -> Any:
        start = min(number * CHUNK, count - CHUNK)
        return run((parameters, cases, number * CHUNK - start), _cut(rays, start, CHUNK))

    shares = list(_threads().map(with_precision(share), range(-(-count // CHUNK))))
    return jax.tree.map(lambda *parts: jnp.asarray(sum(map(np.asarray, parts))), *shares)


def _is_shared(parameters: Any, rays: Any) -> bool:
    """True where threads are opened: for many rays, none of them traced by JAX, on a CPU."""
    return not is_traced((parameters, rays)) and _count(rays) >= 2 * CHUNK and _on_cpu()


def _along(slopes: list[Any], moved: list[Any], value: jax.Array) -> jax.Array:
    """The derivative of one result along the tangents of the parameters, whose axes come last in its slopes."""
    parts = (jnp.tensordot(slope, tangent, jnp.ndim(tangent)) for slope, tangent in zip(slopes, moved, strict=True))
    return sum(parts, jnp.zeros_like(value))


def _is_zero(tangent: Any) -> bool:
    return isinstance(tangent, SymbolicZero) or tangent.dtype == jax.dtypes.float0


def _count(rays: Any) -> int:
    return np.size(jax.tree.leaves(rays)[0])


def _cut(rays: Any, start: Any, size: int) -> Any:
    if isinstance(start, int):
        return jax.tree.map(lambda a: a[start : start + size], rays)
    return jax.tree.map(lambda a: lax.dynamic_slice_in_dim(a, start, size), rays)


def _put(whole: np.ndarray, start: int, part: np.ndarray) -> None:
    whole[..., start : start + part.shape[-1]] = part


def _aligned(shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """An array not yet filled, of memory that JAX takes as it is."""
    size = int(np.prod(shape)) * dtype.itemsize
    raw = np.empty(size + ALIGNMENT, np.uint8)
    start = -raw.ctypes.data % ALIGNMENT
    return raw[start : start + size].view(dtype).reshape(shape)


def _on_cpu() -> bool:
    return jax.default_backend() == "cpu"


@functools.cache
def _threads() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(os.cpu_count())
