"""Illumination against field: the part of the pupil that arrives, how bright the image is, and angles of incidence."""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.field_line import FieldLine, Rays, arriving, field_line, shares_of
from lenstrace.compute.blocks import each
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree
from lenstrace.errors import RayError
from lenstrace.optics.rays import RayStatus, has_course
from lenstrace.optics.vectors import dot, root_or_zero, rotate, rotate_back
from lenstrace.sequential import paraxial
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.normals import surface_normal, surface_normals
from lenstrace.sequential.system import Light, System
from lenstrace.sequential.trace import trace
from lenstrace.sequential.vertices import vertices

DEGREES = 180 / np.pi
MOST_RAYS = 1 << 20


@pytree
class Illumination:
    """Light of P fields from the axis to the largest one, at the primary wavelength.

    field:        (P,), from the axis, in the unit of the lens's fields.    direction: (2,), toward the largest field.
    fraction:     (P,), of the area of the pupil that arrives: 1 without vignetting.
    solid_angle:  (P,), steradians, of the bundle at the image, projected on the image surface: the area that it fills
                  in the plane of the direction cosines (l, m) about the normal of the image surface. nan where no ray
                  arrives, and all of it where the image is at infinity.
    relative:     (P,), solid_angle over that of field 0: the relative illumination of the image of a plane of uniform
                  (Lambertian) radiance, where the bundle of an image point is that of one object point.
                  Absorption and reflection losses do not count.

    The solid angle is that of the light of one object point, weighed where it meets the image surface; it is not the
    flux through an area of the image. The two agree where the light of the object point meets at an image point. On an
    image surface out of focus, or behind strong aberrations, the rays that cross an area of the image come from
    many object points, and `relative` does not tell how bright it is: values above 1 occur.

    Source: Rimmer, Proc. SPIE 655, 99 (1986).
    """

    field: jax.Array
    direction: jax.Array
    fraction: jax.Array
    solid_angle: jax.Array
    relative: jax.Array


@pytree
class IncidenceAngles:
    """Angles between rays and the normals of the surfaces they meet, at the primary wavelength; degrees, 0 to 90.

    field:     (P,), from the axis, in the unit of the lens's fields.       direction: (2,), toward the largest field.
    chief:     (P, K), at the surfaces 1 ... S and the image, K = S + 1.
    upper:     (P, K), of the ray at the edge of the pupil toward the field's direction; lower: away from it. Those of
               field 0 are the marginal rays of the axial point.
    nan where a ray does not reach the surface.
    """

    field: jax.Array
    direction: jax.Array
    chief: jax.Array
    upper: jax.Array
    lower: jax.Array

    @property
    def largest(self) -> jax.Array:
        """(K,), the largest of these angles at each surface; nan where no ray comes."""
        angles = jnp.concatenate([self.chief, self.upper, self.lower])
        most = jnp.max(jnp.where(jnp.isnan(angles), -1, angles), 0)
        return jnp.where(most < 0, jnp.nan, most)


class _Asked(NamedTuple):
    """The front of a lens, and its light at one wavelength."""

    front: Front
    light: Light


def relative_illumination(lens: Lens, *, points: int = 11, rays: int = 2048) -> Illumination:
    """Vignetting and relative illumination against field.

    points: fields from 0 to the largest, evenly spaced; one if the lens has the field 0 alone.
    rays:   through the pupil of each field, evenly spread. An edge that cuts the pupil leaves an error of about
            rays^(-3/4), 0.3 %; without one it is about 1e-5. By derivatives such an edge is held fixed.
    """
    system, front = with_pupil(lens)
    if isinstance(rays, bool) or not isinstance(rays, int | np.integer) or not 1 <= rays <= MOST_RAYS:
        raise RayError(f"rays must be a whole number from 1 to {MOST_RAYS}, got {rays!r}")
    line = field_line(system, shares_of(lens, points))
    x, y = (a.astype(system.curvature.dtype) for a in _spiral(rays))
    found = each(_bundle, _Asked(front, system.light_at(system.primary)), _bundles(line, x, y))
    return _illumination(system, line, found, lens.fields.scale)


def incidence_angles(lens: Lens, *, points: int = 11) -> IncidenceAngles:
    """Angles of incidence of chief and marginal rays at every surface.

    points: fields from 0 to the largest, evenly spaced; one if the lens has the field 0 alone.
    """
    system, front = with_pupil(lens)
    return _incidence(front, system, shares_of(lens, points), lens.fields.scale)


def _spiral(rays: int) -> tuple[np.ndarray, np.ndarray]:
    """x and y of at least so many points that cover the unit disk evenly, none aligned with an edge, straight or round;
    turned by a right angle they are the same, so that what is odd, or a second harmonic, is integrated exactly.

    Source: Vogel, Math. Biosci. 44, 179 (1979): r = sqrt((k + 1/2) / N), turned by the golden angle each.
    """
    count = -(-rays // 4)
    k = np.arange(count)
    radius, turn = np.sqrt((k + 0.5) / count), np.pi * (3 - np.sqrt(5)) * k
    x, y = radius * np.cos(turn), radius * np.sin(turn)
    return np.concatenate([x, -y, -x, y]), np.concatenate([y, x, -y, -x])


@compiled
def _bundles(line: FieldLine, x: Any, y: Any) -> Rays:
    """All rays, (P, N)."""
    return Rays(*jnp.broadcast_arrays(line.x[:, None], line.y[:, None], x, y))


def _bundle(asked: _Asked, rays: Rays) -> tuple[jax.Array, jax.Array]:
    """Of each ray: whether it arrives, and its projected solid angle for a unit of pupil area."""
    front, light = asked

    def directions(px: jax.Array, py: jax.Array) -> tuple[tuple[jax.Array, jax.Array], Any]:
        ray = arriving(front, light, Rays(rays.field_x, rays.field_y, px, py))
        return (ray.l, ray.m), ray

    def derivative(toward: tuple[jax.Array, jax.Array]) -> Any:
        return jax.jvp(directions, (rays.pupil_x, rays.pupil_y), toward, has_aux=True)

    one, zero = jnp.ones_like(rays.pupil_x), jnp.zeros_like(rays.pupil_x)
    basis = jnp.stack([one, zero]), jnp.stack([zero, one])
    _, ((l_x, l_y), (m_x, m_y)), ray = jax.vmap(derivative, out_axes=(None, 0, None))(basis)
    system = front.system
    normal = surface_normal(system, len(system.kinds), (ray.x, ray.y, ray.z))
    # dl dm = |n| dOmega; on a tilted element of the image cos(theta) takes the place of |n|
    tilt = dot(normal, (ray.l, ray.m, ray.n)) / jnp.sqrt(dot(normal, normal)) / jnp.where(ray.n == 0, 1, ray.n)
    return ray.ok, jnp.abs((l_x * m_y - l_y * m_x) * tilt)


@compiled
def _illumination(
    system: System, line: FieldLine, found: tuple[jax.Array, jax.Array], scale: jax.Array | float
) -> Illumination:
    arrives, density = found
    fraction = jnp.mean(arrives.astype(density.dtype), -1)
    whole = jnp.pi * jnp.mean(jnp.where(arrives, density, 0), -1)
    imaged = paraxial.image_slope(system.at(system.primary)) != 0
    solid = jnp.where(imaged & (fraction > 0), whole, jnp.nan)
    return Illumination(line.height / scale, line.direction, fraction, solid, solid / solid[0])


@compiled
def _incidence(front: Front, system: System, shares: Any, scale: jax.Array | float) -> IncidenceAngles:
    line = field_line(system, shares)
    primary = system.at(system.primary)
    ux, uy = line.direction
    edge = jnp.array([0, 1, -1], line.x.dtype)[:, None]
    field = jnp.broadcast_arrays(line.x, line.y, edge)[:2]
    start = launch(front, primary.light, (field[0], field[1]), (edge * ux, edge * uy))
    path = trace(primary, start, path=True)
    # the direction in front of each surface is that behind the one before, turned from one frame into the other
    rotations = vertices(system)[0]
    behind = jnp.concatenate([jnp.eye(3, dtype=rotations.dtype)[None], rotations[:-1]])
    turned = jax.vmap(lambda r, d: rotate(r, d))(behind, (path.l[:-1], path.m[:-1], path.n[:-1]))
    direction = jax.vmap(lambda r, d: rotate_back(r, d))(rotations, turned)
    point = path.x[1:], path.y[1:], path.z[1:]
    normal = surface_normals(system, point)
    x, y, z = (normal[i - 2] * direction[i - 1] - normal[i - 1] * direction[i - 2] for i in (0, 1, 2))
    angle = DEGREES * jnp.arctan2(root_or_zero(x * x + y * y + z * z), jnp.abs(dot(normal, direction)))
    # chief rays are followed through what stops them; a ray that is stopped or totally reflected has met the surface
    before, here = path.failure[:-1], path.failure[1:]
    reaches = jnp.where(jnp.arange(3)[:, None] == 0, has_course(before), before == 0)
    meets = has_course(here) | (path.status[1:] == int(RayStatus.TIR))
    chief, upper, lower = jnp.moveaxis(jnp.where(reaches & meets, angle, jnp.nan), 0, -1)
    return IncidenceAngles(line.height / scale, line.direction, chief, upper, lower)
