"""Spot sizes as curves: against the height of the field, and against the wavelength."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.image_lines import ImageLines, image_lines, spots_at
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import RayError
from lenstrace.sequential.build import light_of
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import pupil_points

POINTS = 21


@pytree
class SpotField:
    """RMS spots about their centroids at P fields, W wavelengths; mm.

    x, y:           (P,), the fields, in the unit of the lens's fields, evenly from the axis to the farthest of them.
    rms:            (P, W).
    polychromatic:  (P,), all wavelengths pooled by weight.
    nan where no ray arrives.
    """

    x: jax.Array
    y: jax.Array
    rms: jax.Array
    polychromatic: jax.Array


@pytree
class SpotSpectrum:
    """RMS spots about their centroids of F fields at Q wavelengths.

    um:   (Q,), micrometres, evenly from the shortest to the longest wavelength of the lens.
    rms:  (F, Q), mm; nan where no ray arrives.
    """

    um: jax.Array
    rms: jax.Array


def spot_field(lens: Lens, *, points: int = POINTS, pattern: str = "hexapolar", rings: int = 6) -> SpotField:
    """The RMS spot against the height of the field.

    points: P; a lens whose only field is the axis has one. pattern, rings: see `pupil_points`.
    ImageError where the image is at infinity.
    """
    _check(points)
    system, front = with_image(lens, "a spot")
    fields = system.fields
    xp = np if isinstance(fields, np.ndarray) else jnp
    if not is_traced(fields) and not np.any(np.asarray(fields)):
        points = 1
    share = np.linspace(0, 1, points).astype(system.curvature.dtype)
    heights = share[:, None] * fields[xp.argmax(xp.sum(fields * fields, -1))]
    lines = image_lines(front, system.light, heights, pupil_points(pattern, rings))
    rms, polychromatic = _sizes(lines, system.weights)
    x, y = (jnp.asarray(each / lens.fields.scale) for each in heights.T)
    return SpotField(x, y, rms, polychromatic)


def spot_spectrum(lens: Lens, *, points: int = POINTS, pattern: str = "hexapolar", rings: int = 6) -> SpotSpectrum:
    """The RMS spot of every field against the wavelength; indices follow from the dispersion of the glasses.

    points: Q; a lens of one wavelength has one. pattern, rings: see `pupil_points`.
    ImageError where the image is at infinity, WavelengthError where a glass is not known between two wavelengths.
    """
    _check(points)
    system, front = with_image(lens, "a spot")
    waves = lens.wavelengths.um
    um = np.linspace(min(waves), max(waves), points if len(waves) > 1 else 1)
    dtype = system.curvature.dtype
    lines = image_lines(front, light_of(lens, um), system.fields, pupil_points(pattern, rings))
    return SpotSpectrum(jnp.asarray(um, dtype), _sizes(lines, np.ones(len(um), dtype))[0])


@compiled
def _sizes(lines: ImageLines, weights: Any) -> tuple[jax.Array, jax.Array]:
    spots = spots_at(lines, 0.0, weights, 0)
    return spots.rms_centroid, spots.polychromatic.rms_centroid


def _check(points: int) -> None:
    if not isinstance(points, int | np.integer) or points < 2:
        raise RayError(f"points of a curve must be a whole number from 2 on, got {points!r}")
