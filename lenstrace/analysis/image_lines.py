"""Rays at the image as straight lines: where they meet the image surface, and where they would if it were shifted."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np

from lenstrace.analysis.arrivals import Asked, arrivals
from lenstrace.analysis.spot_figures import Spots, spots_of
from lenstrace.compute.pytree import pytree
from lenstrace.optics.rays import Ray
from lenstrace.optics.vectors import dot, safe_divide
from lenstrace.sequential.launch import Front
from lenstrace.sequential.normals import surface_normal
from lenstrace.sequential.sampling import PupilPoints
from lenstrace.sequential.system import Light, System


@pytree
class ImageLines:
    """The rays of F fields and W wavelengths at the image, (W, F, 1 + N): of each field the chief ray, then N others.

    x, y:     mm, where a ray meets the image surface.
    u, v:     mm a mm, how x and y change as the surface is shifted along its +z. On a plane these are the slopes dx/dz
              and dy/dz, and x + s u, y + s v is exact for every shift s; a curved surface counts as its tangent plane
              where the ray meets it.
    failure:  see `Ray.failure`.
    weight:   (N,), of the points of the pupil.
    """

    x: jax.Array
    y: jax.Array
    u: jax.Array
    v: jax.Array
    failure: jax.Array
    weight: jax.Array | np.ndarray


def image_lines(front: Front, light: Light, fields: Any, pupil: PupilPoints) -> ImageLines:
    """The rays of a lens through points of its pupil.

    front:    of the lens.                     light: of each wavelength.
    fields:   (F, 2), as `System.fields`.      pupil:   its points.
    """
    lines = arrivals(Asked(front, light, _line), fields, pupil.x, pupil.y)
    return ImageLines(*lines, weight=pupil.weight.astype(front.system.curvature.dtype))


def spots_at(lines: ImageLines, shift: Any, weights: Any, primary: Any) -> Spots:
    """The spots where the image surface is shifted by so many mm; weights (W,)."""
    x, y = (a + shift * slope for a, slope in ((lines.x, lines.u), (lines.y, lines.v)))
    return spots_of((x, y, lines.failure), lines.weight, weights, primary)


def _line(system: System, ray: Ray) -> tuple[jax.Array, ...]:
    """x, y, u, v and failure of `ImageLines`."""
    normal = surface_normal(system, len(system.kinds), (ray.x, ray.y, ray.z))
    # the ray reaches the tangent plane, shifted by s, after t = s N_z / (N . d)
    rate = safe_divide(normal[2], dot(normal, (ray.l, ray.m, ray.n)))
    return ray.x, ray.y, ray.l * rate, ray.m * rate, ray.failure
