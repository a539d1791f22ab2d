"""How a question is compiled: with options for this CPU where it is the outermost one, within the caller's program else."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, TypeVar, cast

import jax
from jax._src.core import trace_state_clean  # there is no public way to ask

from lenstrace.pytree import is_traced

# JAX takes them for an outermost `jit` alone; give them to your own, `jax.jit(f, compiler_options=lenstrace.OPTIONS)`.
# The vector width makes the trace 1.5 times faster where AVX-512 is known (elsewhere it changes nothing); without the
# fusion emitters a program compiles in half the time and runs as fast.
OPTIONS: dict[str, str | bool] = {
    "xla_cpu_prefer_vector_width": "512",
    "xla_cpu_use_fusion_emitters": False,
}

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """`jax.jit`, with OPTIONS where it is called from Python and not from a function that JAX traces."""
    inside, outside = jax.jit(function), jax.jit(function, compiler_options=OPTIONS)

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        return (outside if is_outermost(arguments) else inside)(*arguments)

    return cast(Function, call)


def is_outermost(arguments: Any) -> bool:
    """True where nothing is traced by JAX, neither the arguments nor the function that is running."""
    return trace_state_clean() and not is_traced(arguments)
