"""How a question is compiled: with options of its own, or into the program that the caller compiles."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar, cast

import jax
from jax._src.core import trace_state_clean  # there is no public way to ask

from lenstrace.compute.pytree import is_traced

# JAX takes them for an outermost `jit` alone; yours may have them too, by its argument `compiler_options`. The vector
# width makes the trace up to 1.6 times faster where AVX-512 is known (elsewhere it changes nothing); without the fusion
# emitters a small program compiles in half the time and runs as fast; at the first level of LLVM's optimization in
# three quarters of it, and as fast again. (A level in XLA_FLAGS goes first.)
COMPILER_OPTIONS: dict[str, str | bool | int] = {
    "xla_cpu_prefer_vector_width": "512",
    "xla_cpu_use_fusion_emitters": False,
}
if "xla_backend_optimization_level" not in os.environ.get("XLA_FLAGS", ""):
    COMPILER_OPTIONS["xla_backend_optimization_level"] = 1
# Of programs that run for seconds, whatever XLA_FLAGS say: a picture is made a tenth faster, and as soon compiled.
LONG_OPTIONS = COMPILER_OPTIONS | {"xla_backend_optimization_level": 3}

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """`jax.jit`, with COMPILER_OPTIONS where it is not a part of a program that JAX traces.

    Called with plain numbers by a function that JAX traces, it computes at once, in a thread where nothing is traced.
    """
    inside, outside = jax.jit(function), jax.jit(function, compiler_options=COMPILER_OPTIONS)

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        if is_traced(arguments):
            return inside(*arguments)
        if trace_state_clean():
            return outside(*arguments)
        with ThreadPoolExecutor(1) as thread:
            return thread.submit(with_precision(outside), *arguments).result()

    return cast(Function, call)


class Program:
    """A function of arrays whose shapes never change, compiled when it is first called, or before: see `begin`."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = jax.jit(function, compiler_options=COMPILER_OPTIONS)
        self._compiled: Future[Any] | None = None

    def begin(self, *arguments: Any) -> None:
        """Trace the function for such arguments, and let the compiler work on it in a thread of its own."""
        if self._compiled is None:
            lowered = self._function.lower(*arguments)
            thread = ThreadPoolExecutor(1)
            self._compiled = thread.submit(lowered.compile)
            thread.shutdown(wait=False)

    def __call__(self, *arguments: Any) -> Any:
        """Its result."""
        self.begin(*arguments)
        assert self._compiled is not None
        return self._compiled.result()(*arguments)


def with_precision(function: Callable[..., Any]) -> Callable[..., Any]:
    """For another thread: the function under the setting of 64-bit numbers here, which JAX keeps for each thread."""
    wide = jax.config.jax_enable_x64  # pyright: ignore[reportAttributeAccessIssue]

    def run(*arguments: Any) -> Any:
        with jax.enable_x64(wide):
            return function(*arguments)

    return run
