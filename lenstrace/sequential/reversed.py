"""The same lens from the other side: what its light meets when it runs backward, as a lens of its own.

With s = +1 or -1 the sense of the light along z behind the last surface, and z' = -s z, the row j of S becomes the row
S + 1 - j: its curvature, and the terms of its asphere, are -s times what they were, the gaps s times; decentres stay,
tilts about x and y turn the other way where the axis does (s = 1). x and y stay as they are, so that a ray (x, y, z; l,
m, n) run backward is the ray (x, y, z'; -l, -m, s n) of the reversed lens.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import jax.numpy as jnp

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced
from lenstrace.errors import PrescriptionError
from lenstrace.sequential import paraxial
from lenstrace.sequential.document import Aperture, Fields
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rows import Row
from lenstrace.sequential.rules import check_lens
from lenstrace.sequential.system import System


def reversed_lens(lens: Lens) -> Lens:
    """The lens turned round, object and image changed for each other.

    The object stands where the image surface stood, and a plane image surface where the object was; for an object at
    infinity at the first vertex of the lens as given. The stop keeps its row, and is as wide (paraxially); each field
    is the paraxial image of what it was, an object height, and 0 where the image is at infinity. Glasses, apertures,
    screens, wavelengths stay with what they belong to. Light run backward through a screen gains the same path.

    PrescriptionError for a row with break = true, and for an image surface that does not stand behind the last row.
    """
    sense = lens.system.orientation[-1]
    rows = reversed_rows(lens.rows, _media(lens), sense)
    distance = sense * lens.rows[-1].thickness
    if not is_traced(distance) and distance <= 0:
        raise PrescriptionError(
            f"surface {len(lens)}: the image surface must stand behind the last row for the lens to be reversed, got "
            f"thickness {float(lens.rows[-1].thickness):g}; give the last row the thickness that reaches to the image"
        )
    to_object = 0.0 if lens.object_distance is None else sense * lens.object_distance
    radius, heights = _conjugates(lens.system.at(lens.system.primary), lens.system.fields)
    if not is_traced((radius, heights)):
        radius, heights = float(radius), heights.tolist()
    medium, glass = _media(lens)[-1]
    turned = dataclasses.replace(
        lens,
        rows=(*rows[:-1], rows[-1].replace(thickness=to_object)),
        image=Row(),
        aperture=Aperture(radius, "stop_semi_diameter"),
        fields=Fields(tuple(heights[0]), tuple(heights[1]), "object_height"),
        object_medium=medium,
        object_glass=glass,
        object_distance=distance,
        name=f"{lens.name}, reversed" if lens.name else "",
        published=(),
    )
    check_lens(turned)
    return turned


def reversed_rows(rows: tuple[Row, ...], media: list[tuple[Any, str | None]], sense: int) -> tuple[Row, ...]:
    """Rows in the order of light that runs backward; the last of them has thickness 0.

    media: medium and its written name in front of the first row, and behind each.     sense: s above.
    PrescriptionError for a row with break = true.
    """
    turned = []
    for i in reversed(range(len(rows))):
        row, (medium, glass) = rows[i], media[i]
        if row.is_break:
            raise PrescriptionError(
                f"surface {i + 1}: a row with break = true cannot be reversed; "
                "give the decentre and the tilt to the rows themselves, without break"
            )
        turned.append(
            dataclasses.replace(
                row,
                curvature=-sense * row.curvature,
                coefficients=tuple(-sense * a for a in row.coefficients),
                thickness=sense * rows[i - 1].thickness if i else 0.0,
                tilt=None if row.tilt is None else (-sense * row.tilt[0], -sense * row.tilt[1], row.tilt[2]),
                medium=medium,
                glass=glass,
            )
        )
    return tuple(turned)


def _media(lens: Lens) -> list[tuple[Any, str | None]]:
    """Medium and its written name in front of the first row, and behind each; a mirror keeps the one before."""
    media = [(lens.object_medium, lens.object_glass)]
    for row in lens.rows:
        media.append(media[-1] if row.mirror else (row.medium, row.glass))
    return media


@compiled
def _conjugates(system: System, fields: Any) -> tuple[Any, Any]:
    """Radius of the stop, mm, and x and y, (2, F), of the paraxial images of the fields, mm, 0 where those are at
    infinity; the system at one wavelength."""
    radius = jnp.abs(paraxial.stop_radius(system))
    heights = jnp.asarray(fields).T
    if system.field_kind == "image_height":
        return radius, heights
    if system.object_distance is None:
        scale, heights = -paraxial.first_order(system).object_focal_length, jnp.tan(heights)
    else:
        scale = paraxial.magnification(system)
        if system.field_kind == "angle":
            chief = jnp.asarray(system.object_distance) + paraxial.entrance_pupil(system).position
            heights = -chief * jnp.tan(heights)
    finite = jnp.isfinite(scale)
    return radius, jnp.where(finite, heights * jnp.where(finite, scale, 0), 0)
