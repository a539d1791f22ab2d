"""Rays of every field and wavelength through points of the pupil, and what a question keeps of them at the image."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.compute.blocks import each
from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.rays import Ray
from lenstrace.sequential.launch import Front, launch, path_before
from lenstrace.sequential.system import Light, System
from lenstrace.sequential.trace import trace

Keep = Callable[[System, Ray], Any]


@pytree
class Asked:
    """What is asked of a lens.

    front:  of the lens.                     light: of each of its wavelengths.
    keep:   a function of a module, from the system at one wavelength and its rays at the image to the arrays that are
            kept of them; nothing else is written to memory.
    path:   whether the rays carry their optical path, from one wavefront of the object's light.
    axial:  see `trace`.
    """

    front: Front
    light: Light
    keep: Keep = static()
    path: bool = static(default=False)
    axial: bool = static(default=False)


def arrivals(asked: Asked, fields: Any, pupil_x: Any, pupil_y: Any) -> Any:
    """What is kept of the rays, every array (W, F, 1 + N): of each field the chief ray, then N others.

    fields:            (F, 2), as `System.fields`.
    pupil_x, pupil_y:  of the N others, (N,), (F, N) or (W, F, N), in units of the pupil's radius.
    """
    return arriving(asked, launch_points(asked, fields, pupil_x, pupil_y))


def arriving(asked: Asked, points: tuple[Any, ...]) -> Any:
    """The same, of rays that `launch_points` has arranged."""
    return each(_arriving, asked, points)


def launch_points(asked: Asked, fields: Any, pupil_x: Any, pupil_y: Any) -> tuple[Any, ...]:
    """Field and pupil of every ray, chief rays among them, as `arriving` takes them; arguments of `arrivals`."""
    points = for_each_field(len(fields), asked.front.system.curvature.dtype, pupil_x, pupil_y)
    xp = jnp if any(isinstance(a, jax.Array) for a in (fields, *points)) else np
    sent = [xp.pad(p, [(0, 0)] * (p.ndim - 1) + [(1, 0)]) for p in points]
    # one set of points for each wavelength, or one for all
    sent = [tuple(p) if p.ndim == 3 else (p,) for p in sent]
    field_x, field_y = (xp.broadcast_to(fields[:, i : i + 1], sent[0][0].shape) for i in (0, 1))
    return field_x, field_y, *sent


def for_each_field(count: int, dtype: Any, pupil_x: Any, pupil_y: Any) -> tuple[Any, Any]:
    """Points of the pupil (N,), (F, N) or (W, F, N) as (F, N) or (W, F, N) for F fields, in a precision."""
    xp = jnp if any(isinstance(a, jax.Array) for a in (pupil_x, pupil_y)) else np
    x, y = (xp.asarray(p).astype(dtype) for p in (pupil_x, pupil_y))
    shape = *x.shape[:-2], count, x.shape[-1]
    return xp.broadcast_to(x, shape), xp.broadcast_to(y, shape)


def _arriving(asked: Asked, points: tuple[Any, ...]) -> Any:
    """Of rays (N,), all wavelengths: (W, N). points: field x and y, and pupil x and y for each wavelength or once."""
    field_x, field_y, pupil_x, pupil_y = points
    field, front, lights = (field_x, field_y), asked.front, jax.tree.map(jnp.asarray, asked.light)

    def at(light: Light, pupil: tuple[jax.Array, jax.Array]) -> Any:
        system = front.system.with_light(light)
        ray = launch(front, light, field, pupil)
        if asked.path:
            ray = dataclasses.replace(ray, opl=path_before(front, light, field, ray))
        return asked.keep(system, trace(system, ray, axial=asked.axial))

    if len(pupil_x) == 1:
        return lax.map(lambda light: at(light, (pupil_x[0], pupil_y[0])), lights)
    return lax.map(lambda wave: at(wave[0], (wave[1], wave[2])), (lights, jnp.stack(pupil_x), jnp.stack(pupil_y)))
