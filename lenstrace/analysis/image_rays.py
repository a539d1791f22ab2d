"""Rays of every field and wavelength where they meet the image, and how far the light has come on them."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.arrivals import Asked, arrivals, for_each_field
from lenstrace.analysis.conditions import conditions_of, with_pupil
from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.errors import LostRaysError
from lenstrace.optics.rays import Ray, has_course, split_failure
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System


@pytree
class ImageRays:
    """The rays of F fields and W wavelengths at the image surface of a lens.

    rays:      `Ray` (W, F, 1 + N) in the frame of the image surface, mm, of each field the chief ray first (through the
               centre of the pupil), then N others. opl (mm) counts from one wavefront of the object's light, and is the
               excess over the path along the axis.
    pupil_x, pupil_y:  the points of the pupil of the N others, (F, N) or (W, F, N).
    pupil_z:   of the exit pupil from the vertex of the image surface, paraxial at the primary wavelength; inf at
               infinity.
    index:     (W,), of the medium at the image.       um: (W,), wavelengths, micrometres.
    weights:   (W,), of the wavelengths.
    primary:   the place of the primary wavelength.
    sense:     +1 or -1, of the light along z at the image.
    afocal:    True where light leaves the lens parallel.
    """

    rays: Ray
    pupil_x: jax.Array | np.ndarray
    pupil_y: jax.Array | np.ndarray
    pupil_z: jax.Array
    index: jax.Array
    um: jax.Array | np.ndarray
    weights: jax.Array
    afocal: jax.Array
    primary: int = static()
    sense: int = static()


def image_rays(lens: Lens, pupil_x: Any, pupil_y: Any, *, axial: bool = False) -> ImageRays:
    """The rays of every field and wavelength of a lens through points of its pupil, (N,), (F, N) or (W, F, N).

    axial: True: their paths are whole, with the path along the axis; differences of them lose digits to it.
    LostRaysError where the chief ray of a field has no course: there is nothing to measure the others from.
    """
    system, front = with_pupil(lens)
    asked = Asked(front, system.light, _all, path=True, axial=axial)
    rays = arrivals(asked, system.fields, pupil_x, pupil_y)
    if not is_traced(rays):
        _check_chief(lens, np.asarray(rays.failure)[..., 0])
    conditions = conditions_of(lens)
    x, y = for_each_field(len(system.fields), system.curvature.dtype, pupil_x, pupil_y)
    return ImageRays(
        rays,
        x,
        y,
        conditions.exit_position,
        system.index[:, -1],
        np.asarray(lens.wavelengths.um, system.curvature.dtype),
        system.weights,
        conditions.image_far,
        primary=system.primary,
        sense=system.orientation[-1],
    )


def check_light(light: Any) -> None:
    """LostRaysError where no ray of any field arrives; light: an array of any shape, above 0 where light is."""
    if is_traced(light) or (np.asarray(light) > 0).any():
        return
    raise LostRaysError(
        "all rays of all fields are lost before the image; check the apertures and semi-diameters, or reduce the field "
        "or the pupil (`lenstrace spots` says where they are lost)"
    )


def _all(_: System, rays: Ray) -> Ray:
    return rays


def _check_chief(lens: Lens, failure: np.ndarray) -> None:
    """LostRaysError for the first chief ray without a course."""
    lost = np.argwhere(~np.asarray(has_course(jnp.asarray(failure))))
    if not len(lost):
        return
    wave, field = map(int, lost[0])
    surface, status = split_failure(int(failure[wave, field]))
    place = f"({float(lens.fields.x[field]):g}, {float(lens.fields.y[field]):g}) {lens.fields.unit}"
    raise LostRaysError(
        f"field {place} at {lens.wavelengths.um[wave]:g} um: the chief ray is lost ({status.text} at surface "
        f"{surface}), and other rays are measured from it; reduce the field"
    )
