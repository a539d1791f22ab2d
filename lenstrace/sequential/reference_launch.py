"""The judge's own launching: field and pupil to a ray, through a y-u trace in mpmath; no ray aiming."""

from __future__ import annotations

from collections.abc import Sequence

from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference import GUARD_DIGITS
from lenstrace.sequential.reference_surface import Number, Vector, exact, indices_of, mp, unit, vector


def reference_launch(
    lens: Lens, field: Sequence[Number], pupil: Sequence[Number], digits: int = 50
) -> tuple[Vector, Vector]:
    """Point (mm, in the plane of the first vertex) and direction of the ray of a field (x, y; degrees or mm) and a
    point (x, y) of the paraxial entrance pupil of the primary wavelength. ValueError with ray aiming.
    """
    if lens.ray_aiming:
        raise ValueError("reference_launch knows no ray aiming; give the traced launch to reference_trace")
    with mp.workdps(digits + GUARD_DIGITS):
        (field_x, field_y), (pupil_x, pupil_y) = ([exact(v) for v in pair] for pair in (field, pupil))
        distance = mp.inf if lens.object_distance is None else mp.mpf(float(lens.object_distance))
        position, radius, slope, scale = _first_order(lens, distance)
        ahead = mp.one
        if lens.fields.kind == "angle":
            ahead = mp.sign(mp.cos(mp.radians(field_x)) * mp.cos(mp.radians(field_y)))
            field_x, field_y = mp.tan(mp.radians(field_x)), mp.tan(mp.radians(field_y))
        edge = vector(pupil_x, pupil_y, 0)
        if distance == mp.inf:
            direction = ahead * unit(vector(scale * field_x, scale * field_y, 1))
            start = radius * edge + vector(0, 0, position)
        else:
            start = vector(scale * field_x, scale * field_y, -distance)
            direction = slope * edge + vector(0, 0, 1)  # a pupil at infinity
            if position != mp.inf:
                direction = radius * edge + vector(0, 0, position) - start
            direction = unit(direction * mp.sign(direction[2]))
        return start - start[2] / direction[2] * direction, direction


def reference_focal_length(lens: Lens, wavelength_place: int | None = None, digits: int = 50) -> Number:
    """-y / u' of a paraxial ray that enters parallel to the axis, mm; inf where it leaves so."""
    with mp.workdps(digits + GUARD_DIGITS):
        slope = _paraxial(lens, indices_of(lens, wavelength_place), mp.one, mp.zero)[1][-1]
        return -1 / slope if slope else mp.inf


def _first_order(lens: Lens, distance: Number) -> tuple[Number, Number, Number, Number]:
    """Position and radius of the entrance pupil, tangent of the object's aperture, and what makes a field the
    tangent of an angle (object at infinity) or a height (at a finite distance)."""
    n, value = indices_of(lens, None), mp.mpf(float(lens.aperture.value))
    # heights and slopes at all surfaces of the rays from (y, u) = (1, 0) and (0, 1) at the first vertex
    (flat, flat_slope), (tilted, tilted_slope) = _paraxial(lens, n, 1, 0), _paraxial(lens, n, 0, 1)
    at_stop = flat[lens.stop - 1]
    position = tilted[lens.stop - 1] / at_stop if at_stop else mp.inf
    slope, radius = mp.zero, value / 2
    if lens.aperture.kind == "object_na":
        slope = mp.tan(mp.asin(value / n[0]))
        radius = slope * abs(distance + position)
    elif lens.aperture.kind == "image_f_number":
        radius = 1 / abs(flat_slope[-1]) / value / 2
    elif lens.aperture.kind == "stop_semi_diameter":
        radius = value / abs(at_stop)
    scale = mp.one
    if lens.fields.kind == "angle" and distance != mp.inf:
        scale = -(distance + position)
    elif lens.fields.kind == "image_height" and distance == mp.inf:
        scale = -flat_slope[-1]
    elif lens.fields.kind == "image_height":
        scale = n[-1] * (distance * flat_slope[-1] + tilted_slope[-1]) / n[0]
    return position, radius, slope, scale


def _paraxial(lens: Lens, n: list[Number], y: Number, u: Number) -> tuple[list[Number], list[Number]]:
    """Height at each surface and slope dy/dz behind it, of a ray with y and u at the first vertex."""
    heights, slopes = [], []
    for i, row in enumerate(lens.rows):
        c = mp.mpf(float(row.curvature)) + 2 * mp.mpf(float(row.asphere.get(2, 0.0)))
        u = -u - 2 * y * c if row.mirror else (n[i] * u - y * c * (n[i + 1] - n[i])) / n[i + 1]
        heights.append(y)
        slopes.append(u)
        y += mp.mpf(float(row.thickness)) * u
    return heights, slopes
