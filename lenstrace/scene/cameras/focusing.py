"""A lens set for a photograph: stopped down, and moved as a whole along its axis until a distance is sharp.

The object stands a distance s before the first vertex, the film t behind the last one, D = s + L + t apart, L the
length of the lens. Paraxially Newton's x x' = f f' with X = s + z_F, x' = t + L - z_F', Q = -f f' and
T = D - z_F' + z_F gives

    X + x' = T,   X x' = Q,     x' = 2 Q / (T + sqrt(T^2 - 4 Q)),

the solution with the smaller image, which exists from D = z_F' - z_F + 2 sqrt(Q) = 4 f' + HH' on. From there the film
is moved to where the spot of the traced rays of the axial point is least.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced
from lenstrace.errors import CameraError
from lenstrace.optics.frames import Pose
from lenstrace.optics.rays import Ray, living
from lenstrace.optics.vectors import divide_where, normalize, root_or_zero
from lenstrace.sequential import paraxial
from lenstrace.sequential.document import Aperture, Fields
from lenstrace.sequential.launch import front_of
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rows import Number
from lenstrace.sequential.sampling import pupil_points
from lenstrace.sequential.system import Placement, System
from lenstrace.sequential.trace import trace

# Rings of the hexapolar pattern whose spot is made least: those of `best_focus`.
RINGS = 6
# Of Newton's method with the paraxial derivative: what it leaves is below rounding from f/1 on.
STEPS = 5
# Of 1 + slope: at the nearest focus, where object and image have one size, it is 0.
LEAST_GAIN = 0.02
# With no more than this share of the rays of the axial point no focus is found.
FEW = 0.25


class Focusing(NamedTuple):
    """film: t, mm; object: s, mm, inf at infinity; nearest: the least D, mm; arrives: share of rays."""

    film: jax.Array
    object: jax.Array
    nearest: jax.Array
    arrives: jax.Array


def focused(lens: Lens, focus: Number | None, *, f_number: Number | None = None, unit_mm: float = 1.0) -> Lens:
    """The lens as it takes a picture: its stop a radius in mm, the film where its last thickness reaches, the object
    where that is sharp, at the primary wavelength.

    focus:     from the film to the sharp plane along the axis, in lengths of unit_mm millimetres; inf is allowed. None
               leaves the film where the lens has it, and the object too.
    f_number:  f' over the diameter of the entrance pupil; the stop follows by the traced marginal ray of an object at
               infinity. None: the aperture of the lens, its stop by the traced marginal ray of its own object.

    The focus is that of all rays that the open stop lets through; what apertures stop besides does not count.
    CameraError where the lens has no real image of that plane, or cannot be stopped so wide.
    """
    system = lens.system.at(lens.system.primary)
    radius = _stop_radius(system, f_number)
    stopped = Aperture(_plain(radius), "stop_semi_diameter")
    if focus is None:
        return dataclasses.replace(lens, aperture=stopped)
    far = not is_traced(focus) and math.isinf(focus)
    distance = math.inf if far else focus * unit_mm
    found = _focusing(system, radius, distance)
    if not is_traced(found):
        _check(lens, found, float(distance), unit_mm)
    rows = (*lens.rows[:-1], lens.rows[-1].replace(thickness=_plain(found.film)))
    fields = lens.fields
    if far and fields.kind == "object_height":
        fields = Fields((0.0,), (0.0,), "angle")
    return dataclasses.replace(
        lens, rows=rows, aperture=stopped, fields=fields, object_distance=None if far else _plain(found.object)
    )


def in_chain(system: System, surface: int, ray: Ray) -> Ray:
    """A ray in the frame of a surface, seen from the frame that the next surface counts from."""
    i = surface - 1
    if system.kinds[i].placement is not Placement.POSED:
        return ray
    pose = Pose(system.decenter[i], system.tilt[i])
    x, y, z = pose.global_point((ray.x, ray.y, ray.z))
    l, m, n = pose.global_direction((ray.l, ray.m, ray.n))
    return Ray(x, y, z, l, m, n, ray.failure, ray.opl)


def _stop_radius(system: System, f_number: Number | None) -> Any:
    """mm; CameraError where the marginal ray does not reach the stop."""
    asked = system.replace(ray_aiming=True, field_kind="angle")
    if f_number is not None:
        if not is_traced(f_number) and not (math.isfinite(f_number) and f_number > 0):
            raise CameraError(f"f_number must be positive, got {f_number}; None is that of the lens")
        if not is_traced(system) and bool(_powerless(system)):
            raise CameraError("f_number: this lens is afocal (power 0) and has none; it makes no picture by itself")
        asked = asked.replace(
            aperture_kind="image_f_number",
            stop_size=jnp.asarray(f_number, system.curvature.dtype),
            object_distance=None,
        )
    radius, known = _aimed(asked)
    if not is_traced((radius, known)) and not (known > 0 and math.isfinite(radius) and radius > 0):
        what = "the aperture of this lens" if f_number is None else f"f_number {f_number:g}"
        raise CameraError(f"{what}: its marginal ray does not reach the stop; take a larger f_number")
    return radius


@compiled
def _aimed(system: System) -> tuple[jax.Array, jax.Array]:
    front = front_of(system)
    return jnp.abs(front.radius), front.known


@compiled
def _powerless(system: System) -> jax.Array:
    return paraxial.is_afocal(paraxial.whole_matrix(system))


@compiled
def _focusing(system: System, radius: Any, distance: Any) -> Focusing:
    """distance: D, mm, or inf; the system at one wavelength."""
    first, index = paraxial.first_order(system), paraxial.signed_index(system)
    whole = paraxial.whole_matrix(system)
    length = jnp.sum(system.thickness[:-1])
    near, rear = first.front_focal_point, first.rear_vertex + first.rear_focal_point
    q = index[0] * index[-1] * divide_where(~paraxial.is_afocal(whole), jnp.ones_like(length), whole.c) ** 2
    infinite = jnp.isinf(distance)
    total = jnp.where(infinite, 0, distance) - rear + near
    square = total * total - 4 * q
    extension = divide_where(~infinite, 2 * q, total + root_or_zero(square))
    film = rear - length + extension
    # the derivative of the film's place by the object's, both in mm along the light
    slope = -divide_where(~infinite, extension * extension, q)

    def vergence(film: jax.Array) -> jax.Array:
        before = jnp.where(infinite, 1, distance) - length - film
        return divide_where(~infinite & (before != 0), jnp.ones_like(before), before)

    def step(_: jax.Array, state: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        film, _ = state
        sharpest, arrives = _sharpest(system, radius, vergence(film))
        gained = jnp.where(arrives > FEW, film - sharpest, 0)
        return film - gained / jnp.maximum(1 + slope, LEAST_GAIN), arrives

    film, arrives = jax.lax.fori_loop(0, STEPS, step, (film, jnp.zeros_like(film)))
    object_distance = jnp.where(infinite, jnp.inf, jnp.where(infinite, 0, distance) - length - film)
    return Focusing(film, object_distance, rear - near + 2 * root_or_zero(q), arrives)


def _sharpest(system: System, radius: Any, vergence: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Where the spot of the axial point is least, mm from the last vertex, and the share of its rays that arrives.

    vergence: one over the distance of the point from the first vertex, 1/mm. A ray that reaches the stop at R tau
    paraxially meets the first vertex plane at y = R tau / (a + b n vergence), [a b] from there to the stop.
    """
    m = paraxial.matrix(system, 1, system.stop, bend_last=False)
    wide = m.a + m.b * system.index[0] * vergence
    height = divide_where(wide != 0, jnp.asarray(radius), wide)
    points = pupil_points("hexapolar", RINGS)
    x, y = height * points.x.astype(height.dtype), height * points.y.astype(height.dtype)
    towards = normalize((vergence * x, vergence * y, jnp.ones_like(x)))
    ray = trace(system.without_apertures(), living(x, y, 0 * x, *towards), last=system.surfaces)
    ray = in_chain(system, system.surfaces, ray)
    good = ray.ok & (ray.n != 0)
    n = jnp.where(good, ray.n, 1)
    count = jnp.maximum(jnp.sum(good.astype(x.dtype)), 1)

    def about_mean(values: jax.Array) -> jax.Array:
        values = jnp.where(good, values, 0)
        return jnp.where(good, values - jnp.sum(values) / count, 0)

    u, v = about_mean(ray.l / n), about_mean(ray.m / n)
    dx, dy = about_mean(ray.x - ray.z * ray.l / n), about_mean(ray.y - ray.z * ray.m / n)
    spread = jnp.sum(u * u + v * v)
    return divide_where(spread > 0, -jnp.sum(dx * u + dy * v), spread), count / x.size


def _check(lens: Lens, found: Focusing, distance: float, unit_mm: float) -> None:
    """CameraError where the film cannot stand there."""
    system = lens.system
    sense = system.orientation[-1]
    if bool(_powerless(system.at(system.primary))):
        raise CameraError("focus: this lens is afocal (power 0) and has no image to focus; add a lens behind it")
    if math.isnan(distance) or distance <= 0:
        raise CameraError(f"focus must be positive, from the film to the sharp plane, got {distance / unit_mm:g}")
    film, nearest = float(found.film), float(found.nearest) / unit_mm
    if distance / unit_mm < nearest:
        raise CameraError(
            f"focus: {distance / unit_mm:g} from the film is nearer than this lens can image, {nearest:.6g} "
            "(4 f' and the distance of its principal planes); focus farther away, or take a shorter lens"
        )
    if not (math.isfinite(film) and sense * film > 0) or not float(found.object) > 0 or found.arrives <= FEW:
        raise CameraError(
            f"focus: this lens has no real image of a plane {distance / unit_mm:g} from the film (the film would stand "
            f"{film:.6g} mm from the last vertex); focus farther away, or take a converging lens"
        )


def _plain(value: Any) -> Any:
    """A number, unless JAX traces it."""
    return value if is_traced(value) else float(value)
