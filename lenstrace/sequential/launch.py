"""From a field and a point of the pupil to a ray in front of the first surface."""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.optics.rays import Ray, RayStatus, failure_code, living
from lenstrace.optics.vectors import Vector, dot, minus, normalize
from lenstrace.sequential import paraxial
from lenstrace.sequential.aiming import aim
from lenstrace.sequential.system import Light, System
from lenstrace.sequential.trace import trace

# A ray flatter than this against the plane through the first vertex does not start on it, but where it is nearest
# to the vertex.
FLAT = 0.01


class Front(NamedTuple):
    """What launching needs to know of a lens, the same for all rays; see `front_of`.

    system:    at its primary wavelength.
    entrance:  its entrance pupil there.
    scale:     of fields given as image heights: the object focal length (mm), of a near object the magnification.
    radius:    of the stop, mm, that pupil coordinate 1 means for rays that are aimed, and
    known:     1 if the ray that says so arrives, else 0.
    """

    system: System
    entrance: paraxial.Pupil
    scale: jax.Array
    radius: jax.Array
    known: jax.Array


def front_of(system: System) -> Front:
    """The front of a system, given at its primary wavelength."""
    entrance = paraxial.entrance_pupil(system)
    radius = entrance.diameter / 2
    scale = known = jnp.ones_like(radius)
    if system.field_kind == "image_height":
        near = system.object_distance is not None
        scale = paraxial.magnification(system) if near else paraxial.first_order(system).object_focal_length
    if system.ray_aiming and system.aperture_kind == "stop_semi_diameter":
        radius = paraxial.stop_radius(system)
    elif system.ray_aiming:
        radius, known = _aimed_radius(Front(system, entrance, scale, radius, known))
    return Front(system, entrance, scale, radius, known)


def launch(
    front: Front,
    light: Light,
    field: tuple[jax.Array, jax.Array],
    pupil: tuple[jax.Array, jax.Array],
) -> Ray:
    """Rays of a field through points of the pupil, on the plane through the first vertex.

    light:   of the wavelength of the rays; it counts where rays are aimed.
    field:   x and y, radians or mm as `system.field_kind` says; any shape that broadcasts with the pupil.
    pupil:   x and y, in units of the radius of the paraxial entrance pupil, or of the stop if rays are aimed.

    A ray nearly parallel to the vertex plane starts at its point nearest to the vertex instead. A ray that cannot be
    aimed has status NOT_CONVERGED at surface 0.
    """
    system, radius = front.system, front.radius
    if not system.ray_aiming:
        return _through(front, field, pupil)
    fx, fy, px, py = jnp.broadcast_arrays(*field, *pupil)

    # what stops a ray must not decide which one is found
    here = system.with_light(light).without_apertures()

    def at_stop(shift: tuple[jax.Array, jax.Array], share: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        stop = trace(here, _shifted(front, (share * fx, share * fy), shift), last=system.stop)
        return stop.x / radius - share * px, stop.y / radius - share * py, stop.has_course

    def guess(share: jax.Array) -> tuple[jax.Array, jax.Array]:
        field = share * fx, share * fy
        return _shift_of(front, field, _through(front, field, (share * px, share * py)))

    shift, aimed = aim(at_stop, guess, fx)
    ray = _shifted(front, (fx, fy), shift)
    lost = failure_code(0, RayStatus.NOT_CONVERGED)
    return dataclasses.replace(ray, failure=jnp.where(aimed & (front.known > 0), ray.failure, lost).astype(jnp.int32))


def path_before(front: Front, light: Light, field: tuple[jax.Array, jax.Array], ray: Ray) -> jax.Array:
    """Optical path, mm, to where rays of a field are launched from the wavefront of its light through the first vertex.

    For a plane wave n d . r; for an object point P at a finite distance n (|r - P| - |P|), written so that it loses
    nothing to the distance of the object. light: of the wavelength of the rays.
    """
    at = ray.x, ray.y, ray.z
    if front.system.object_distance is None:
        return light.index[0] * dot((ray.l, ray.m, ray.n), at)
    start = object_point(front, field)
    apart = minus(at, start)
    both = jnp.sqrt(dot(apart, apart)) + jnp.sqrt(dot(start, start))
    return light.index[0] * dot(at, minus(apart, start)) / both


def object_point(front: Front, field: tuple[jax.Array, jax.Array]) -> Vector:
    """The object point of a field, mm from the first vertex; the system has its object at a finite distance."""
    system, entrance = front.system, front.entrance
    assert system.object_distance is not None
    fx, fy = field
    distance = jnp.asarray(system.object_distance)
    match system.field_kind:
        case "angle":
            scale = -(distance + jnp.where(jnp.isfinite(entrance.position), entrance.position, 0.0))
            x, y = scale * jnp.tan(fx), scale * jnp.tan(fy)
        case "image_height":
            x, y = fx / front.scale, fy / front.scale
        case _:
            x, y = fx, fy
    return x, y, jnp.broadcast_to(-distance, x.shape)


def field_direction(front: Front, field: tuple[jax.Array, jax.Array]) -> Vector:
    """Direction of the light of a field at infinity: along (tan ax, tan ay, 1); for a field in one plane
    (0, sin a, cos a), also at 90 degrees and beyond."""
    fx, fy = field
    if front.system.field_kind == "image_height":
        return normalize((-fx / front.scale, -fy / front.scale, jnp.ones_like(fx)))
    # (tan ax, tan ay, 1) times cos ax cos ay, which is finite and has the right sense at and beyond 90 degrees
    cx, cy = jnp.cos(fx), jnp.cos(fy)
    return normalize((jnp.sin(fx) * cy, jnp.sin(fy) * cx, cx * cy))


def _through(front: Front, field: tuple[jax.Array, jax.Array], pupil: tuple[jax.Array, jax.Array]) -> Ray:
    """Rays through points of the paraxial entrance pupil, given in units of its radius."""
    system, entrance = front.system, front.entrance
    px, py = pupil
    far = ~jnp.isfinite(entrance.position)
    radius = jnp.where(far, 0.0, entrance.diameter / 2)
    position = jnp.broadcast_to(jnp.where(far, 0.0, entrance.position), px.shape)
    target = (px * radius, py * radius, position)
    if system.object_distance is None:
        return _ray(target, field_direction(front, field))
    start = object_point(front, field)
    towards = _forward(normalize(minus(target, start)))
    # from the end of the line that is nearer to the first vertex: from the other one digits would be lost
    nearer = jnp.abs(start[2]) < jnp.abs(target[2])
    if system.aperture_kind != "object_na":
        return _ray(_choose(nearer, start, target), towards)
    slope = paraxial.marginal_slope(system)
    parallel = normalize((px * slope, py * slope, jnp.ones_like(px)))
    direction = _choose(far, parallel, towards)
    return _ray(_choose(far | nearer, start, target), direction)


def _shifted(front: Front, field: tuple[jax.Array, jax.Array], shift: tuple[jax.Array, jax.Array]) -> Ray:
    """Rays through a point of the plane that stands at the first vertex, normal to the line from the object to it."""
    if front.system.object_distance is None:
        direction = field_direction(front, field)
        return _ray(_in_plane(direction, shift), direction)
    start = object_point(front, field)
    point = _in_plane(normalize((-start[0], -start[1], -start[2])), shift)
    return _ray(point, normalize(minus(point, start)))


def _shift_of(front: Front, field: tuple[jax.Array, jax.Array], ray: Ray) -> tuple[jax.Array, jax.Array]:
    """The shift that gives `_shifted` this ray of the field."""
    if front.system.object_distance is None:
        axis = field_direction(front, field)
    else:
        x, y, z = object_point(front, field)
        axis = normalize((-x, -y, -z))
    direction, point = (ray.l, ray.m, ray.n), (ray.x, ray.y, ray.z)
    t = -dot(point, axis) / dot(direction, axis)
    x, y, z = (p + t * d for p, d in zip(point, direction, strict=True))
    first, second = _plane_axes(axis)
    return dot(first, (x, y, z)), dot(second, (x, y, z))


def _aimed_radius(front: Front) -> tuple[jax.Array, jax.Array]:
    """Height at the stop, mm, of the real ray of the axial point that enters at the top of the pupil, at the primary
    wavelength; and whether it arrives."""
    system = front.system
    rim = jnp.array([0, 1], system.curvature.dtype)
    stop = trace(system.without_apertures(), _through(front, (0 * rim, 0 * rim), (0 * rim, rim)), last=system.stop)
    # from the chief ray: a stop that is decentred is filled about its own centre
    return stop.y[1] - stop.y[0], stop.has_course.all().astype(stop.y.dtype)


def _ray(point: Vector, direction: Vector) -> Ray:
    """A ray through a point, slid to the first vertex plane; if it is too flat or runs away from it, to where it is
    nearest the vertex."""
    n = direction[2]
    steep = n > FLAT
    t = jnp.where(steep, -point[2] / jnp.where(steep, n, 1.0), -dot(point, direction))
    x, y, z = (p + t * d for p, d in zip(point, direction, strict=True))
    return living(x, y, jnp.where(steep, 0.0, z), *direction)


def _in_plane(axis: Vector, shift: tuple[jax.Array, jax.Array]) -> Vector:
    """The point at `shift` in the plane through the first vertex normal to `axis`."""
    first, second = _plane_axes(axis)
    x, y, z = (shift[0] * a + shift[1] * b for a, b in zip(first, second, strict=True))
    return x, y, z


def _plane_axes(axis: Vector) -> tuple[Vector, Vector]:
    """x and y turned by the shortest rotation that takes z into `axis`; not for axis = -z."""
    l, m, n = axis
    mixed = -l * m / (1 + n)
    return (1 - l * l / (1 + n), mixed, -l), (mixed, 1 - m * m / (1 + n), -m)


def _forward(a: Vector) -> Vector:
    """The same line, run toward +z: light from an object leaves it forward, wherever the pupil lies."""
    sign = jnp.where(a[2] < 0, -1.0, 1.0).astype(a[2].dtype)
    return sign * a[0], sign * a[1], sign * a[2]


def _choose(condition: jax.Array, a: Vector, b: Vector) -> Vector:
    x, y, z = (jnp.where(condition, p, q) for p, q in zip(a, b, strict=True))
    return x, y, z
