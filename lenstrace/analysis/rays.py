"""Rays asked of a lens: by field, pupil point and wavelength, or brought along."""

from __future__ import annotations

import dataclasses
import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike

from lenstrace.analysis.conditions import require_pupil
from lenstrace.errors import RayError
from lenstrace.optics.rays import Ray
from lenstrace.pytree import is_traced
from lenstrace.sequential.document import Wavelengths
from lenstrace.sequential.launch import launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rules import check_field
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace as trace_system

# A direction whose length differs from 1 by more than this is refused.
UNIT_TOLERANCE = 1e-9
# A given ray with a smaller direction cosine n runs against the light. Between this and 0 lie the rays that a lens
# sees that looks at more than a half space.
BACKWARD = -0.5


def trace(
    lens: Lens,
    rays: Ray | None = None,
    *,
    field: ArrayLike | tuple[ArrayLike, ArrayLike] = 0.0,
    pupil: tuple[ArrayLike, ArrayLike] = (0.0, 0.0),
    wavelength: float | None = None,
    path: bool = True,
) -> Ray:
    """Rays through a lens, exactly.

    rays:        given in the frame of the first vertex (see `ray`); then field and pupil are not used. A given ray
                 with n < -1/2 runs against the light.
    field:       y, or (x, y), in the unit of the lens's fields (degrees, or the file's length).
    pupil:       x and y, in units of the radius of the paraxial entrance pupil; of the stop with ray aiming.
                 Field and pupil broadcast to the shape of the result.
    wavelength:  micrometres, any that the glasses know; the primary one by default.
    path:        all surfaces along a leading axis (0 launch, 1 ... S, S + 1 image), or the image alone.

    Each surface's x, y, z (mm) and l, m, n are in its own frame, the direction is that behind it, opl (mm)
    counts from the launch point. Failed rays have a `status` and a `surface`, and finite numbers.
    RayError for a direction that is not a unit vector; WavelengthError outside a glass's range.
    """
    lens, place = _with_wavelength(lens, wavelength)
    if rays is not None:
        return _through(lens.system, _checked(rays), place, path)
    require_pupil(lens)
    x, y = map(_floats, field if isinstance(field, tuple) else (0.0, field))
    check_field(lens, x, y)
    scale = lens.fields.scale
    return _launched(lens.system, x * scale, y * scale, *map(_floats, pupil), place, path)


def ray(point: tuple[ArrayLike, ArrayLike, ArrayLike], direction: tuple[ArrayLike, ArrayLike, ArrayLike]) -> Ray:
    """Rays to bring along: points in mm in the frame of the first vertex, directions of unit length (RayError)."""
    numbers = jnp.broadcast_arrays(*map(_floats, (*point, *direction)))
    return _checked(Ray(*numbers, failure=jnp.zeros(numbers[0].shape, jnp.int32)))


def _with_wavelength(lens: Lens, wavelength: float | None) -> tuple[Lens, int]:
    """The lens with this wavelength among its own, and its place."""
    waves = lens.wavelengths
    if is_traced(wavelength):
        raise RayError("wavelength cannot be traced by JAX: glasses are looked up by it; differentiate by the index")
    if wavelength is None:
        return lens, waves.primary
    if wavelength in waves.um:
        return lens, waves.um.index(wavelength)
    two = Wavelengths((1.0, 1.0), (waves.um[waves.primary], float(wavelength)), 0)
    return lens.replace(wavelengths=two), 1


def _checked(rays: Ray) -> Ray:
    numbers = (rays.x, rays.y, rays.z, rays.l, rays.m, rays.n)
    if not is_traced(numbers):
        x, y, z, l, m, n = map(np.asarray, numbers)
        if not all(np.isfinite(number).all() for number in (x, y, z, l, m, n)):
            raise RayError("a ray's point and direction must be finite numbers")
        length = np.sqrt(l * l + m * m + n * n)
        tolerance = max(UNIT_TOLERANCE, 8 * np.finfo(length.dtype).eps)
        if (np.abs(length - 1) > tolerance).any():
            worst = length.flat[np.abs(length - 1).argmax()]
            raise RayError(f"a direction must be a unit vector, got one of length {worst:.9g}; divide it by its length")
    return dataclasses.replace(rays, opl=jnp.zeros_like(rays.x)) if rays.opl is None else rays


def _floats(value: ArrayLike) -> jax.Array | np.ndarray:
    if isinstance(value, jax.Array):
        return value
    try:
        number = np.asarray(value, float)
    except (TypeError, ValueError):
        number = np.array(np.nan)
    if not np.isfinite(number).all():
        raise RayError(f"field and pupil must be finite numbers, got {value!r}")
    return number


@functools.partial(jax.jit, static_argnums=3)
def _through(system: System, rays: Ray, wavelength: int, path: bool) -> Ray:
    dtype = system.curvature.dtype
    rays = jax.tree.map(lambda a: a.astype(dtype) if jnp.issubdtype(a.dtype, jnp.floating) else a, rays)
    sense = jnp.where(rays.n < BACKWARD, -1.0, 1.0).astype(dtype)
    return trace_system(system.at(wavelength), rays, path=path, sense=sense)


@functools.partial(jax.jit, static_argnums=6)
def _launched(
    system: System,
    field_x: jax.Array,
    field_y: jax.Array,
    pupil_x: jax.Array,
    pupil_y: jax.Array,
    wavelength: int,
    path: bool,
) -> Ray:
    dtype = system.curvature.dtype
    field_x, field_y, pupil_x, pupil_y = (jnp.asarray(a, dtype) for a in (field_x, field_y, pupil_x, pupil_y))
    start = launch(system, (field_x, field_y), (pupil_x, pupil_y), wavelength)
    start = dataclasses.replace(start, opl=jnp.zeros_like(start.x))
    return trace_system(system.at(wavelength), start, path=path)
