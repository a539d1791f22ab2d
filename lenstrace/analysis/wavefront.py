"""The wavefront in the exit pupil: its map, how far it is from a sphere, and its Zernike coefficients."""

from __future__ import annotations

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.image_rays import ImageRays, check_light, image_rays
from lenstrace.analysis.notes import rounding_notes, warned
from lenstrace.analysis.path_difference import Sphere, check_reference, differences, residual
from lenstrace.analysis.pupil_grid import grid_points
from lenstrace.analysis.zernike import ZernikeFit, fit_zernike
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.zernike import zernike_index
from lenstrace.sequential.lens import Lens

SAMPLES = 65
# Points along the rim, which no cell has.
RIM = 64


@pytree
class Wavefront:
    """The wavefronts of F fields and W wavelengths over the pupil, all lengths in wavelengths.

    pupil_x, pupil_y:   (N,), in units of the pupil's radius: RIM points along the rim, then those of `grid_points`.
    opd:                (F, W, N), optical path difference from the reference sphere, > 0 where the wavefront is
                        ahead; nan where no ray arrives.
    share:              (F, W, N), the part of the cell about each point that light comes through; 0 on the rim.
    rms:                (F, W), sqrt of the variance over the pupil.
    rms_without_tilt, rms_without_focus:  what is left of it when tilt, and when tilt and focus, are taken away (least
                        squares by 1, x, y and x^2 + y^2 in pupil coordinates).
    peak_to_valley:     (F, W), largest less smallest opd.
    strehl_from_rms:    (F, W), exp(-(2 pi rms)^2), tilt removed: Marechal's estimate, in the form of Mahajan (1983).
    strehl:             (F, W), |mean of exp(2 pi i opd)|^2, tilt removed: the intensity at the image point against
                        that without aberration.
    samples:            of the grid, from edge to edge.
    notes:              what limits the accuracy of these figures, for a reader.
    """

    pupil_x: jax.Array
    pupil_y: jax.Array
    opd: jax.Array
    share: jax.Array
    rms: jax.Array
    rms_without_tilt: jax.Array
    rms_without_focus: jax.Array
    peak_to_valley: jax.Array
    strehl_from_rms: jax.Array
    strehl: jax.Array
    samples: int = static()
    notes: tuple[str, ...] = static(default=())


def wavefront(lens: Lens, *, samples: int = SAMPLES, reference: str = "chief") -> Wavefront:
    """The wavefront of every field and wavelength of a lens.

    samples:    of the grid across the pupil (RayError below 9).
    reference:  the centre of the sphere, see `Sphere`: "chief", "primary" or "best". Its radius reaches to the centre
                of the paraxial exit pupil; an afocal lens is compared with a plane.
    LostRaysError where a chief ray is lost, or all rays are. AccuracyWarning where rounding is seen.
    """
    check_reference(reference)
    x, y, share = grid_points(samples)
    turn = 2 * np.pi * np.arange(RIM) / RIM
    x, y = np.append(np.cos(turn), x), np.append(np.sin(turn), y)
    result = _wavefront(image_rays(lens, x, y), _Asked(Sphere(reference), samples), np.append(np.zeros(RIM), share))
    check_light(result.share)
    return dataclasses.replace(result, notes=warned(rounding_notes(lens)))


def zernike_coefficients(front: Wavefront, *, order: str = "fringe", count: int = 37) -> ZernikeFit:
    """Zernike coefficients of wavefronts by least squares, (F, W, count), and the RMS left over, (F, W), wavelengths.

    order: "fringe", "noll" or "ansi", see `zernike`; their coordinates are those of the pupil.
    """
    zernike_index(order, count)  # an unknown order, or no such term
    return _coefficients(_Terms(order, count), front)


@pytree
class _Asked:
    sphere: Sphere
    samples: int = static()


@pytree
class _Terms:
    order: str = static()
    count: int = static()


@compiled
def _coefficients(terms: _Terms, front: Wavefront) -> ZernikeFit:
    inside = jnp.isfinite(front.opd)
    opd, weights = jnp.where(inside, front.opd, 0), jnp.where(inside, front.share, 0)

    def of_one(opd: jax.Array, weights: jax.Array) -> ZernikeFit:
        return fit_zernike(terms.order, terms.count, front.pupil_x, front.pupil_y, opd, weights)

    return jax.vmap(jax.vmap(of_one))(opd, weights)


@compiled
def _wavefront(arrived: ImageRays, asked: _Asked, cells: np.ndarray) -> Wavefront:
    found = differences(arrived, asked.sphere, cells)
    share = jnp.where(found.failure == 0, cells, 0).astype(found.opd.dtype)
    x, y = jnp.asarray(arrived.pupil_x)[0], jnp.asarray(arrived.pupil_y)[0]
    inside = found.failure == 0

    def spread(values: jax.Array) -> jax.Array:
        total = jnp.sum(share, -1)
        square = jnp.sum(share * values * values, -1) / jnp.where(total > 0, total, 1)
        rms = jnp.sqrt(jnp.where(square > 0, square, 1))
        return jnp.where(total > 0, jnp.where(square > 0, rms, 0), jnp.nan)

    xs, ys, radii = (jnp.broadcast_to(a, found.opd.shape) for a in (x, y, x * x + y * y))
    level, flat = residual(found.opd, (), share), residual(found.opd, (xs, ys), share)
    rms = spread(flat)
    phase = 2 * jnp.pi * flat
    total = jnp.sum(share, -1)
    real, imaginary = (jnp.sum(share * f(phase), -1) / jnp.where(total > 0, total, jnp.nan) for f in (jnp.cos, jnp.sin))
    highest = jnp.max(jnp.where(inside, found.opd, -jnp.inf), -1)
    lowest = jnp.min(jnp.where(inside, found.opd, jnp.inf), -1)
    return Wavefront(
        pupil_x=x,
        pupil_y=y,
        opd=jnp.where(inside, found.opd, jnp.nan),
        share=share,
        rms=spread(level),
        rms_without_tilt=rms,
        rms_without_focus=spread(residual(found.opd, (xs, ys, radii), share)),
        peak_to_valley=jnp.where(jnp.any(inside, -1), highest - lowest, jnp.nan),
        strehl_from_rms=jnp.exp(-((2 * jnp.pi * rms) ** 2)),
        strehl=real * real + imaginary * imaginary,
        samples=asked.samples,
    )
