"""Spots as accurate as asked for: the fewest rays that do, and an estimate of the error that is left."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.accuracy.convergence import Answer, check_tolerance, converge
from lenstrace.analysis.arrivals import Asked, arrivals
from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.pupil_rules import TRIED, RulePair, open_pupil, right_half, whole_pupil
from lenstrace.analysis.spot_figures import SpotErrors, Spots, figures, place
from lenstrace.analysis.symmetry import has_apertures, is_mirrored
from lenstrace.compute.padding import padded, padded_count
from lenstrace.compute.pytree import is_traced
from lenstrace.errors import AccuracyError, LostRaysError
from lenstrace.sequential.launch import Front
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System

# Error of an RMS by rounding, in eps of the length of the lens.
ROUNDING = 0.25
# Numbers of rings: 4 r^2 and 8 r^2 points lie just below 64, 256, 1024, ..., see `padded`.
LADDER = (2, 3, 4, 5, 7, 10, 12, 15, 20, 24, 30, 40, 48, 60)
# Where apertures may cut the pupil no fewer: what lies between two spokes is not seen.
FEWEST_CUT = 5

# Rays of a spot: x, y, failure, (W, F, 1 + N), and the pair of rules for the N others.
Rays = tuple[tuple[np.ndarray, np.ndarray, np.ndarray], RulePair]


def accurate_spots(lens: Lens, tolerance: float, ladder: Sequence[int] = LADDER) -> Spots:
    """The spots of a lens with every RMS about a centroid within a relative error of the integral over the open pupil.

    Rays go to the two rules of `pupil_rules` with the rings of a ladder, more and more, until the rules agree; the
    figures are of both together. What apertures hide or open between two spokes, or within less than 1/256 of the
    radius, may be overlooked. Rounding, less than a quarter eps of the length of the lens, is part of the estimates.
    AccuracyError while JAX traces the lens, else as `spots`.
    """
    check_tolerance(tolerance)
    if is_traced(lens):
        raise AccuracyError(
            "a tolerance looks at numbers, and JAX is tracing those of the lens; find the rings outside, by "
            '`spots(lens, tolerance=...).error.rings`, and give pattern="gaussian", rings=... inside'
        )
    system, front = with_image(lens, "a spot")
    asked = _Ladder(lens, system, front, mirrored=is_mirrored(lens), cut=has_apertures(system))
    dtype = system.curvature.dtype
    floor = ROUNDING * float(np.finfo(dtype).eps) * float(np.abs(system.thickness).sum())
    steps = [rings for rings in ladder if rings >= FEWEST_CUT] if asked.cut else ladder
    found = converge(asked.answer, steps, tolerance, floor)
    arrived, pair = found.found
    weight = (pair.first + pair.second) * (pair.first.shape[-1] / 2)
    result = _figures(arrived, weight.astype(dtype), system)
    # a larger float32 is still an estimate, a smaller one might not be
    error = found.error if dtype == np.float64 else np.nextafter(found.error.astype(dtype), np.inf, dtype=dtype)
    fields, waves = len(system.fields), len(system.weights)
    share = np.broadcast_to((pair.first + pair.second).sum(-1).T / 2, (fields, waves))
    errors = SpotErrors(
        rms_centroid=jnp.asarray(error[: fields * waves].reshape(fields, waves)),
        polychromatic=jnp.asarray(error[fields * waves :]),
        open=jnp.asarray(share, dtype),
        tolerance=float(tolerance),
        reached=found.reached,
        rounded=found.rounded,
        rings=found.step,
    )
    return dataclasses.replace(result, error=errors)


@dataclasses.dataclass(frozen=True)
class _Ladder:
    """A lens, whether it is its own mirror image, and whether apertures may cut its pupil."""

    lens: Lens
    system: System
    front: Front
    mirrored: bool
    cut: bool

    def answer(self, rings: int) -> Answer[Rays]:
        """All RMS figures, of every field and wavelength, then of every field."""
        rays = None if self.cut else self._whole(rings)
        arrived, pair = rays or self._open(rings)
        value, difference = _compared(arrived, pair, np.asarray(self.system.weights, float))
        return Answer((arrived, pair), value, difference)

    def _whole(self, rings: int) -> Rays | None:
        """Through the whole pupil; None where a ray does not come through."""
        pair = right_half(whole_pupil(rings)) if self.mirrored else whole_pupil(rings)
        x, y, failure = self._sent(pair)
        if failure[..., 1:].any():
            return None
        if not self.mirrored:
            return (x, y, failure), pair
        x, y, failure = (np.concatenate([a, s * a[..., 1:]], -1) for a, s in ((x, -1), (y, 1), (failure, 1)))
        return (x, y, failure), RulePair(np.append(pair.x, -pair.x), *(np.append(a, a) for a in pair[1:]))

    def _open(self, rings: int) -> Rays:
        pair = open_pupil(self.front, self.system.light, self.system.fields, rings)
        closed = np.argwhere((pair.first + pair.second).sum(-1) == 0)
        if len(closed):
            wave, field = map(int, closed[0])
            fields = self.lens.fields
            raise LostRaysError(
                f"field ({float(fields.x[field]):g}, {float(fields.y[field]):g}) {fields.unit} at "
                f"{self.lens.wavelengths.um[wave]:g} um: no opening of the pupil was found (steps of 1/{TRIED} of its "
                "radius); check the apertures, or reduce the field or the pupil"
            )
        x, y, failure = self._sent(pair)
        alive = failure[..., 1:] == 0
        return (x, y, failure), RulePair(pair.x, pair.y, pair.first * alive, pair.second * alive)

    def _sent(self, pair: RulePair) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        count = pair.x.shape[-1]
        asked = Asked(self.front, self.system.light, place)
        sent = arrivals(asked, self.system.fields, *padded(pair.x, pair.y))
        x, y, failure = (a[..., : 1 + count] for a in jax.device_get(sent))
        return x, y, failure


def _figures(arrived: tuple[np.ndarray, np.ndarray, np.ndarray], weight: np.ndarray, system: System) -> Spots:
    """The figures of N rays; computed with copies of one of them that weigh nothing, for `padded` numbers of rays."""
    count = arrived[2].shape[-1] - 1
    size = padded_count(count)
    weight = np.broadcast_to(weight, (*arrived[2].shape[:2], count))
    copied = np.broadcast_to(1 + weight.argmax(-1)[..., None], (*weight.shape[:2], size - count))
    places = np.concatenate([np.broadcast_to(np.arange(1 + count), arrived[2].shape), copied], -1)
    x, y, failure = (np.take_along_axis(a, places, -1) for a in arrived)
    longer = np.pad(weight, [(0, 0), (0, 0), (0, size - count)])
    result = figures((x, y, failure), longer, system.weights, system.primary)
    rays = {name: getattr(result, name)[..., :count] for name in ("x", "y", "failure")}
    return dataclasses.replace(result, lost=jnp.sum(rays["failure"] != 0, -1), **rays)


def _compared(
    arrived: tuple[np.ndarray, np.ndarray, np.ndarray], pair: RulePair, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """RMS figures by both rules together, and how far these are apart: the pooled ones of all wavelengths come last.

    The variances along x and y are compared one by one, and of the wavelengths of a field the relative difference that
    is largest counts for all: two that vanish by chance do not do so together.
    """
    x, y = (np.asarray(a[..., 1:], float) for a in arrived[:2])
    by_rule = [_variances(x, y, rule, weights) for rule in (pair.first, pair.second, pair.first + pair.second)]
    # where one rule has met no opening they are not to be compared
    seen = np.logical_and(*(np.broadcast_to(rule.sum(-1) > 0, x.shape[:2]).T for rule in (pair.first, pair.second)))
    values, differences = [], []
    for first, second, both, known in zip(*by_rule, (seen, seen.all(1, keepdims=True)), strict=True):
        rms = np.sqrt(both.sum(0))
        apart = np.where(known, np.abs(first - second).sum(0), np.inf)
        # of a perfect spot the variances differ by rounding alone
        relative = np.divide(apart, 2 * rms * rms, out=np.zeros_like(rms), where=rms > 0).max(-1, keepdims=True)
        values.append(rms.ravel())
        differences.append((relative * rms).ravel())
    return np.concatenate(values), np.concatenate(differences)


def _variances(x: np.ndarray, y: np.ndarray, rule: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Along x and y: of each field and wavelength (2, F, W), and of each field, wavelengths pooled, (2, F, 1)."""
    total = np.asarray(rule.sum(-1))
    share = np.broadcast_to(rule, x.shape) / np.where(total > 0, total, 1)[..., None]
    places = np.stack([x, y])
    centres = (share * places).sum(-1)
    each = (share * (places - centres[..., None]) ** 2).sum(-1)
    # a field's rays weigh what their part of the pupil is
    part = weights[:, None] * np.broadcast_to(rule.sum(-1), x.shape[:2] if rule.ndim == 3 else (len(weights), 1))
    part = part / np.where(part.sum(0) > 0, part.sum(0), 1)
    middle = (part * centres).sum(1, keepdims=True)
    pooled = (part * (each + (centres - middle) ** 2)).sum(1)
    return np.swapaxes(each, 1, 2), pooled[..., None]
