"""Rays asked of a lens: by field, pupil point and wavelength, or brought along."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike

from lenstrace.analysis.conditions import with_pupil
from lenstrace.compute.blocks import each
from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.errors import RayError
from lenstrace.optics.rays import Ray, living
from lenstrace.sequential.build import light_of
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rules import check_field, check_wavelength
from lenstrace.sequential.system import Light, System
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
    opl: bool = True,
) -> Ray:
    """Rays through a lens, exactly.

    rays:        given in the frame of the first vertex (see `ray`); then field and pupil are not used. A given ray
                 with n < -1/2 runs against the light.
    field:       y, or (x, y), in the unit of the lens's fields (degrees, or the file's length).
    pupil:       x and y, in units of the radius of the paraxial entrance pupil; of the stop with ray aiming.
                 Field and pupil broadcast to the shape of the result.
    wavelength:  micrometres, any that the glasses know; the primary one by default.
    path:        all surfaces along a leading axis (0 launch, 1 ... S, S + 1 image), or the image alone.
    opl:         optical path lengths too; without them a million rays take two thirds of the time.

    Each surface's x, y, z (mm) and l, m, n are in its own frame, the direction is that behind it, opl (mm)
    counts from the launch point. Failed rays have a `status` and a `surface`, and finite numbers.
    RayError for a direction that is not a unit vector; WavelengthError outside a glass's range.
    """
    if rays is not None:
        system = lens.system
        asked = _Asked(system.with_light(_light(lens, system, wavelength)), path, opl)
        answer, sound = each(_through, asked, _in_precision(rays, system.curvature.dtype))
        if not is_traced(sound) and not np.asarray(sound).all():
            _check(rays)
        return answer
    system, front = with_pupil(lens)
    x, y = map(_floats, _pair(field if isinstance(field, tuple) else (0.0, field), "field"))
    check_field(lens, x, y)
    points = (x * lens.fields.scale, y * lens.fields.scale, *map(_floats, _pair(pupil, "pupil")))
    asked = _Asked(system.with_light(_light(lens, system, wavelength)), path, opl)
    return each(_launched, (front, asked), _numbers(points, system.curvature.dtype))


def ray(point: tuple[ArrayLike, ArrayLike, ArrayLike], direction: tuple[ArrayLike, ArrayLike, ArrayLike]) -> Ray:
    """Rays to bring along: points in mm in the frame of the first vertex, directions of unit length (RayError)."""
    given = [value if isinstance(value, jax.Array) else np.asarray(value, float) for value in (*point, *direction)]
    rays = living(*map(jnp.asarray, given))
    if not is_traced(rays) and not np.asarray(_is_sound(jax.tree.map(np.asarray, rays))).all():
        _check(rays)
    return rays


@pytree
class _Asked:
    """A lens at the wavelength asked for, and what is wanted of the rays."""

    system: System
    path: bool = static()
    opl: bool = static()


def _light(lens: Lens, system: System, wavelength: float | None) -> Light:
    """Of a wavelength, in the precision of the lens."""
    waves = lens.wavelengths
    if is_traced(wavelength):
        raise RayError("wavelength cannot be traced by JAX: glasses are looked up by it; differentiate by the index")
    if wavelength is None or wavelength in waves.um:
        return system.light_at(system.primary if wavelength is None else waves.um.index(wavelength))
    check_wavelength(wavelength)
    return jax.tree.map(lambda a: a[0], light_of(lens, [float(wavelength)]))


def _in_precision(rays: Ray, dtype: Any) -> Ray:
    """Given rays in the precision of the lens."""
    opl = None if rays.opl is None else _numbers([rays.opl], dtype)[0]
    return Ray(*_numbers((rays.x, rays.y, rays.z, rays.l, rays.m, rays.n), dtype), failure=rays.failure, opl=opl)


def _is_sound(rays: Ray) -> Any:
    """True where a ray has a place and a direction of unit length."""
    tolerance = max(UNIT_TOLERANCE, 8 * float(jnp.finfo(rays.l.dtype).eps))
    square = rays.l * rays.l + rays.m * rays.m + rays.n * rays.n
    return (abs(square - 1) <= 2 * tolerance) & (abs(rays.x) + abs(rays.y) + abs(rays.z) < np.inf)


def _check(rays: Ray) -> None:
    """RayError for the ray that is least sound."""
    x, y, z, l, m, n = map(np.asarray, (rays.x, rays.y, rays.z, rays.l, rays.m, rays.n))
    if not all(np.isfinite(number).all() for number in (x, y, z, l, m, n)):
        raise RayError("a ray's point and direction must be finite numbers")
    length = np.sqrt(l * l + m * m + n * n)
    worst = length.flat[np.abs(length - 1).argmax()]
    raise RayError(f"a direction must be a unit vector, got one of length {worst:.9g}; divide it by its length")


def _numbers(values: Iterable[Any], dtype: Any) -> tuple[Any, ...]:
    """Arrays of one shape and of one precision; in numpy where JAX holds none of them."""
    values = tuple(values)
    if not all(map(np.size, values)):
        raise RayError("no rays given: field, pupil or the rays are empty arrays")
    try:
        np.broadcast_shapes(*map(np.shape, values))
    except ValueError:
        shapes = ", ".join(str(np.shape(value)) for value in values)
        raise RayError(f"field and pupil, or the numbers of the rays, do not broadcast: shapes {shapes}") from None
    alike = len(set(map(np.shape, values))) == 1
    if alike and any(isinstance(value, jax.Array) for value in values):
        return tuple(jnp.asarray(value, dtype) for value in values)
    if any(isinstance(value, jax.Array) for value in values):
        return tuple(jnp.broadcast_arrays(*(jnp.asarray(value, dtype) for value in values)))
    return np.broadcast_arrays(*(np.asarray(value, dtype) for value in values))


def _pair(value: Any, what: str) -> tuple[Any, Any]:
    """x and y; else RayError."""
    try:
        x, y = value
    except (TypeError, ValueError):
        raise RayError(f"{what} must be a pair (x, y), got {value!r}") from None
    return x, y


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


def _through(asked: _Asked, rays: Ray) -> tuple[Ray, jax.Array]:
    sense = jnp.where(rays.n < BACKWARD, -1.0, 1.0).astype(rays.n.dtype)
    return _arriving(asked, rays, sense), _is_sound(rays)


def _launched(asked: tuple[Front, _Asked], points: tuple[jax.Array, jax.Array, jax.Array, jax.Array]) -> Ray:
    front, of_rays = asked
    field_x, field_y, pupil_x, pupil_y = points
    return _arriving(of_rays, launch(front, of_rays.system.light, (field_x, field_y), (pupil_x, pupil_y)), 1.0)


def _arriving(asked: _Asked, rays: Ray, sense: Any) -> Ray:
    opl = (jnp.zeros_like(rays.x) if rays.opl is None else rays.opl) if asked.opl else None
    return trace_system(asked.system, dataclasses.replace(rays, opl=opl), path=asked.path, sense=sense)
