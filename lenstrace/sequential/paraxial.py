"""Paraxial optics: the y-nu trace, cardinal points, pupils, conjugates.

A paraxial ray is its height y (mm) and its reduced slope w = N u, where u = dy/dz is the geometric slope and
N = sigma n the index, negative where light travels toward -z. A surface with curvature c does w -= phi y,
phi = c (N2 - N1); a gap t does y += t w / N. Tilts and decentres do not count. An r^2 asphere term a adds 2 a
to the curvature. A phase screen W adds -W_yy to phi.

Source: Welford, Aberrations of Optical Systems (1986), chapter 3; Born & Wolf, section 4.4.
"""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree
from lenstrace.optics.screens.screen import power_at_vertex
from lenstrace.optics.vectors import safe_divide
from lenstrace.sequential.system import System

# Power below this many units in the last place of the sum of its parts is none: the lens is afocal.
AFOCAL = 16.0


class Matrix(NamedTuple):
    """y2 = a y1 + b w1, w2 = c y1 + d w1, with a d - b c = 1; b in mm, c in 1/mm. `noise` bounds the
    rounding of c, 1/mm."""

    a: jax.Array
    b: jax.Array
    c: jax.Array
    d: jax.Array
    noise: jax.Array


@pytree
class FirstOrder:
    """First-order figures at one wavelength (or arrays over several); lengths in mm, signed along +z.

    Rear points are measured from the last vertex that bends light, which stands at `rear_vertex` from the first
    (along the unfolded axis); front points from the first vertex. In an afocal lens power is 0 and what lies at
    infinity is inf.
    """

    power: jax.Array
    focal_length: jax.Array
    object_focal_length: jax.Array
    rear_focal_point: jax.Array
    front_focal_point: jax.Array
    rear_principal_plane: jax.Array
    front_principal_plane: jax.Array
    rear_nodal_point: jax.Array
    front_nodal_point: jax.Array
    rear_vertex: jax.Array

    @property
    def back_focal_length(self) -> jax.Array:
        """From the last vertex that bends light to F', mm."""
        return self.rear_focal_point

    @property
    def front_focal_length(self) -> jax.Array:
        """From the first vertex to F, mm."""
        return self.front_focal_point


@pytree
class Pupil:
    """A pupil on the axis. position: mm, signed, from the vertex its function names. diameter: mm.

    magnification: pupil radius / stop radius, signed. At infinity position and diameter are inf.
    """

    position: jax.Array
    diameter: jax.Array
    magnification: jax.Array


def signed_index(system: System) -> jax.Array:
    """N = sigma n of the object space and after each surface, (S + 1,); the system at one wavelength."""
    return jnp.asarray(np.array(system.orientation, system.curvature.dtype)) * system.index


def whole_matrix(system: System) -> Matrix:
    """From in front of the first surface to behind the last one that bends; to the last where none does.

    Which one that is follows from the numbers, so that it is the same when JAX traces them.
    """
    kept = jnp.append(jnp.where(gaps_behind(system), 0, system.thickness[:-1]), system.thickness[-1])
    return matrix(dataclasses.replace(system, thickness=kept), 1, system.surfaces)


def gaps_behind(system: System) -> jax.Array:
    """(S - 1,) of bool: True for the gaps between the rows that no bending surface follows; none where none bends."""
    bends = jnp.asarray(system.bends)
    followed = jnp.flip(jnp.cumsum(jnp.flip(bends))) > 0
    return ~followed[1:] & jnp.any(bends)


def matrix(system: System, first: int, last: int, *, bend_last: bool = True) -> Matrix:
    """From in front of surface `first` to behind surface `last`, or to its plane before it bends.

    Surfaces are numbered from 1; the system is at one wavelength.
    """
    dtype = system.curvature.dtype
    zero, one = jnp.zeros((), dtype), jnp.ones((), dtype)
    unit = Matrix(one, zero, zero, one, zero)
    rows = slice(first - 1, last)
    power = surface_powers(system)[rows]
    if not bend_last:
        power = power.at[-1].set(0)
    index = signed_index(system)
    gap = jnp.append(zero, (system.thickness[:-1] / index[1:-1])[first - 1 : last - 1])

    def through(so_far: Matrix, surface: tuple[jax.Array, jax.Array]) -> tuple[Matrix, None]:
        phi, distance = surface
        a, b, c, d, noise = so_far
        a, b = a + distance * c, b + distance * d
        return Matrix(a, b, c - phi * a, d - phi * b, noise + jnp.abs(phi * a)), None

    whole, _ = jax.lax.scan(through, unit, (power, gap))
    return whole


def surface_powers(system: System) -> jax.Array:
    """(S,), phi of each surface, 1/mm: of its curvature, and of a phase screen; its slope at the vertex, as that of a
    grating, does not count. The system at one wavelength."""
    index = signed_index(system)
    power = effective_curvature(system)[:-1] * (index[1:] - index[:-1])
    for place, kind in enumerate(system.kinds[:-1]):
        if kind.screen is not None:
            thin = power_at_vertex(system.screens[kind.screen], jnp.asarray(system.wavelength))
            power = power.at[place].add(thin)
    return power


def effective_curvature(system: System) -> jax.Array:
    """Curvature at the vertex, asphere r^2 terms included, (K,), 1/mm."""
    if not any(2 in kind.powers for kind in system.kinds):
        return jnp.asarray(system.curvature)
    return system.curvature + 2 * system.term(2)


def first_order(system: System) -> FirstOrder:
    """Cardinal points of a system at one wavelength.

    With [a b; c d] from the first vertex to the last that bends and N, N' the signed indices outside:
    phi = -c, f' = N'/phi, f = -N/phi, F = N d / c, F' = -N' a / c, H = F - f, H' = F' - f', nodal points
    F + f' and F' + f.
    """
    m = whole_matrix(system)
    index = signed_index(system)
    before, after = index[0], index[-1]
    afocal = is_afocal(m)
    c = jnp.where(afocal, m.c - jax.lax.stop_gradient(m.c), m.c)
    inverse = 1 / jnp.where(afocal, 1.0, m.c)

    def at(numerator: jax.Array) -> jax.Array:
        """numerator / c, inf in an afocal lens whatever the sign, also where the numerator is 0."""
        return jnp.where(afocal, jnp.inf, numerator * inverse)

    f_rear, f_front = at(-after), at(before)
    rear, front = at(-after * m.a), at(before * m.d)
    return FirstOrder(
        power=0.0 - c,
        focal_length=f_rear,
        object_focal_length=f_front,
        rear_focal_point=rear,
        front_focal_point=front,
        rear_principal_plane=at(after * (1 - m.a)),
        front_principal_plane=at(before * (m.d - 1)),
        rear_nodal_point=at(before - after * m.a),
        front_nodal_point=at(before * m.d - after),
        rear_vertex=jnp.sum(jnp.where(gaps_behind(system), 0, system.thickness[:-1])),
    )


def is_afocal(m: Matrix) -> jax.Array:
    """True where the power of a matrix is rounding only."""
    return jnp.abs(m.c) <= AFOCAL * jnp.finfo(m.c.dtype).eps * m.noise


def entrance_pupil(system: System) -> Pupil:
    """The stop seen from the object, from the first vertex; the system at one wavelength.

    The diameter follows from what the aperture of the lens says: see `stop_radius`.
    """
    m = matrix(system, 1, system.stop, bend_last=False)
    far = jnp.abs(m.a) <= AFOCAL * jnp.finfo(m.a.dtype).eps * (1 + jnp.abs(m.b * m.c))
    a = jnp.where(far, 1.0, m.a)
    index = signed_index(system)[0]
    return Pupil(
        position=jnp.where(far, jnp.inf, index * m.b / a),
        diameter=jnp.where(far, jnp.inf, jnp.abs(2 * stop_radius(system, m) / a)),
        magnification=jnp.where(far, jnp.inf, 1 / a),
    )


def exit_pupil(system: System) -> Pupil:
    """The stop seen from the image, from the vertex of the image surface; the system at one wavelength."""
    m = matrix(system, system.stop, system.surfaces)
    far = jnp.abs(m.d) <= AFOCAL * jnp.finfo(m.d.dtype).eps * (1 + jnp.abs(m.b * m.c))
    d = jnp.where(far, 1.0, m.d)
    index = signed_index(system)[-1]
    return Pupil(
        position=jnp.where(far, jnp.inf, -index * m.b / d - system.thickness[-1]),
        diameter=jnp.where(far, jnp.inf, jnp.abs(2 * stop_radius(system) / d)),
        magnification=jnp.where(far, jnp.inf, 1 / d),
    )


def stop_radius(system: System, m: Matrix | None = None) -> jax.Array:
    """Paraxial radius of the stop, mm, signed: the height there of a ray that enters at the top of the pupil.

    entrance_pupil_diameter: half of it times a of the matrix to the stop.
    stop_semi_diameter: itself, with the sign of that a.
    image_f_number: the entrance pupil has the diameter |f'| / number.
    object_na: n sin(theta) of the marginal ray from the axial object point.
    m: the matrix from in front of the first surface to the stop, if known.
    """
    m = matrix(system, 1, system.stop, bend_last=False) if m is None else m
    size = jnp.asarray(system.stop_size)
    match system.aperture_kind:
        case "stop_semi_diameter":
            return jnp.where(m.a < 0, -size, size)
        case "image_f_number":
            return m.a * jnp.abs(first_order(system).focal_length) / size / 2
        case "object_na":
            assert system.object_distance is not None
            slope = marginal_slope(system)
            return m.a * slope * system.object_distance + m.b * slope * system.index[0]
        case _:
            return m.a * size / 2


def marginal_slope(system: System) -> jax.Array:
    """tan(theta) of the marginal ray in the object space for an aperture given as object_na."""
    sine = system.stop_size / system.index[0]
    return sine / jnp.sqrt(1 - sine * sine)


def magnification(system: System) -> jax.Array:
    """Paraxial lateral magnification of a finite object, N u / (N' u') of the axial ray; inf if the image is
    at infinity. The system at one wavelength, its object at a finite distance."""
    assert system.object_distance is not None
    return 1 / image_slope(system)


def angular_magnification(system: System) -> jax.Array:
    """u'/u of an afocal system, from the geometric slopes of a ray before and behind it: N d / N'; nan for a system
    with power, where it depends on the height of the ray. The system at one wavelength."""
    m = whole_matrix(system)
    index = signed_index(system)
    return jnp.where(is_afocal(m), index[0] * m.d / index[-1], jnp.nan)


def image_slope(system: System, m: Matrix | None = None) -> jax.Array:
    """w' behind the last surface of the axial ray that leaves a finite object with w = 1, or of the ray that
    enters parallel to the axis at y = 1; 0 where the image is at infinity. m: `whole_matrix`, if known."""
    m = whole_matrix(system) if m is None else m
    if system.object_distance is None:
        return jnp.where(is_afocal(m), 0.0, m.c)
    y = system.object_distance / signed_index(system)[0]
    slope = m.c * y + m.d
    noise = jnp.finfo(slope.dtype).eps * (jnp.abs(m.c * y) + jnp.abs(m.d))
    return jnp.where(jnp.abs(slope) <= AFOCAL * noise, 0.0, slope)


def image_distance(system: System, object_position: jax.Array) -> jax.Array:
    """Where the paraxial image of an axial point lies, mm from the last vertex that bends.

    object_position: mm along +z from the first vertex; any shape. The ray is traced from the point itself,
    not found through the cardinal points.
    """
    m = whole_matrix(system)
    index = signed_index(system)
    y, w = -object_position / index[0], 1.0
    return -safe_divide((m.a * y + m.b * w) * index[-1], m.c * y + m.d * w)
