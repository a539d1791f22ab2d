"""Focus: spots through focus, and where the image plane gives the smallest ones.

A shift moves the image surface by so many mm along its +z axis: it is added to the last thickness. Rays are traced
once; behind the lens they are straight lines, and no shift traces them again.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.image_lines import ImageLines, image_lines, spots_at
from lenstrace.analysis.spot_figures import Spots
from lenstrace.analysis.spots import check_arrivals
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import RayError
from lenstrace.optics.vectors import divide_where, root_or_zero, safe_divide
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import pupil_points
from lenstrace.sequential.system import System

# Half of the range that is taken where none is asked for, in units of the defocus that is just seen.
RANGE = 1.5
MM_PER_UM = 1e-3
STEPS, MOST_STEPS = 21, 1001


@pytree
class ThroughFocus:
    """The spots of F fields and W wavelengths at K places of the image surface.

    shifts:  (K,), mm.
    spots:   as `spots` gives them, every array with a leading axis of K.
    rms:     (K,), of all fields together: the root of the mean over the fields of the square of
             `spots.polychromatic.rms_centroid`, mm.
    """

    shifts: jax.Array
    spots: Spots
    rms: jax.Array

    def at(self, place: int) -> Spots:
        """The spots at one of the shifts, by its place."""
        return jax.tree.map(lambda a: a[place], self.spots)


@pytree
class Focus:
    """A place of the image surface. shift: (), mm. field_rms: (F,), RMS spot about the centroid, all wavelengths pooled
    by weight, mm. rms: (), of all fields together, of equal weight, mm."""

    shift: jax.Array
    field_rms: jax.Array
    rms: jax.Array


@pytree
class BestFocus:
    """Where the image surface may stand.

    given:        where the lens has it, shift 0.
    paraxial:     in the paraxial focus of the primary wavelength.
    spot:         where the RMS spot of all fields together is least.
    field_shift:  (F,), mm, where that of each field is least,       field_rms: (F,), mm, and how large it is there.
    nan where no ray of a field arrives.
    """

    given: Focus
    paraxial: Focus
    spot: Focus
    field_shift: jax.Array
    field_rms: jax.Array


def through_focus(
    lens: Lens,
    shifts: ArrayLike | None = None,
    *,
    steps: int = STEPS,
    pattern: str = "hexapolar",
    rings: int = 6,
) -> ThroughFocus:
    """The spots of a lens at several places of its image surface.

    shifts:          (K,), mm. By default `steps` of them, evenly from -h to h, where h is 1.5 times the larger of two
                     defocuses, rounded up to one digit: the depth of focus lambda / (4 n' A) = 2 lambda N^2 (A the mean
                     square slope of the rays about their mean; a cone of F-number N filled evenly has 1 / (8 N^2)), and
                     RMS spot / sqrt(A), which adds as much to the mean square spot as it has, and is never less
                     than the shift to the best focus.
    pattern, rings:  how the pupil is sampled, see `pupil_points`.
    LostRaysError where no ray of a field arrives, ImageError where the image is at infinity.
    """
    if shifts is None:
        check_steps(steps)
    system, lines = _traced(lens, pattern, rings)
    dtype = system.curvature.dtype
    if shifts is None:
        um = lens.wavelengths.um[system.primary]
        scale = np.linspace(-1, 1, steps).astype(dtype)
        shifts = _default_shifts(lines, system.weights, abs(system.index[system.primary, -1]) / um, scale)
    else:
        shifts = jnp.asarray(shifts, dtype)
        if shifts.ndim != 1 or not shifts.size:
            raise RayError(f"shifts must be a list of numbers, mm, got an array of shape {shifts.shape}")
        if not is_traced(shifts) and not np.isfinite(np.asarray(shifts)).all():
            raise RayError("shifts must be finite numbers, mm")
    result = _through(lines, shifts, system.weights, system.primary)
    if not is_traced(result):
        check_arrivals(lens, jax.device_get(result).at(0))
    return result


def check_steps(steps: Any) -> None:
    """RayError for fewer than two places through focus, or more than MOST_STEPS."""
    if isinstance(steps, bool) or not isinstance(steps, int | np.integer) or not 2 <= steps <= MOST_STEPS:
        raise RayError(f"steps through focus must be a whole number from 2 to {MOST_STEPS}, got {steps!r}")


def best_focus(lens: Lens, *, pattern: str = "hexapolar", rings: int = 6) -> BestFocus:
    """Where the image surface of a lens stands best.

    The mean square of x + s u, y + s v about their means is A s^2 + 2 B s + C, A = <du^2 + dv^2>, B = <dx du + dy dv>:
    least at s = -B / A, of all fields together at - sum B / sum A. Exact where the image surface is a plane.
    pattern, rings: see `pupil_points`. LostRaysError and ImageError as for `spots`.
    """
    system, lines = _traced(lens, pattern, rings)
    result, spots = _best(lines, system.weights, system.primary, system.at(system.primary))
    if not is_traced(result):
        check_arrivals(lens, spots)
    return result


def _traced(lens: Lens, pattern: str, rings: int) -> tuple[System, ImageLines]:
    system, front = with_image(lens, "a focus")
    return system, image_lines(front, system.light, system.fields, pupil_points(pattern, rings))


@compiled
def _through(lines: ImageLines, shifts: jax.Array, weights: Any, primary: Any) -> ThroughFocus:
    spots = jax.vmap(lambda shift: spots_at(lines, shift, weights, primary))(shifts)
    square = jnp.mean(spots.polychromatic.rms_centroid**2, -1)
    return ThroughFocus(shifts, spots, root_or_zero(square))


@compiled
def _default_shifts(lines: ImageLines, weights: Any, waves_per_um: Any, scale: Any) -> jax.Array:
    """waves_per_um: n' / lambda, 1/um; scale: (K,), -1 ... 1."""
    places, slopes, rays, _ = _deviations(lines, weights)
    spot, slope = (jnp.sum(rays * _square(*each)) / lines.x.shape[1] for each in (places, slopes))
    depth = safe_divide(jnp.asarray(MM_PER_UM, slope.dtype), 4 * waves_per_um * slope)
    half = RANGE * jnp.maximum(depth, root_or_zero(safe_divide(spot, slope)))
    digit = 10.0 ** jnp.floor(jnp.log10(jnp.where(half > 0, half, 1)))
    # a little less than the digit above stays below it
    return scale * jnp.ceil(half / digit * (1 - 1e-6)) * digit


@compiled
def _best(lines: ImageLines, weights: Any, primary: Any, system: System) -> tuple[BestFocus, Spots]:
    """system: at the primary wavelength."""
    places, slopes, rays, none = _deviations(lines, weights)
    (dx, dy), (du, dv) = places, slopes
    a, b = jnp.sum(rays * _square(du, dv), -1), jnp.sum(rays * (dx * du + dy * dv), -1)

    def least(a: jax.Array, b: jax.Array) -> jax.Array:
        return divide_where(a > 0, -b, a) + jnp.where(a > 0, 0, jnp.nan).astype(a.dtype)

    def mean_square(shift: jax.Array) -> jax.Array:
        moved = [d + jnp.reshape(shift, (-1, 1)) * slope for d, slope in ((dx, du), (dy, dv))]
        return jnp.sum(rays * _square(*moved), -1) + none

    def focus(shift: jax.Array) -> Focus:
        square = mean_square(shift)
        return Focus(shift, root_or_zero(square), root_or_zero(jnp.mean(square)))

    shifts = least(a, b) + none
    result = BestFocus(
        given=focus(jnp.zeros((), a.dtype)),
        paraxial=focus(_paraxial_shift(system)),
        spot=focus(least(jnp.sum(a), jnp.sum(b)) + jnp.sum(none)),
        field_shift=shifts,
        field_rms=root_or_zero(mean_square(shifts)),
    )
    return result, spots_at(lines, 0.0, weights, primary)


def _deviations(
    lines: ImageLines, weights: Any
) -> tuple[tuple[jax.Array, jax.Array], tuple[jax.Array, jax.Array], jax.Array, jax.Array]:
    """Places x, y and slopes u, v about their means over each field, (F, W N), without the chief rays; the weight of
    every ray (F, W N), 0 for a lost one, whose sum over each field is 1; and (F,) 0, nan for a field without rays."""

    def of_field(values: jax.Array) -> jax.Array:
        return jnp.swapaxes(values, 0, 1).reshape(values.shape[1], -1)

    alive = of_field(lines.failure[..., 1:]) == 0
    share = jnp.reshape(weights, (-1, 1, 1)) * lines.weight
    weight = jnp.where(alive, of_field(jnp.broadcast_to(share, lines.x[..., 1:].shape)), 0)
    total = jnp.sum(weight, -1)
    rays = weight / jnp.where(total > 0, total, 1)[:, None]

    def about_mean(values: jax.Array) -> jax.Array:
        values = jnp.where(alive, of_field(values[..., 1:]), 0)
        return values - jnp.sum(rays * values, -1, keepdims=True)

    x, y, u, v = map(about_mean, (lines.x, lines.y, lines.u, lines.v))
    return (x, y), (u, v), rays, jnp.where(total > 0, 0, jnp.nan).astype(total.dtype)


def _paraxial_shift(system: System) -> jax.Array:
    """From the vertex of the image surface to the paraxial image, mm along +z; the system at one wavelength."""
    behind = jnp.sum(jnp.where(paraxial.gaps_behind(system), system.thickness[:-1], 0)) + system.thickness[-1]
    if system.object_distance is None:
        return paraxial.first_order(system).rear_focal_point - behind
    return paraxial.image_distance(system, -jnp.asarray(system.object_distance)) - behind


def _square(x: jax.Array, y: jax.Array) -> jax.Array:
    return x * x + y * y
