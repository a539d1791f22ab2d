"""Distortion: chief rays against the places where an image without it would have them."""

from __future__ import annotations

import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.field_line import (
    Beside,
    FieldLine,
    Pair,
    Rays,
    beside,
    chief_and_beside,
    chief_places,
    field_line,
    shares_of,
    small_fields,
)
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import ImageError, RayError
from lenstrace.optics.vectors import safe_divide, safe_sqrt
from lenstrace.sequential.launch import Front
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System

# Fields whose cosine is below this have no f tan(theta).
GRAZING = 1e-6
# Points on a side of a grid.
MOST_SIDE = 1001


@pytree
class Distortion:
    """Chief rays of P fields from the axis to the largest one, at the primary wavelength.

    field:              (P,), from the axis, in the unit of the lens's fields (degrees, or the file's length).
    direction:          (2,), unit vector in x and y toward the largest field.
    height:             (P,), mm, of the chief ray on the image surface, from that of field 0, along the line on which a
                        small field moves it (so that it is positive also in an image upside down).
    slope:              d height / d field at field 0, by the exact derivative of the trace, mm per radian or per mm.
    reference:          (P,), mm, the paraxial height on the image surface where it stands: slope tan(theta), or slope
                        times the field for heights. f' tan(theta) and m h only on an image surface in focus.
    percent:            (P,), 100 (height / reference - 1); 0 at field 0, nan from 90 degrees on.
    f_theta_reference:  (P,), mm: slope theta; nan for fields that are heights at a finite object.
    f_theta_percent:    (P,), 100 (height / f_theta_reference - 1).

    The slope is f' where the image surface stands in the paraxial focus and m where it is the paraxial image, and
    follows the image surface elsewhere: a lens out of focus has no distortion by that alone.
    """

    field: jax.Array
    direction: jax.Array
    height: jax.Array
    slope: jax.Array
    reference: jax.Array
    percent: jax.Array
    f_theta_reference: jax.Array
    f_theta_percent: jax.Array


@pytree
class DistortionGrid:
    """A square grid of N x N fields, at the primary wavelength; mm on the image surface, in its frame.

    field_x, field_y:  (N, N), in the unit of the lens's fields; y rises along the first axis, x along the second.
    x, y:              (N, N), chief rays; nan where there is none.
    ideal_x, ideal_y:  (N, N), where they would be without distortion: the derivative at field 0, a matrix, applied to
                       (tan ax, tan ay), or to the heights.
    """

    field_x: jax.Array
    field_y: jax.Array
    x: jax.Array
    y: jax.Array
    ideal_x: jax.Array
    ideal_y: jax.Array


def distortion(lens: Lens, *, points: int = 21) -> Distortion:
    """Distortion against field, percent, from the paraxial height, slope tan(theta) (slope h for heights), and from
    slope theta.

    points: fields from 0 to the largest, evenly spaced; one if the lens has the field 0 alone.
    ImageError where the image is at infinity.
    """
    system, front = with_image(lens, "distortion")
    line = field_line(system, shares_of(lens, points))
    chief, along, _ = chief_and_beside(line)
    # of all wavelengths, as the questions about colour have them: one program serves all
    found = beside(front, system.light, chief, along)
    near = beside(front, system.light, *small_fields(line.direction, line.x))
    return _distortion((front, system, line), found, near, lens.fields.scale)


def distortion_grid(lens: Lens, *, points: int = 11) -> DistortionGrid:
    """Chief rays of a square grid of fields whose corners lie as far from the axis as the largest field.

    points: on a side. Of angles the tangents are evenly spaced: the grid is drawn on a plane object.
    ImageError where the image is at infinity, or a field is at 90 degrees or more.
    """
    system, front = with_image(lens, "a distortion grid")
    limit = 0.0 if is_traced(lens.fields) else max(abs(float(a)) for a in (*lens.fields.x, *lens.fields.y))
    if lens.fields.kind == "angle" and limit >= 90:
        raise ImageError(
            f"a distortion grid needs a plane object, and no point of one is seen at {limit:g} degrees; "
            "give fields below 90, or ask for the distortion by f theta"
        )
    if isinstance(points, bool) or not isinstance(points, int | np.integer) or not 2 <= points <= MOST_SIDE:
        raise RayError(
            f"points must be a whole number of fields on a side, at least 2 and at most {MOST_SIDE}, got {points!r}"
        )
    line = field_line(system, np.ones(1, system.curvature.dtype))
    plane, chief, across = _square(system, line, np.linspace(-1, 1, points).astype(system.curvature.dtype))
    light = jax.tree.map(lambda a: a[None], system.light_at(system.primary))
    axes = (small_fields(axis, plane[0]) for axis in np.eye(2, dtype=system.curvature.dtype))
    near = [beside(front, light, *rays) for rays in axes]
    return _grid((plane, chief), beside(front, light, chief, across), near, lens.fields.scale)


@compiled
def _distortion(
    numbers: tuple[Front, System, FieldLine], found: Beside, near: Beside, scale: jax.Array | float
) -> Distortion:
    front, system, line = numbers
    move_x, move_y = (a[system.primary] for a in (near.change.x, near.change.y))
    square = move_x * move_x + move_y * move_y
    slopes = jnp.where(square > 0, safe_sqrt(square), 0)
    (x, y), (x_0, y_0) = ((a[system.primary] for a in chief_places(each)) for each in (found, near))
    height = safe_divide((x - x_0) * move_x + (y - y_0) * move_y, slopes)
    slope = slopes[0]
    match system.field_kind, system.object_distance:
        case "angle", _:
            flat = jnp.cos(line.height) > GRAZING
            reference = jnp.where(flat, slope * jnp.tan(jnp.where(flat, line.height, 0)), jnp.nan)
            even = slope * line.height
        case "image_height", None:
            reference = slope * line.height
            even = slope * front.scale * jnp.arctan(line.height / front.scale)
        case _:
            reference, even = slope * line.height, jnp.full_like(height, jnp.nan)
    return Distortion(
        field=line.height / scale,
        direction=line.direction,
        height=height,
        slope=slope,
        reference=reference,
        percent=100 * safe_divide(height - reference, reference),
        f_theta_reference=even,
        f_theta_percent=100 * safe_divide(height - even, even),
    )


@compiled
def _square(system: System, line: FieldLine, places: Any) -> tuple[Pair, Rays, Rays]:
    """x and y (N * N,) of a square grid on the object, heights or tangents; the chief rays of its points, and some
    neighbours of these."""
    angles = system.field_kind == "angle"
    half = (jnp.tan(line.height) if angles else line.height) / math.sqrt(2)
    y, x = (a.ravel() for a in jnp.meshgrid(half * places, half * places, indexing="ij"))
    fields, zero = ((jnp.arctan(x), jnp.arctan(y)) if angles else (x, y)), jnp.zeros_like(x)
    return (x, y), Rays(*fields, zero, zero), Rays(zero, zero, zero, zero + 1)


@compiled
def _grid(asked: tuple[Pair, Rays], found: Beside, near: list[Beside], scale: jax.Array | float) -> DistortionGrid:
    (plane_x, plane_y), rays = asked
    by_x, by_y = near
    side = math.isqrt(len(plane_x))
    ideal_x, ideal_y = (
        origin + a * plane_x + b * plane_y
        for origin, a, b in zip(
            chief_places(by_x), (by_x.change.x, by_x.change.y), (by_y.change.x, by_y.change.y), strict=True
        )
    )
    values = (rays.field_x / scale, rays.field_y / scale, *chief_places(found), ideal_x, ideal_y)
    return DistortionGrid(*(value.reshape(side, side) for value in values))
