"""Rays at the image as straight lines: where they meet the image surface, and where they would if it were shifted."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.spots import Spots, statistics
from lenstrace.compute.blocks import each
from lenstrace.compute.pytree import pytree
from lenstrace.optics.rays import has_course
from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.vectors import Vector, dot, safe_divide
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace


@pytree
class ImageLines:
    """The rays of F fields and W wavelengths at the image, (W, F, 1 + N): of each field the chief ray, then N others.

    x, y:     mm, where a ray meets the image surface.
    u, v:     mm a mm, how x and y change as the surface is shifted along its +z. On a plane these are the slopes dx/dz
              and dy/dz, and x + s u, y + s v is exact for every shift s; a curved surface counts as its tangent plane
              where the ray meets it.
    failure:  see `Ray.failure`.
    """

    x: jax.Array
    y: jax.Array
    u: jax.Array
    v: jax.Array
    failure: jax.Array


def image_lines(front: Front, indices: Any, fields: Any, pupil: tuple[Any, Any]) -> ImageLines:
    """The rays of a lens through points of its pupil.

    front:    of the lens.                     indices: (W, S + 1), its index at each wavelength.
    fields:   (F, 2), as `System.fields`.      pupil:   x and y, each (N,), in units of the pupil's radius.
    """
    dtype = front.system.curvature.dtype
    xp = jnp if isinstance(fields, jax.Array) else np
    shape = len(fields), len(pupil[0]) + 1
    pupil_x, pupil_y = (np.broadcast_to(np.append(0.0, p), shape).astype(dtype) for p in pupil)
    field_x, field_y = (xp.broadcast_to(fields[:, i : i + 1], shape) for i in (0, 1))
    return each(_arriving, (front, indices), (field_x, field_y, pupil_x, pupil_y))


def spots_at(lines: ImageLines, shift: Any, weights: Any, primary: Any) -> Spots:
    """The spots where the image surface is shifted by so many mm; weights (W,)."""
    x, y = (jnp.swapaxes(a + shift * slope, 0, 1) for a, slope in ((lines.x, lines.u), (lines.y, lines.v)))
    failure = jnp.swapaxes(lines.failure, 0, 1)
    chief_x, chief_y = (jnp.where(has_course(failure[..., 0]), a[..., 0], jnp.nan) for a in (x, y))
    return statistics(x[..., 1:], y[..., 1:], failure[..., 1:], chief_x, chief_y, weights, primary)


def _arriving(lens: tuple[Front, jax.Array], points: tuple[jax.Array, ...]) -> ImageLines:
    (front, indices), (field_x, field_y, pupil_x, pupil_y) = lens, points

    def at(index: jax.Array) -> ImageLines:
        ray = trace(front.system.with_index(index), launch(front, index, (field_x, field_y), (pupil_x, pupil_y)))
        normal = _image_normal(front.system, ray.x, ray.y, ray.z)
        # the ray reaches the tangent plane, shifted by s, after t = s N_z / (N . d)
        rate = safe_divide(normal[2], dot(normal, (ray.l, ray.m, ray.n)))
        return ImageLines(ray.x, ray.y, ray.l * rate, ray.m * rate, ray.failure)

    return lax.map(at, jnp.asarray(indices))


def _image_normal(system: System, x: jax.Array, y: jax.Array, z: jax.Array) -> Vector:
    """Along the normal of the image surface at points on it."""
    curvature, conic, powers = system.curvature[-1], system.conic[-1], system.kinds[-1].powers
    if powers:
        return Asphere(curvature, conic, system.coefficients[-1], powers).normal(x, y)
    return Conic(curvature, conic).normal(x, y, z)
