"""Rays of every field and wavelength where they meet the image, and how far the light has come on them."""

from __future__ import annotations

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.conditions import conditions_of, with_pupil
from lenstrace.compute.blocks import each
from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.errors import LostRaysError
from lenstrace.optics.rays import Ray, has_course, split_failure
from lenstrace.sequential.launch import Front, launch, path_before
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.trace import trace


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


def image_rays(lens: Lens, pupil_x: Any, pupil_y: Any) -> ImageRays:
    """The rays of every field and wavelength of a lens through points of its pupil, (N,), (F, N) or (W, F, N).

    LostRaysError where the chief ray of a field has no course: there is nothing to measure the others from.
    """
    system, front = with_pupil(lens)
    dtype = system.curvature.dtype
    xp = jnp if any(isinstance(a, jax.Array) for a in (system.fields, pupil_x, pupil_y)) else np
    points = [xp.asarray(p).astype(dtype) for p in (pupil_x, pupil_y)]
    shape = len(lens.fields.y), points[0].shape[-1]
    points = [xp.broadcast_to(p, (*p.shape[:-2], *shape)) for p in points]
    first = [(0, 0)] * (points[0].ndim - 1) + [(1, 0)]
    sent = [xp.pad(p, first) for p in points]
    # one set of points for each wavelength, or one for all
    sent = [tuple(p) if p.ndim == 3 else (p,) for p in sent]
    fields = [xp.broadcast_to(system.fields[:, i : i + 1], sent[0][0].shape) for i in (0, 1)]
    rays = each(_arriving, (front, system.index), (*fields, *sent))
    if not is_traced(rays):
        _check_chief(lens, np.asarray(rays.failure)[..., 0])
    conditions = conditions_of(lens)
    return ImageRays(
        rays,
        points[0],
        points[1],
        conditions.exit_position,
        system.index[:, -1],
        np.asarray(lens.wavelengths.um, dtype),
        system.weights,
        conditions.image_far,
        primary=system.primary,
        sense=system.orientation[-1],
    )


def _arriving(lens: tuple[Front, jax.Array], points: tuple[Any, ...]) -> Ray:
    """The rays (W, N) at the image; lens: its front, and its index (W, S + 1); points: field x and y, and pupil x and y
    for each wavelength or once for all."""
    (front, indices), (field_x, field_y, pupil_x, pupil_y) = lens, points
    field = field_x, field_y

    def at(wave: tuple[jax.Array, jax.Array, jax.Array]) -> Ray:
        index, *pupil = wave
        start = launch(front, index, field, (pupil[0], pupil[1]))
        start = dataclasses.replace(start, opl=path_before(front, index, field, start))
        return trace(front.system.with_index(index), start, axial=False)

    shape = len(indices), *field_x.shape
    return lax.map(at, (jnp.asarray(indices), *(jnp.broadcast_to(jnp.stack(p), shape) for p in (pupil_x, pupil_y))))


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
