"""A function of many rays whose derivatives are found ray by ray in reverse: their cost does not grow with how many
numbers they are by.

What a ray gives are a few numbers, and what it depends on are some dozens, those of the lens. One pass in reverse for
each number that it gives finds its slopes by all of them; the derivatives by the numbers that are searched for, however
many, are then a product of matrices.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.totals import is_zero, units


@functools.cache
def sloped(function: Callable[[Any, Any], tuple[Any, Any]]) -> Callable[[Any, Any], tuple[Any, Any]]:
    """The function, with such derivatives by its parameters.

    function: one of a module. It maps parameters, any pytree of floating-point numbers, and rays, a pytree of arrays
              (N,), to two pytrees of arrays (N,), every ray by itself: floating-point numbers, and what has no
              derivative, such as how rays failed. Not differentiable by the rays (TypeError).
    """

    @functools.partial(jax.custom_jvp)
    def mapped(parameters: Any, rays: Any) -> tuple[Any, Any]:
        return function(parameters, rays)

    def rule(primals: Any, tangents: Any) -> Any:
        parameters, rays = primals
        moved, fixed = tangents
        if not all(map(is_zero, jax.tree.leaves(fixed))):
            raise TypeError("rays are followed by the parameters alone: give there what is to be differentiated by")
        leaves, structure = jax.tree.flatten(parameters)
        along = jax.tree.leaves(moved)
        which = [i for i, tangent in enumerate(along) if not is_zero(tangent)]

        def of_ray(ray: Any) -> Any:
            def values(moved: list[Any]) -> tuple[Any, Any]:
                all = [moved[which.index(i)] if i in which else leaf for i, leaf in enumerate(leaves)]
                return function(structure.unflatten(all), ray)

            value, pull, aside = jax.vjp(values, [leaves[i] for i in which], has_aux=True)
            return value, aside, [pull(unit)[0] for unit in units(value)]

        value, aside, slopes = jax.vmap(of_ray)(rays)
        parts, shape = jax.tree.flatten(value)
        changes = [
            sum(
                (jnp.tensordot(slope, along[i], jnp.ndim(along[i])) for slope, i in zip(by, which, strict=True)),
                jnp.zeros_like(part),
            )
            for by, part in zip(slopes, parts, strict=True)
        ]
        nothing = jax.tree.map(lambda a: np.zeros(a.shape, jax.dtypes.float0), aside)
        return (value, aside), (shape.unflatten(changes), nothing)

    mapped.defjvp(rule, symbolic_zeros=True)
    return mapped
