"""What paraxial optics and third-order theory say of spots, wavefronts and chief rays, without tracing a ray.

A paraxial ray through the point p of the pupil meets the image at a p + b, a and b its marginal and its chief height.
Third order adds, with K = 1 / (N' u') and the Seidel sums of the field (see `Transverse`), the field along +y,

    ex = K/2 (S_I r^2 px + 2 S_II px py + (S_III + S_IV) px)
    ey = K/2 (S_I r^2 py + S_II (px^2 + 3 py^2) + (3 S_III + S_IV) py + S_V),

which is K times the gradient of the wave aberration. Tilts, decentres and a curved image surface do not count.
Source: Welford, Aberrations of Optical Systems (1986), sections 6.3 and 8.3.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.aberrations import seidel
from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.third_order import Seidel
from lenstrace.compute.compiled import compiled
from lenstrace.sequential import paraxial
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import pupil_points
from lenstrace.sequential.system import Light

# Rings of Gauss's rule: exact for the squares of third-order aberrations, of degree 6 (wavefronts: 8).
RINGS = 3


class Linear(NamedTuple):
    """Heights at the image of the paraxial marginal and chief ray at each wavelength, (W,), mm."""

    marginal: Any
    chief: Any


def predicted_spot(lens: Lens, *, third_order: bool) -> jax.Array:
    """RMS spot about the centroid of the one field of a lens, wavelengths pooled by weight, mm."""
    x, y, weight = _points(lens)
    marginal, chief = linear_rays(lens)
    ex, ey = _transverse(seidel(lens), x, y) if third_order else (0 * x, 0 * y)
    rays_x, rays_y = marginal[:, None] * x + ex, marginal[:, None] * y + chief[:, None] + ey
    share = jnp.asarray(lens.system.weights)[:, None] * weight
    share = share / share.sum()
    return jnp.sqrt((share * (rays_x**2 + (rays_y - (share * rays_y).sum()) ** 2)).sum())


def predicted_wavefront(lens: Lens, *, third_order: bool) -> jax.Array:
    """RMS of the path difference from the sphere about the chief ray's image point, primary wavelength, in waves."""
    x, y, weight = _points(lens)
    square = x * x + y * y
    sums = seidel(lens)
    # W = (1/K) times what a radial error a p adds up to
    wave = sums.image_index * sums.image_slope * linear_rays(lens).marginal[lens.system.primary] / 2 * square
    if third_order:
        s = sums.total
        wave = wave + s.spherical / 8 * square**2 + s.coma / 2 * y * square
        wave = wave + s.astigmatism / 2 * y * y + (s.astigmatism + s.petzval) / 4 * square
    share = weight / weight.sum()
    return jnp.sqrt(share @ (wave - share @ wave) ** 2) / sums.wavelength


def predicted_chief(lens: Lens, *, third_order: bool) -> jax.Array:
    """Height of the chief ray of the one field of a lens at the image, primary wavelength, mm along its field."""
    height = linear_rays(lens).chief[lens.system.primary]
    return height + seidel(lens).transverse().distortion if third_order else height


def linear_rays(lens: Lens) -> Linear:
    """The paraxial rays of the one field of a lens, brought to the y axis; no ray is aimed."""
    system, front = with_pupil(lens)
    field = jnp.asarray(system.fields[0])
    size = jnp.arctan(jnp.hypot(*jnp.tan(field))) if system.field_kind == "angle" else jnp.hypot(*field)
    front = front._replace(system=front.system.replace(ray_aiming=False))
    return _linear(front, system.light, size)


@compiled
def _linear(front: Front, light: Light, field: jax.Array) -> Linear:
    pupil = jnp.asarray([0, 1], front.system.curvature.dtype)

    def at(light: Light) -> Linear:
        system = front.system.with_light(light)
        ray = launch(front, light, (0 * pupil, field + 0 * pupil), (0 * pupil, pupil))
        slope = ray.m / ray.n
        reduced = paraxial.signed_index(system)
        height, w = ray.y - ray.z * slope, reduced[0] * slope
        m = paraxial.matrix(system, 1, system.surfaces)
        height, w = m.a * height + m.b * w, m.c * height + m.d * w
        image = height + system.thickness[-1] * w / reduced[-1]
        return Linear(image[1] - image[0], image[0])

    return jax.lax.map(at, jax.tree.map(jnp.asarray, light))


def _points(lens: Lens) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of the pupil and their weights, in the precision of the lens."""
    x, y, weight = (p.astype(lens.system.curvature.dtype) for p in pupil_points("gaussian", RINGS))
    return x, y, weight


def _transverse(sums: Seidel, x: np.ndarray, y: np.ndarray) -> tuple[Any, Any]:
    """ex and ey, mm."""
    s, half = sums.total, 0.5 / (sums.image_index * sums.image_slope)
    square = x * x + y * y
    ex = s.spherical * square * x + 2 * s.coma * x * y + (s.astigmatism + s.petzval) * x
    ey = s.spherical * square * y + s.coma * (x * x + 3 * y * y) + (3 * s.astigmatism + s.petzval) * y + s.distortion
    return half * ex, half * ey
