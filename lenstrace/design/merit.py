"""Residuals of a lens and their derivatives, compiled once for every structure of a problem."""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.compute.compiled import Program
from lenstrace.compute.packing import Packing, packed
from lenstrace.design.problem import Posed
from lenstrace.design.view import View

KEPT = 32  # programs


class Terms(NamedTuple):
    """The terms of all wants, one after the other.

    value:    (T,), each in its unit.     merit: (T,), what it adds to the merit.
    failure:  of each want, see `Measured`.                lost: how many rays are lost that count.
    """

    value: jax.Array
    merit: jax.Array
    failure: tuple[jax.Array | None, ...]
    lost: jax.Array


class Evaluation(NamedTuple):
    """Of P numbers, as a step of Gauss and Newton needs it.

    residual:  (P + 1,), of the same sum of squares as all residuals: the merit.
    jacobian:  (P + 1, P), of the same gradient and the same J^T J as theirs.
    """

    residual: jax.Array
    jacobian: jax.Array
    terms: Terms


class Merit:
    """The merit of a problem as functions of its P numbers, each compiled when it is first asked for."""

    def __init__(self, posed: Posed) -> None:
        self._numbers, self._packing = packed(posed)

    def begin(self, numbers: Any) -> None:
        """Let the program of `evaluated` be compiled, while something else is done."""
        programs(self._packing).evaluated.begin(self._numbers, numbers)

    def evaluated(self, numbers: Any) -> Evaluation:
        """Residuals, Jacobian and terms."""
        return programs(self._packing).evaluated(self._numbers, numbers)

    def gradient(self, numbers: Any) -> tuple[jax.Array, jax.Array]:
        """The merit and its gradient (P,), in reverse: the cost does not grow with P."""
        return programs(self._packing).gradient(self._numbers, numbers)


class Programs(NamedTuple):
    """Functions of the numbers of a `Posed` as one array, and of the P that vary."""

    evaluated: Program
    gradient: Program


@functools.lru_cache(maxsize=KEPT)
def programs(packing: Packing) -> Programs:
    """Of all problems of one structure."""

    def evaluated(fixed: Any, numbers: Any) -> Evaluation:
        def along(direction: jax.Array) -> tuple[jax.Array, jax.Array, Terms]:
            return jax.jvp(functools.partial(residuals, packing, fixed), (numbers,), (direction,), has_aux=True)

        unit = jnp.eye(len(numbers), dtype=numbers.dtype)
        residual, jacobian, terms = jax.vmap(along, out_axes=(None, -1, None))(unit)
        return Evaluation(*compressed(residual, jacobian), terms)

    def gradient(fixed: Any, numbers: Any) -> tuple[jax.Array, jax.Array]:
        return jax.value_and_grad(lambda p: jnp.sum(residuals(packing, fixed, p)[0] ** 2))(numbers)

    return Programs(Program(evaluated), Program(gradient))


def residuals(packing: Packing, fixed: Any, numbers: Any) -> tuple[jax.Array, Terms]:
    """All weighted residuals (M,) and the terms, of the numbers of a `Posed` as one array and the P that vary."""
    posed: Posed = packing.unpacked(fixed)
    view = View(posed.lens_of(jnp.unstack(numbers)))
    found = [(want.weight, want.measured(view)) for want in posed.wants]
    weighted = [jnp.reshape(weight, (-1, 1)) * measured.residual for weight, measured in found]
    terms = Terms(
        jnp.concatenate([measured.value for _, measured in found]),
        jnp.concatenate([jnp.sum(each * each, -1) for each in weighted]),
        tuple(measured.failure for _, measured in found),
        jnp.asarray(sum(measured.lost for _, measured in found), float),
    )
    return jnp.concatenate([each.ravel() for each in weighted]), terms


def compressed(residual: jax.Array, jacobian: jax.Array) -> tuple[jax.Array, jax.Array]:
    """M residuals and their Jacobian as P + 1, by the triangle R of [J r] = Q R: what Q turns does not count."""
    width = jacobian.shape[1] + 1
    both = jnp.concatenate([jacobian, residual[:, None]], 1)
    both = jnp.pad(both, [(0, max(0, width - both.shape[0])), (0, 0)])
    triangle = jnp.linalg.qr(both, mode="r")
    return triangle[:, -1], triangle[:, :-1]
