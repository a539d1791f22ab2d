"""Direct integration of diffraction: every ray a plane wave, summed at every image point.

    U(x, y) = sum over rays of sqrt(J) w exp(-2 pi i W / lambda) exp(2 pi i n' (l x + m y) / lambda),

w the area of the pupil that a ray stands for, J = d(n' l, n' m) / d(pupil), from rays close beside it. No grid of
directions is needed, so that no distortion of the pupil does harm; where |W| changes by a wavelength from one ray to
the next, more rays are needed.
"""

from __future__ import annotations

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.image_rays import ImageRays, image_rays
from lenstrace.analysis.path_difference import Sphere, differences
from lenstrace.analysis.pupil_grid import grid_points
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree
from lenstrace.sequential.lens import Lens

UM_PER_MM = 1000.0
# Rays whose phases at all image points are held in memory at a time.
BLOCK = 2048


@pytree
class PlaneWaves:
    """N rays of F fields and W wavelengths, as plane waves; all (F, W, N).

    amplitude: sqrt(J) w.     light: w where light is, the energy that a ray carries.     opd: wavelengths.
    l, m:      n' times the direction cosines, from the chief ray's.
    """

    amplitude: jax.Array
    light: jax.Array
    opd: jax.Array
    l: jax.Array
    m: jax.Array


def plane_waves(lens: Lens, samples: int) -> PlaneWaves:
    """The rays of a square grid of so many points across the pupil, less one."""
    x, y, share = grid_points(samples + 1)
    cells = share * (2 / samples) ** 2
    # the step, and rounding over the step, are both small
    step = float(jnp.finfo(lens.system.curvature.dtype).eps) ** 0.4
    beside_x, beside_y = np.array([[0, step, 0], [0, 0, step]])[..., None]
    return _plane_waves(image_rays(lens, (x + beside_x).ravel(), (y + beside_y).ravel()), cells, step)


def plane_wave_sum(waves: PlaneWaves, place: jax.Array, um: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Density of light (F, W, N, N), 1/mm^2, at image points, place (N,), mm, along x and along y; and the largest
    density without aberration, (F, W). The phase is a product, in x and in y, so that the sum is one of matrices."""
    per_mm = UM_PER_MM / um

    def of_one(waves: PlaneWaves, per_mm: jax.Array) -> tuple[jax.Array, jax.Array]:
        field = wave(waves.amplitude, -waves.opd)
        blocks = [jnp.pad(a, (0, -len(a) % BLOCK)).reshape(-1, BLOCK) for a in (field, waves.l, waves.m)]

        @jax.checkpoint
        def add(total: jax.Array, block: list[jax.Array]) -> tuple[jax.Array, None]:
            some, l, m = block
            along_x, along_y = (wave(1.0, per_mm * place[:, None] * t) for t in (l, m))
            return total + (along_y * some) @ along_x.T, None

        total, _ = lax.scan(add, jnp.zeros((len(place), len(place)), field.dtype), blocks)
        unit = per_mm**2 / jnp.sum(waves.light)
        return (total.real**2 + total.imag**2) * unit, jnp.sum(waves.amplitude) ** 2 * unit

    return lax.map(lambda waves: lax.map(lambda both: of_one(*both), (waves, per_mm)), waves)


def wave(amplitude: jax.Array | float, turns: jax.Array) -> jax.Array:
    """amplitude exp(2 pi i turns), of the precision of the turns."""
    phase = 2 * jnp.pi * turns
    return lax.complex(amplitude * jnp.cos(phase), amplitude * jnp.sin(phase))


@compiled
def _plane_waves(arrived: ImageRays, cells: jax.Array | np.ndarray, step: float) -> PlaneWaves:
    """arrived: the rays of all cells, then those beside them toward +x and +y of the pupil."""
    count = len(cells)
    index = jnp.asarray(arrived.index)[:, None]
    seen = [index * jnp.swapaxes(a[..., 1:] - a[..., :1], 0, 1) for a in (arrived.rays.l, arrived.rays.m)]
    (l, l_right, l_up), (m, m_right, m_up) = (jnp.split(a, 3, -1) for a in seen)
    area = jnp.abs((l_right - l) * (m_up - m) - (l_up - l) * (m_right - m)) / step**2
    rays = jax.tree.map(lambda a: a[..., : 1 + count], arrived.rays)
    found = differences(dataclasses.replace(arrived, rays=rays), Sphere("primary", far=True))
    light = jnp.where(found.failure == 0, cells, 0).astype(found.opd.dtype)
    lit = (light > 0) & (area > 0)
    return PlaneWaves(
        amplitude=jnp.where(lit, jnp.sqrt(jnp.where(lit, area, 1)), 0) * light,
        light=light,
        opd=jnp.where(lit, found.opd, 0),
        l=l,
        m=m,
    )
