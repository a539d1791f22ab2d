"""Sums over many rays, block by block, and their derivatives in the same pass: no ray is kept."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.custom_derivatives import SymbolicZero

from lenstrace.compute import blocks
from lenstrace.compute.blocks import cut, in_one_loop, is_shared, ray_count, threads
from lenstrace.compute.compiled import compiled, with_precision
from lenstrace.compute.pytree import is_traced


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


def moving(primal: Any, tangent: Any) -> tuple[tuple[Any, ...], tuple[Any, ...], Callable[[Any], Any]]:
    """The leaves of a pytree whose symbolic tangents are not zero, these tangents, and what puts other leaves there."""
    leaves, structure = jax.tree.flatten(primal)
    tangents = jax.tree.leaves(tangent)
    which = [i for i, tangent in enumerate(tangents) if not is_zero(tangent)]

    def rebuilt(moved: Any) -> Any:
        return structure.unflatten([moved[which.index(i)] if i in which else leaf for i, leaf in enumerate(leaves)])

    return tuple(leaves[i] for i in which), tuple(tangents[i] for i in which), rebuilt


@functools.cache
def _total(function: Callable[..., Any]) -> Callable[..., Any]:
    @jax.jit
    def sums(parameters: Any, case: Any, rays: Any, counted: jax.Array) -> Any:
        return jax.tree.map(lambda a: jnp.where(counted, a, 0), function(parameters, case, rays))

    @functools.partial(jax.jit, static_argnums=0)
    def sums_and_slopes(which: tuple[int, ...], parameters: Any, case: Any, rays: Any, counted: jax.Array) -> Any:
        leaves, structure = jax.tree.flatten(parameters)

        def of_ray(ray: Any) -> Any:
            def values(moved: list[Any]) -> Any:
                all = [moved[which.index(i)] if i in which else leaf for i, leaf in enumerate(leaves)]
                return function(structure.unflatten(all), case, ray)

            value, pull = jax.vjp(values, [leaves[i] for i in which])
            return value, [pull(unit)[0] for unit in units(value)]

        # one ray at a time, and the sum over the rays last: a sum at every surface would cost more than the trace
        return jax.tree.map(lambda a: jnp.where(counted, a, 0), jax.vmap(of_ray, out_axes=-1)(rays))

    @functools.cache
    def over_all(which: tuple[int, ...] | None, traced: bool) -> Callable[..., Any]:
        of_block = sums if which is None else functools.partial(sums_and_slopes, which)

        @jax.custom_jvp
        def added(parameters: Any, rays: Any) -> Any:
            return in_one_loop(_add_blocks, of_block, parameters, rays, traced)

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
        if not all(map(is_zero, jax.tree.leaves(fixed))):
            raise TypeError("a total is differentiated by its parameters: give there what the rays and cases depend on")
        tangents = jax.tree.leaves(moved)
        which = tuple(i for i, tangent in enumerate(tangents) if not is_zero(tangent))
        value, slopes = _added(over_all(which, is_traced(primals)), *primals)
        leaves, structure = jax.tree.flatten(value)
        along = [tangents[i] for i in which]
        return value, structure.unflatten(_along(slopes, along, leaves))

    result.defjvp(rule, symbolic_zeros=True)
    return result


def units(value: Any) -> list[Any]:
    """Cotangents that pick one leaf each."""
    leaves, structure = jax.tree.flatten(value)
    return [
        structure.unflatten([jnp.ones_like(leaf) if i == j else jnp.zeros_like(leaf) for j, leaf in enumerate(leaves)])
        for i in range(len(leaves))
    ]


def _add_blocks(sums: Callable[..., Any], size: int, parameters: Any, rays: Any) -> Any:
    """Sums over all rays but the first `old` ones; the last block begins earlier and counts what is new in it."""
    parameters, cases, old = parameters
    count = ray_count(rays)

    def of_case(case: Any) -> Any:
        shapes = jax.eval_shape(sums, parameters, case, cut(rays, 0, size), jnp.arange(size) >= old)

        def step(i: jax.Array, so_far: Any) -> Any:
            start = jnp.minimum(i * size, count - size)
            counted = start + jnp.arange(size) >= jnp.maximum(i * size, old)
            return jax.tree.map(jnp.add, so_far, sums(parameters, case, cut(rays, start, size), counted))

        nothing = jax.tree.map(lambda s: jnp.zeros(s.shape, s.dtype), shapes)
        lanes = lax.fori_loop(old // size, -(-count // size), step, nothing)
        return jax.tree.map(lambda a: a.sum(-1), lanes)

    return lax.map(of_case, cases)


def _add_one_block(sums: Callable[..., Any], parameters: Any, rays: Any) -> Any:
    """The same sums, without a loop over blocks."""
    parameters, cases, old = parameters

    def of_case(case: Any) -> Any:
        lanes = sums(parameters, case, rays, jnp.arange(ray_count(rays)) >= old)
        return jax.tree.map(lambda a: a.sum(-1), lanes)

    return lax.map(of_case, cases)


def _added(run: Callable[..., Any], parameters: Any, cases: Any, rays: Any) -> Any:
    """The sums over all rays, out of those over chunks."""
    if not is_shared((parameters, cases), rays):
        return run((parameters, cases, 0), rays)
    count, rays = ray_count(rays), jax.tree.map(np.asarray, rays)

    def share(number: int) -> Any:
        start = min(number * blocks.CHUNK, count - blocks.CHUNK)
        return run((parameters, cases, number * blocks.CHUNK - start), cut(rays, start, blocks.CHUNK))

    shares = list(threads().map(with_precision(share), range(-(-count // blocks.CHUNK))))
    return jax.tree.map(lambda *parts: jnp.asarray(sum(map(np.asarray, parts))), *shares)


@compiled
def _along(slopes: list[Any], moved: list[Any], values: list[jax.Array]) -> list[jax.Array]:
    """The derivatives of results along the tangents of the parameters, whose axes come last in the slopes."""

    def of_one(slopes: list[Any], value: jax.Array) -> jax.Array:
        parts = (jnp.tensordot(slope, tangent, jnp.ndim(tangent)) for slope, tangent in zip(slopes, moved, strict=True))
        return sum(parts, jnp.zeros_like(value))

    return list(map(of_one, slopes, values))


def is_zero(tangent: Any) -> bool:
    """True for a symbolic tangent that is zero."""
    return isinstance(tangent, SymbolicZero) or tangent.dtype == jax.dtypes.float0
