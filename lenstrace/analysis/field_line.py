"""Fields from the axis to the largest one of a lens, in one plane through the axis, and the rays beside any rays.

What a parabasal ray does, Coddington's equations say of a sphere; here it is the exact derivative of the trace.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import RayError
from lenstrace.optics.rays import Ray, has_course
from lenstrace.optics.vectors import divide_where, safe_divide, safe_sqrt
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import Light, System
from lenstrace.sequential.trace import trace

Pair = tuple[jax.Array, jax.Array]
# Points of a curve: more are seen by nobody, and do not fit into the memory of a small machine.
MOST_POINTS = 10_001


@pytree
class FieldLine:
    """P fields from 0 to the largest of a lens.

    height:     (P,), angle from the axis in radians, or height in mm, as `System.field_kind` says; not negative.
    direction:  (2,), unit vector in x and y toward the largest field; +y in a lens with the field 0 alone.
    x, y:       (P,), the fields as `launch` takes them.
    """

    height: jax.Array
    direction: jax.Array
    x: jax.Array
    y: jax.Array


class Rays(NamedTuple):
    """Rays asked for: field (radians or mm) and pupil, as `launch` takes them; all arrays of one shape."""

    field_x: Any
    field_y: Any
    pupil_x: Any
    pupil_y: Any


class Arrival(NamedTuple):
    """Rays at the image, in its frame; all arrays of one shape.

    x, y, z:           mm, on the image surface.
    offset_x, offset_y, slope_x, slope_y:  the line of the ray: x and y (mm) where z = 0, dx/dz and dy/dz.
    """

    x: jax.Array
    y: jax.Array
    z: jax.Array
    offset_x: jax.Array
    offset_y: jax.Array
    slope_x: jax.Array
    slope_y: jax.Array


class Beside(NamedTuple):
    """Rays, and what the rays beside them differ in.

    ray:      (W, N).       change: (W, N), the exact derivatives of `ray`.
    failure:  (W, N), see `Ray`.
    """

    ray: Arrival
    change: Arrival
    failure: jax.Array


def check_points(points: Any) -> None:
    """RayError for fewer than one point of a curve, or more than MOST_POINTS."""
    if isinstance(points, bool) or not isinstance(points, int | np.integer) or not 1 <= points <= MOST_POINTS:
        raise RayError(f"points must be a whole number, at least 1 and at most {MOST_POINTS}, got {points!r}")


def shares_of(lens: Lens, points: int) -> np.ndarray:
    """(P,), from 0 to 1 of the largest field; 0 alone where the lens has no other field. RayError as `check_points`."""
    check_points(points)
    values = (*lens.fields.x, *lens.fields.y)
    if not is_traced(values) and not any(map(float, values)):
        points = 1
    return np.linspace(0, 1, points).astype(lens.system.curvature.dtype)


@compiled
def field_line(system: System, shares: Any) -> FieldLine:
    """Fields at these shares (P,) of the largest of a system.

    Angles are from the axis: the direction of the light is (u_x sin h, u_y sin h, cos h).
    """
    fx, fy = system.fields[:, 0], system.fields[:, 1]
    angles = system.field_kind == "angle"
    # toward (tan ax, tan ay, 1), times cos ax cos ay
    across_x, across_y = (jnp.sin(fx) * jnp.cos(fy), jnp.sin(fy) * jnp.cos(fx)) if angles else (fx, fy)
    square = across_x * across_x + across_y * across_y
    across = jnp.where(square > 0, safe_sqrt(square), 0)
    height = jnp.arctan2(across, jnp.cos(fx) * jnp.cos(fy)) if angles else across
    largest = jnp.argmax(height)
    some = across[largest] > 0
    ux = divide_where(some, across_x[largest], across[largest])
    uy = jnp.where(some, divide_where(some, across_y[largest], across[largest]), 1)
    heights = shares * height[largest]
    if not angles:
        return FieldLine(heights, jnp.stack([ux, uy]), heights * ux, heights * uy)
    # a field in x or y alone has no other angle, also beyond 90 degrees
    x, y = (jnp.where(u == 0, 0, jnp.arctan2(u * jnp.sin(heights), jnp.cos(heights))) for u in (ux, uy))
    return FieldLine(heights, jnp.stack([ux, uy]), x, y)


def arriving(front: Front, light: Light, rays: Rays) -> Ray:
    """Rays of one wavelength at the image surface, in its frame."""
    start = launch(front, light, (rays.field_x, rays.field_y), (rays.pupil_x, rays.pupil_y))
    return trace(front.system.with_light(light), start)


@compiled
def beside(front: Front, light: Light, rays: Rays, toward: Rays) -> Beside:
    """Rays of every wavelength, and the rays beside them, by the derivative of the trace: aspheres, tilts and aiming
    are in it. One program for all questions about as many rays.

    light: of each wavelength.    rays: (N,) each.    toward: (N,) each, where in field and pupil their neighbours are.
    """

    def at(light: Light) -> Beside:
        def arrival(*points: jax.Array) -> tuple[Arrival, jax.Array]:
            ray = arriving(front, light, Rays(*points))
            n = jnp.where(ray.n == 0, 1, ray.n)
            slope_x, slope_y = ray.l / n, ray.m / n
            offset = ray.x - slope_x * ray.z, ray.y - slope_y * ray.z
            return Arrival(ray.x, ray.y, ray.z, *offset, slope_x, slope_y), ray.failure

        return Beside(*jax.jvp(arrival, tuple(map(jnp.asarray, rays)), tuple(map(jnp.asarray, toward)), has_aux=True))

    return lax.map(at, jax.tree.map(jnp.asarray, light))


def crossing(change: Arrival) -> jax.Array:
    """z (mm) where two lines are nearest to each other in x and y, out of the difference of the two, or of its
    derivative: (x + z sx)^2 + (y + z sy)^2 is least at z = -(x sx + y sy) / (sx^2 + sy^2). inf where they are parallel.
    """
    square = change.slope_x * change.slope_x + change.slope_y * change.slope_y
    z = -safe_divide(change.offset_x * change.slope_x + change.offset_y * change.slope_y, square)
    return jnp.where(square > 0, z, jnp.inf)


def chief_places(found: Beside) -> Pair:
    """x and y of chief rays on the image surface, mm; nan where there is none."""
    x, y = (jnp.where(has_course(found.failure), a, jnp.nan) for a in (found.ray.x, found.ray.y))
    return x, y


@compiled
def chief_and_beside(line: FieldLine) -> tuple[Rays, Rays, Rays]:
    """The chief rays of a line of fields, and which way their neighbours are in the pupil: in the plane of field and
    axis, and across it."""
    zero = jnp.zeros_like(line.x)
    ux, uy = (zero + u for u in line.direction)
    return Rays(line.x, line.y, zero, zero), Rays(zero, zero, ux, uy), Rays(zero, zero, -uy, ux)


@compiled
def small_fields(direction: Any, like: jax.Array) -> tuple[Rays, Rays]:
    """The chief ray of field 0, as many times as `like` (N,) is long, and its neighbours in a direction (2,) of the
    field: they give what a small field does, mm per radian or per mm of field."""
    zero = jnp.zeros_like(like)
    return Rays(zero, zero, zero, zero), Rays(zero + direction[0], zero + direction[1], zero, zero)
