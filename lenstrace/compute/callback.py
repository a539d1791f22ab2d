"""A program that calls back to numpy on a CPU, with nothing of JAX in between.

`jax.pure_callback` hands the arrays of the program to JAX before it calls: that waits for a thread which may itself be
waiting for a callback to end, and a program that calls back from two threads, or on one core, then stands still for
ever (https://github.com/jax-ml/jax/issues/24255). Here the function gets the numpy arrays that XLA has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.core import ShapedArray
from jax.extend.core import Primitive
from jax.interpreters import batching, mlir

Function = Callable[..., tuple[np.ndarray, ...]]

_callback = Primitive("numpy_callback")
_callback.multiple_results = True


def call_back(function: Function, types: tuple[Any, ...], *arrays: jax.Array) -> list[jax.Array]:
    """Results of a function of numpy arrays, all of one shape but for last axes that are its own business.

    function: hashable, and the same again for the same program.     types: of the results, which have the shape of the
    last array. It is not differentiated. Under `vmap` it is called once, with one more axis in front of all arrays.
    """
    return _callback.bind(*arrays, function=function, types=types, shape=arrays[-1].shape)


@_callback.def_impl
def _(*arrays: jax.Array, **settings: Any) -> list[jax.Array]:
    return jax.jit(lambda *arrays: _callback.bind(*arrays, **settings))(*arrays)


@_callback.def_abstract_eval
def _(*_: Any, types: tuple[Any, ...], shape: tuple[int, ...], **__: Any) -> list[Any]:
    return [ShapedArray(shape, np.dtype(each)) for each in types]


def _lowered(context: mlir.LoweringRuleContext, *operands: Any, function: Function, **_: Any) -> Any:
    before: Any = context.avals_in
    after: Any = context.avals_out
    results, _, _ = mlir.emit_python_callback(
        context, function, None, operands, before, after, has_side_effect=False, returns_token=False
    )
    return results


def _batched(arrays: Sequence[Any], axes: Sequence[Any], **settings: Any) -> tuple[list[jax.Array], list[int]]:
    size = next(array.shape[axis] for array, axis in zip(arrays, axes, strict=True) if axis is not None)
    whole = [
        jnp.broadcast_to(array, (size, *array.shape)) if axis is None else jnp.moveaxis(array, axis, 0)
        for array, axis in zip(arrays, axes, strict=True)
    ]
    results = _callback.bind(*whole, **settings | {"shape": (size, *settings["shape"])})
    return results, [0] * len(results)


mlir.register_lowering(_callback, _lowered, platform="cpu")
batching.primitive_batchers[_callback] = _batched
