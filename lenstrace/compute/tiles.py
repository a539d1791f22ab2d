"""A function of many rays, tile after tile, for programs that call back to Python: those cannot run in small blocks."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from lenstrace.compute.blocks import RayFunction, cut, ray_count, threads
from lenstrace.compute.compiled import LONG_OPTIONS, with_precision
from lenstrace.compute.pytree import is_traced

# Rays in a tile: many, for every call back has its price, and few enough that their numbers stay in the cache.
TILE = 1 << 16


def each_tile(function: RayFunction, parameters: Any, rays: Any, tile: int = TILE) -> Any:
    """function(parameters, rays) as `compute.blocks.each` gives it, its rays (N,); the last tile begins earlier."""
    count = ray_count(rays)
    if is_traced((parameters, rays)):
        return function(parameters, rays)
    program = _program(function)
    if count <= tile:
        return program(parameters, rays)
    starts = [min(first, count - tile) for first in range(0, count, tile)]

    def run(start: int) -> Any:
        return jax.tree.map(np.asarray, program(parameters, cut(rays, start, tile)))

    # one thread computes while the other is called back
    parts = list(threads().map(with_precision(run), starts))
    fresh = [first - start for first, start in zip(range(0, count, tile), starts, strict=True)]
    return jax.tree.map(lambda *p: np.concatenate([a[..., f:] for a, f in zip(p, fresh, strict=True)], -1), *parts)


@functools.cache
def _program(function: RayFunction) -> Callable[..., Any]:
    return jax.jit(function, compiler_options=LONG_OPTIONS)
