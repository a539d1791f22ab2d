"""Colour: how focus and image height change with wavelength, and how the focus on the axis changes over the pupil."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.field_line import (
    Arrival,
    Beside,
    FieldLine,
    Rays,
    beside,
    check_points,
    chief_and_beside,
    chief_places,
    crossing,
    field_line,
    shares_of,
    small_fields,
)
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree
from lenstrace.optics.rays import has_course
from lenstrace.optics.vectors import safe_divide, safe_sqrt
from lenstrace.sequential import paraxial
from lenstrace.sequential.build import light_of
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import Light, System


@pytree
class AxialColour:
    """Paraxial foci of the W wavelengths of a lens, and of M from the shortest to the longest; mm along z.

    focus:        (W,), from the vertex of the image surface to the paraxial image of the axial point.
    shift:        (W,), focus minus that of the primary wavelength.
    curve_um:     (M,), micrometres.      curve_shift: (M,), focus there minus that of the primary wavelength.
    """

    focus: jax.Array
    shift: jax.Array
    curve_um: jax.Array
    curve_shift: jax.Array


@pytree
class LateralColour:
    """Chief rays of P fields from the axis to the largest one, and W wavelengths, minus those of the primary one; mm.

    field:      (P,), from the axis, in the unit of the lens's fields.    direction: (2,), toward the largest field.
    x, y:       (P, W), on the image surface, in its frame; nan where there is no chief ray.
    height:     (P, W), along the line on which a small field moves the image, positive away from the axis.
    """

    field: jax.Array
    direction: jax.Array
    x: jax.Array
    y: jax.Array
    height: jax.Array


@pytree
class LongitudinalAberration:
    """Where rays of the axial point cross its chief ray: spherical aberration and its change with colour.

    pupil:  (H,), 0 ... 1, heights in the pupil toward +y.
    z:      (H, W), mm along z of the image's frame, from the vertex of the image surface; at height 0 the limit, the
            paraxial focus. nan for a ray that does not arrive.
    """

    pupil: jax.Array
    z: jax.Array


def axial_colour(lens: Lens, *, points: int = 101) -> AxialColour:
    """Paraxial focus against wavelength. points: of the curve; one if the lens has one wavelength.

    ImageError where the image is at infinity; WavelengthError where a glass is not known between its wavelengths.
    """
    system, _ = with_image(lens, "axial colour")
    check_points(points)
    um = lens.wavelengths.um
    shortest, longest = min(um), max(um)
    curve = np.linspace(shortest, longest, points if longest > shortest else 1)
    inside = [min(max(float(each), shortest), longest) for each in curve]
    return _axial(system, curve.astype(system.index.dtype), light_of(lens, inside))


def lateral_colour(lens: Lens, *, points: int = 21) -> LateralColour:
    """Chief-ray heights of each wavelength against those of the primary one.

    points: fields from 0 to the largest, evenly spaced; one if the lens has the field 0 alone.
    ImageError where the image is at infinity. Without ray aiming the chief rays of all wavelengths enter alike.
    """
    system, front = with_image(lens, "lateral colour")
    line = field_line(system, shares_of(lens, points))
    chief, along, _ = chief_and_beside(line)
    found = beside(front, system.light, chief, along)
    near = beside(front, system.light, *small_fields(line.direction, line.x))
    return _lateral(system, line, (found, near), lens.fields.scale)


def longitudinal_aberration(lens: Lens, *, points: int = 21) -> LongitudinalAberration:
    """Axial crossings of real rays against pupil height. points: heights from 0 to 1, evenly spaced.

    ImageError where the image is at infinity.
    """
    system, front = with_image(lens, "longitudinal aberration")
    check_points(points)
    heights = np.linspace(0, 1, points).astype(system.curvature.dtype)
    zero = np.zeros_like(heights)
    found = beside(front, system.light, Rays(zero, zero, zero, heights), Rays(zero, zero, zero, zero + 1))
    return _longitudinal(heights, found)


def paraxial_focus(system: System) -> jax.Array:
    """The paraxial image of the axial object point, mm from the vertex of the image surface; the system at one
    wavelength. inf where it is at infinity."""
    m, index = paraxial.matrix(system, 1, system.surfaces), paraxial.signed_index(system)
    if system.object_distance is None:
        y, w = m.a, m.c
    else:
        start = system.object_distance / index[0]
        y, w = m.a * start + m.b, m.c * start + m.d
    return jnp.where(w == 0, jnp.inf, -safe_divide(y * index[-1], w) - system.thickness[-1])


@compiled
def _axial(system: System, curve_um: Any, curve_light: Light) -> AxialColour:
    def foci(light: Light) -> jax.Array:
        return jax.vmap(lambda each: paraxial_focus(system.with_light(each)))(jax.tree.map(jnp.asarray, light))

    focus = foci(system.light)
    primary = focus[system.primary]
    return AxialColour(focus, focus - primary, jnp.asarray(curve_um), foci(curve_light) - primary)


@compiled
def _lateral(system: System, line: FieldLine, rays: tuple[Beside, Beside], scale: jax.Array | float) -> LateralColour:
    found, near = rays
    x, y = ((a - a[system.primary]).T for a in chief_places(found))
    along_x, along_y = (a[system.primary, 0] for a in (near.change.x, near.change.y))
    length = safe_sqrt(along_x * along_x + along_y * along_y)
    return LateralColour(line.height / scale, line.direction, x, y, (x * along_x + y * along_y) / length)


@compiled
def _longitudinal(heights: Any, found: Beside) -> LongitudinalAberration:
    # the chief ray goes first; at it the difference is 0 / 0, and the derivatives give the limit
    chief = jnp.asarray(heights) == 0
    offset = Arrival(*(jnp.where(chief, d, a - a[:, :1]) for a, d in zip(found.ray, found.change, strict=True)))
    sound = has_course(found.failure[:, :1]) & (chief | (found.failure == 0))
    return LongitudinalAberration(jnp.asarray(heights), jnp.where(sound, crossing(offset), jnp.nan).T)
