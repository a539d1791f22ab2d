"""The modulation transfer function: the contrast that is left of fine lines, with diffraction and by rays alone.

The transfer function is the autocorrelation of the pupil function. For lines across y (tangential, for a field in y)
only
shifts along y count: one transform along each column of the pupil, squared, added up and transformed back.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.huygens import wave
from lenstrace.analysis.image_rays import ImageRays, check_light, image_rays
from lenstrace.analysis.notes import transform_notes, trusted, warned
from lenstrace.analysis.path_difference import Sphere, differences
from lenstrace.analysis.pupil_function import PupilFunction, pupil_function
from lenstrace.analysis.pupil_grid import cell_coverage, grid_points
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree, static
from lenstrace.errors import RayError
from lenstrace.sequential.lens import Lens

QUESTION = "a modulation transfer function"
# Cells across the pupil whose rays make the geometrical transfer function.
GEOMETRIC_SAMPLES = 49
# Below this part of the whole, overlapping pupils are not corrected for their edges any more.
LEAST_OVERLAP = 1e-3
INSTEAD = "no contrast is given; the contrast by rays alone (--geometric), or psf with the method huygens, answers"


@pytree
class Mtf:
    """The contrast of K spatial frequencies at the image of F fields.

    frequency:             (K,), cycles/mm.
    tangential, sagittal:  (F, K), of all wavelengths by weight: contrast of lines across y, and across x (for a field
                           in y).
    each_tangential, each_sagittal:  (F, W, K), of each wavelength.
    limit_tangential, limit_sagittal:  (F, K), of all wavelengths, without any aberration.
    notes: what limits the accuracy, for a reader: too few samples, a distorted pupil, rounding.
    All is nan of a field without light, and of one whose pupil is too distorted for a transform: no figure is better
    than a wrong one.
    """

    frequency: jax.Array
    tangential: jax.Array
    sagittal: jax.Array
    each_tangential: jax.Array
    each_sagittal: jax.Array
    limit_tangential: jax.Array
    limit_sagittal: jax.Array
    notes: tuple[str, ...] = static(default=())


@pytree
class GeometricMtf:
    """The contrast by rays alone, as if the wavelength were 0. frequency: (K,), cycles/mm; tangential, sagittal: (F,
    K), of all wavelengths by weight."""

    frequency: jax.Array
    tangential: jax.Array
    sagittal: jax.Array


@pytree
class ThroughFocusMtf:
    """The contrast of one spatial frequency as the image plane moves.

    shift:  (P,), mm along z of the image surface's frame.      frequency: (), cycles/mm.
    tangential, sagittal:  (F, P), of all wavelengths by weight; nan, and notes, as of `Mtf`.
    """

    shift: jax.Array
    frequency: jax.Array
    tangential: jax.Array
    sagittal: jax.Array
    notes: tuple[str, ...] = static(default=())


def mtf(lens: Lens, frequency: Any = None, *, samples: int | None = None) -> Mtf:
    """The modulation transfer function of every field and wavelength of a lens, from the exact wavefronts.

    frequency: (K,), cycles/mm, not negative (RayError); by default about as many as samples, from 0 to where the
               contrast of a perfect lens ends.
    samples:   n across the pupil, even; by default as many as the aberrations need, see `pupil_function`.
    ImageError where the image is at infinity, LostRaysError where all rays are lost. AccuracyWarning with each of the
    notes: for fields that are nan, `geometric_mtf`, or `psf` by the method huygens, answer.
    """
    _check(frequency)
    pupil = pupil_function(lens, QUESTION, samples)
    check_light(pupil.energy)
    found = _mtf(pupil, None if frequency is None else _frequencies(frequency))
    return dataclasses.replace(found, notes=warned(transform_notes(lens, pupil, what=INSTEAD)))


def geometric_mtf(lens: Lens, frequency: Any, *, samples: int = GEOMETRIC_SAMPLES) -> GeometricMtf:
    """The transfer function of the spot: |mean of exp(2 pi i frequency . place)| over the rays of all wavelengths.

    What the diffraction MTF tends to as aberrations grow. frequency: (K,), cycles/mm. samples: across the pupil.
    """
    _check(frequency)
    with_image(lens, QUESTION)
    x, y, share = grid_points(samples)
    arrived = image_rays(lens, x, y)
    check_light(arrived.rays.failure[..., 1:] == 0)
    return _geometric(arrived, share, _frequencies(frequency))


def mtf_through_focus(lens: Lens, frequency: float, shift: Any, *, samples: int | None = None) -> ThroughFocusMtf:
    """The contrast at one frequency (cycles/mm) for image planes moved by `shift`, (P,), mm. Rays are traced once: a
    shift adds n' (n - n of the chief ray) times itself to their optical path."""
    _check(frequency)
    shift = jnp.atleast_1d(jnp.asarray(shift, float))
    pupil = pupil_function(lens, QUESTION, samples)
    check_light(pupil.energy)
    found = _through_focus(pupil, jnp.asarray(frequency, float), shift)
    return dataclasses.replace(found, notes=warned(transform_notes(lens, pupil, what=INSTEAD)))


def _frequencies(frequency: Any) -> jax.Array:
    return jnp.atleast_1d(jnp.asarray(frequency, float))


def _check(frequency: Any) -> None:
    if isinstance(frequency, jax.Array) or frequency is None:
        return
    values = np.asarray(frequency, float)
    if not values.size or not (np.isfinite(values) & (values >= 0)).all():
        raise RayError(f"spatial frequencies must be finite, not negative, in cycles/mm, got {frequency!r}")


@compiled
def _mtf(pupil: PupilFunction, frequency: jax.Array | None) -> Mtf:
    n = pupil.amplitude.shape[-1]
    if frequency is None:
        frequency = jnp.arange(n).astype(pupil.pixel.dtype) / (2 * n * pupil.pixel)
    frequency = frequency.astype(pupil.pixel.dtype)
    tangential, sagittal, limit_tangential, limit_sagittal = _transfers(pupil, pupil.opd, frequency)
    share = pupil.weights / jnp.sum(pupil.weights)

    def together(each: jax.Array) -> jax.Array:
        return jnp.abs(jnp.einsum("w,fwk->fk", share.astype(each.dtype), each))

    return Mtf(
        frequency,
        together(tangential),
        together(sagittal),
        jnp.abs(tangential),
        jnp.abs(sagittal),
        together(limit_tangential),
        together(limit_sagittal),
    )


@compiled
def _through_focus(pupil: PupilFunction, frequency: jax.Array, shift: jax.Array) -> ThroughFocusMtf:
    shift = shift.astype(pupil.pixel.dtype)
    share = pupil.weights / jnp.sum(pupil.weights)

    def at(shift: jax.Array) -> list[jax.Array]:
        both = _transfers(pupil, pupil.opd - shift * pupil.refocus, frequency[None].astype(shift.dtype))[:2]
        return [jnp.abs(jnp.einsum("w,fwk->f", share.astype(each.dtype), each)) for each in both]

    tangential, sagittal = lax.map(at, shift)
    return ThroughFocusMtf(shift, frequency, tangential.T, sagittal.T)


@compiled
def _geometric(arrived: ImageRays, cells: np.ndarray, frequency: jax.Array) -> GeometricMtf:
    found = differences(arrived, Sphere("primary"))
    alive = (found.failure == 0).astype(found.x.dtype)
    frequency = frequency.astype(found.x.dtype)
    weights = jnp.asarray(arrived.weights)[:, None] * alive * cells.astype(alive.dtype)
    total = jnp.sum(weights, (-2, -1))[:, None]

    def contrast(place: jax.Array) -> jax.Array:
        def at(frequency: jax.Array) -> jax.Array:
            total = wave(weights, -frequency * jnp.where(alive > 0, place, 0))
            return jnp.abs(jnp.sum(total, (-2, -1)))

        return lax.map(at, frequency).T / total

    return GeometricMtf(frequency, contrast(found.y), contrast(found.x))


def _transfers(pupil: PupilFunction, opd: jax.Array, frequency: jax.Array) -> tuple[jax.Array, ...]:
    """Transfer functions along y and along x, and those without aberration, (F, W, K), complex; the light of all =
    1."""
    amplitude = pupil.amplitude
    field = wave(amplitude, opd)
    n = amplitude.shape[-1]
    across = (jnp.arange(n) - n // 2).astype(amplitude.dtype)
    up, right = jnp.meshgrid(across, across, indexing="ij")
    x, y = (pupil.cell[..., 0, i, None, None] * right + pupil.cell[..., 1, i, None, None] * up for i in (0, 1))
    edges = [(edge[..., 0], edge[..., 1]) for edge in (pupil.cell[..., k, None, None, :] for k in (0, 1))]
    outline = cell_coverage(x, y, edges[0], edges[1])
    known_well = (trusted(pupil) & (pupil.energy > 0))[..., None]
    results = []
    for axis in (-2, -1):
        edge = pupil.cell[..., 0 if axis == -1 else 1, :]
        length = jnp.sqrt(jnp.sum(edge**2, -1))
        # cells at the edge in part: what that does to a circle is known, and is taken away
        steps = jnp.arange(n).astype(amplitude.dtype)
        circle = jnp.pi / jnp.abs(_determinant(pupil.cell))[..., None] * overlap(steps * length[..., None])
        found = _autocorrelation(outline, axis).real
        least = LEAST_OVERLAP * circle[..., :1]
        correction = (circle + least) / (found + least)
        place = frequency * (2 * n * pupil.pixel)
        known = overlap(steps * length[..., None])

        def edge_of(place: jax.Array, known: jax.Array = known, length: jax.Array = length) -> jax.Array:
            """What interpolation does where the circles part: known, and undone."""
            between = _interpolated(known, place)
            true = overlap(place * length[..., None])
            return jnp.where(between > 0, jnp.clip(true / jnp.where(between > 0, between, 1), 0, 2), 0)

        for function in (field, amplitude):
            found_here = _autocorrelation(function, axis)
            correlated = found_here * (correction / pupil.energy[..., None]).astype(found_here.dtype)
            exact = correlated.at[..., 0].set(1)
            contrast = _interpolated(exact, place) * edge_of(place).astype(exact.dtype)
            results.append(jnp.where(known_well, contrast, jnp.nan))
    tangential, limit_tangential, sagittal, limit_sagittal = results
    return tangential, sagittal, limit_tangential, limit_sagittal


def overlap(shift: jax.Array) -> jax.Array:
    """Area that two unit circles share, over pi: (2 / pi) (acos k - k sqrt(1 - k^2)), k = shift / 2. Goodman, eq.
    (6-32)."""
    k = jnp.clip(shift / 2, 0, 1)
    inside = k < 1
    root = jnp.sqrt(jnp.where(inside, 1 - k * k, 1))
    return jnp.where(inside, 2 / jnp.pi * (jnp.arctan2(root, k) - k * root), 0)


def _determinant(matrix: jax.Array) -> jax.Array:
    return matrix[..., 0, 0] * matrix[..., 1, 1] - matrix[..., 0, 1] * matrix[..., 1, 0]


def _autocorrelation(function: jax.Array, axis: int) -> jax.Array:
    """Sum of P(t + k) conj P(t) over the n x n points for k = 0 ... n - 1 along an axis, (F, W, n)."""
    n = function.shape[-1]
    spectrum = jnp.fft.fft(jnp.moveaxis(function, axis, -1), 2 * n, -1)
    return jnp.fft.ifft(jnp.sum(spectrum.real**2 + spectrum.imag**2, -2), axis=-1)[..., :n]


def _interpolated(values: jax.Array, place: jax.Array) -> jax.Array:
    """Values at 0 ... n - 1 along the last axis, at other places (K,): by the cubic through the four nearest; 0
    beyond."""
    n = values.shape[-1]
    start = jnp.clip(jnp.floor(place).astype(int) - 1, 0, n - 4)
    t = place - start.astype(place.dtype)
    result = jnp.zeros((*values.shape[:-1], *place.shape), values.dtype)
    for i in range(4):
        weight = jnp.ones_like(t)
        for j in range(4):
            if j != i:
                weight = weight * (t - j) / (i - j)
        result = result + weight.astype(values.dtype) * jnp.take(values, start + i, -1)
    return jnp.where(place <= n - 1, result, 0)
