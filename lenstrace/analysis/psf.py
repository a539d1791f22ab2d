"""The point spread function: how the light of a point spreads over the image by diffraction and aberration."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.huygens import plane_wave_sum, plane_waves, wave
from lenstrace.analysis.image_rays import check_light
from lenstrace.analysis.notes import rounding_notes, transform_notes, warned
from lenstrace.analysis.path_difference import residual
from lenstrace.analysis.pupil_function import PupilFunction, pupil_function
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.errors import RayError
from lenstrace.sequential.lens import Lens

METHODS = ("auto", "fft", "huygens")
# A transform stands for the sum of plane waves while rays miss their nodes by less than this part of the half width ...
MOST_DISTORTED = 1e-3
# What the path changes by from one cell to the next, wavelengths, where as many samples as needed are taken.
STEP = 0.25


@pytree
class Psf:
    """The point spread of F fields and W wavelengths, on N x N points about where the primary chief ray meets the
    image.

    position:       (N,), mm, along x and along y of the image surface's frame; the middle one, N // 2, is 0.
    density:        (F, W, N, N), 1/mm^2, the part of the light of a point that falls on a unit of area; rows run along
                    y.
    peak:           (F, W), the largest density a perfect lens with the same pupil would have.
    polychromatic:  (F, N, N), densities weighted by wavelength.
    polychromatic_peak:  (F,).
    strehl:         (F, W), density at the middle of the light, tilt removed, over `peak`.
    within:         (F, W), the part of the light that falls on the N x N points at all.
    method:         "fft", or "huygens": the direct sum of plane waves.    reason: why, for a reader.
    notes:          what limits the accuracy, for a reader: too few samples, a distorted pupil, rounding.
    Of a field without light all is nan.
    """

    position: jax.Array
    density: jax.Array
    peak: jax.Array
    polychromatic: jax.Array
    polychromatic_peak: jax.Array
    strehl: jax.Array
    within: jax.Array
    method: str = static()
    reason: str = static()
    notes: tuple[str, ...] = static(default=())


@pytree
class _Sums:
    density: jax.Array
    peak: jax.Array
    polychromatic: jax.Array
    polychromatic_peak: jax.Array
    strehl: jax.Array
    within: jax.Array
    position: jax.Array


def psf(lens: Lens, *, samples: int | None = None, method: str = "auto") -> Psf:
    """The point spread function of every field and wavelength of a lens.

    samples:  n across the pupil, even; the result has N = 2 n points a side. By default as many as the aberrations
              need, see `pupil_function`.
    method:   "fft", "huygens" (direct integration: every ray a plane wave, no grid of directions), or "auto": the
              transform, unless the pupil is so distorted or the path changes so fast that it would be wrong.
    ImageError where the image is at infinity, RayError for an unknown method, LostRaysError where all rays are lost.
    AccuracyWarning with each of the notes.
    """
    if method not in METHODS:
        raise RayError(f"unknown method {method!r}; one of {', '.join(METHODS)}")
    pupil = pupil_function(lens, "a point spread function", samples, STEP)
    chosen, reason = _choice(pupil) if method == "auto" else (method, "as asked")
    transform = chosen == "fft"
    check_light(pupil.energy)
    found = _by_transform(pupil) if transform else _by_waves(plane_waves(lens, pupil.amplitude.shape[-1]), pupil)
    return Psf(
        found.position,
        found.density,
        found.peak,
        found.polychromatic,
        found.polychromatic_peak,
        found.strehl,
        found.within,
        method=chosen,
        reason=reason,
        notes=warned(_notes(lens, pupil, transform)),
    )


def _notes(lens: Lens, pupil: PupilFunction, transform: bool) -> tuple[str, ...]:
    if transform:
        return transform_notes(lens, pupil, what="the point spread is wrong; take the method huygens")
    return rounding_notes(lens)


def _choice(pupil: PupilFunction) -> tuple[str, str]:
    """Method, and why."""
    if is_traced(pupil):
        return "fft", "nothing is known of numbers that are traced"
    distorted, step = (float(np.max(a)) for a in jax.device_get((pupil.distorted, pupil.step)))
    known = f"rays miss their nodes by {distorted:.1g} of the pupil, the path changes by {step:.2g} wavelengths a cell"
    if not distorted <= MOST_DISTORTED:
        return "huygens", f"{known}: too distorted for a transform"
    return "fft", known


@compiled
def _by_transform(pupil: PupilFunction) -> _Sums:
    n = pupil.amplitude.shape[-1]
    field = wave(pupil.amplitude, pupil.opd)
    padded = jnp.pad(field, ((0, 0), (0, 0), (0, n), (0, n)))
    spread = jnp.fft.fftshift(jnp.fft.fft2(padded), (-2, -1))
    # of all light, over the 2 n x 2 n points and their area: the theorem of Parseval
    unit = 1 / (pupil.energy * (2 * n * pupil.pixel) ** 2)
    density = (spread.real**2 + spread.imag**2) * unit[..., None, None]
    return _sums(pupil, density, jnp.sum(pupil.amplitude, (-2, -1)) ** 2 * unit)


@compiled
def _by_waves(waves: Any, pupil: PupilFunction) -> _Sums:
    n = pupil.amplitude.shape[-1]
    place = (jnp.arange(2 * n) - n).astype(pupil.pixel.dtype) * pupil.pixel
    density, peak = plane_wave_sum(waves, place, pupil.um)
    return _sums(pupil, density, peak)


def _sums(pupil: PupilFunction, density: jax.Array, peak: jax.Array) -> _Sums:
    n = pupil.amplitude.shape[-1]
    share = pupil.weights / jnp.sum(pupil.weights)
    return _Sums(
        density=density,
        peak=peak,
        polychromatic=jnp.einsum("w,fwyx->fyx", share, density),
        polychromatic_peak=peak @ share,
        strehl=_strehl(pupil),
        within=jnp.sum(density, (-2, -1)) * pupil.pixel**2,
        position=(jnp.arange(2 * n) - n).astype(pupil.pixel.dtype) * pupil.pixel,
    )


def _strehl(pupil: PupilFunction) -> jax.Array:
    """|mean of exp(2 pi i opd)|^2 over the pupil, tilt removed: where the light is densest, to a few parts in a
    thousand."""
    amplitude, opd = (a.reshape(*a.shape[:2], -1) for a in (pupil.amplitude, pupil.opd))
    n = pupil.amplitude.shape[-1]
    across = (jnp.arange(n) - n // 2).astype(opd.dtype) / n
    y, x = (jnp.broadcast_to(a.reshape(-1), opd.shape) for a in jnp.meshgrid(across, across, indexing="ij"))
    phase = 2 * jnp.pi * residual(opd, (x, y), amplitude)
    total = jnp.sum(amplitude, -1)
    real, imaginary = (jnp.sum(amplitude * f(phase), -1) / total for f in (jnp.cos, jnp.sin))
    return real * real + imaginary * imaginary
