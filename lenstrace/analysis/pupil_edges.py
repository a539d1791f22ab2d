"""Where along a line across the pupil rays begin or cease to arrive, by bisection to the last digits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.system import Light
from lenstrace.sequential.trace import trace

BISECTIONS = 50


def arrival(
    front: Front, light: Light, field: tuple[Any, Any], start: tuple[Any, Any], along: tuple[Any, Any]
) -> Callable[[jax.Array], jax.Array]:
    """Whether the rays of a field through the points start + t along of the pupil arrive, as a function of t.

    light: of the wavelength of the rays. All others are of one shape, that of t.
    """
    system = front.system.with_light(light)

    def arrives(t: jax.Array) -> jax.Array:
        pupil = (start[0] + t * along[0], start[1] + t * along[1])
        return trace(system, launch(front, light, field, pupil)).ok

    return arrives


def edges_between(
    arrives: Callable[[jax.Array], jax.Array], here: jax.Array, there: jax.Array, begins: Any, ends: Any
) -> jax.Array:
    """The t between `here` and `there` at which rays still arrive, and no longer a little way on.

    begins, ends: whether they arrive here and there. Where both are alike the result means nothing; where all are, no
    ray is traced. nan stays nan.
    """

    def halve(_: jax.Array, state: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        low, high = state
        middle = (low + high) / 2
        same = arrives(middle) == begins
        return jnp.where(same, middle, low), jnp.where(same, high, middle)

    low, high = lax.fori_loop(0, jnp.where(jnp.any(begins != ends), BISECTIONS, 0), halve, (here, there))
    return jnp.where(begins, low, high)
