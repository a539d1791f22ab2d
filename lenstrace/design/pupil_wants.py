"""What wants of all the light have in common: fields, wavelengths and points of the pupil, and which rays count."""

from __future__ import annotations

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.spot_figures import loss_text
from lenstrace.compute.pytree import pytree, static
from lenstrace.design.wants import Want, checked_number
from lenstrace.errors import DesignError, LostRaysError
from lenstrace.optics.rays import RayStatus, split_failure, status_of
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import PupilPoints, half_points, pupil_points


@pytree
class OverPupil(Want):
    """A want of the light of all fields and wavelengths, sampled over the pupil; a term for each of them.

    field_weights:       (F,), factors of the weight, 1 by default; what has weight 0 is not traced.
    wavelength_weights:  (W,), as well; by default the roots of the weights of the lens, so that a colour of weight w
                         counts w times its squares.
    rings, pattern:      see `pupil_points`.

    Set by `posed`: fields, waves, the places of those that are traced; points, of the pupil, of a lens that is its own
    mirror image one half of them, with twice the weight; counted, (W, F, N), 0 for rays that an aperture stops at the
    start, which never count, else 1.
    """

    weight: Any = 1.0
    field_weights: Any = None
    wavelength_weights: Any = None
    points: PupilPoints | None = None
    counted: Any = 1.0
    rings: int = static(default=6)
    pattern: str = static(default="hexapolar")
    fields: tuple[int, ...] = static(default=())
    waves: tuple[int, ...] = static(default=())
    halved: bool = static(default=False)

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """With its rays, and the weights of the lens's wavelengths where it has none of its own."""
        super().posed(lens, mirrored)
        name = type(self).__name__
        weights = self.wavelength_weights
        if weights is None:
            # a colour of weight w counts w times its squares
            weights = np.sqrt(np.array(lens.wavelengths.weights, float))
        fields = _with_weight(name, "field_weights", self.field_weights, len(lens.fields.y), "fields")
        waves = _with_weight(name, "wavelength_weights", weights, len(lens.wavelengths.um), "wavelengths")
        points = pupil_points(self.pattern, self.rings)
        half = half_points(points) if mirrored else None
        points = points if half is None else half
        return dataclasses.replace(
            self,
            points=points,
            counted=np.ones((len(waves), len(fields), len(points.x))),
            fields=tuple(fields),
            waves=tuple(waves),
            field_weights=_of(self.field_weights, fields),
            wavelength_weights=_of(weights, waves),
            halved=half is not None,
        )

    def counting(self, failure: np.ndarray) -> Want:
        """Rays that an aperture stops do not count. LostRaysError where all rays are lost; it says where."""
        if np.all(failure):
            codes, counts = np.unique(failure, return_counts=True)
            where = loss_text({split_failure(int(code)): int(n) for code, n in zip(codes, counts, strict=True)})
            raise LostRaysError(
                f"{type(self).__name__}: all rays of the start are lost: {where}; begin with a lens that light passes"
            )
        clipped = status_of(failure) == RayStatus.CLIPPED
        if np.any(np.all(clipped, -1)):
            _, field = np.argwhere(np.all(clipped, -1))[0]
            raise LostRaysError(
                f"{type(self).__name__}: apertures stop all rays of field {self.fields[field] + 1} at the start; open "
                "them, or give the field weight 0"
            )
        return dataclasses.replace(self, counted=1.0 - clipped)

    def lost(self, failure: jax.Array) -> jax.Array:
        """How many rays that count are lost, of the whole pupil; failure: (W, F, N)."""
        assert self.points is not None
        rays = jnp.where(jnp.asarray(self.points.weight) > 1, 2.0, 1.0) if self.halved else 1.0
        return jnp.sum(jnp.where((failure > 0) & (self.counted > 0), rays, 0.0))

    def share(self) -> jax.Array:
        """(W, F, N), of each spot's rays, of sum 1."""
        assert self.points is not None
        weight = jnp.asarray(self.points.weight) * self.counted
        total = jnp.sum(weight, -1, keepdims=True)
        return weight / jnp.where(total > 0, total, 1)

    def names(self, lens: Lens) -> list[str]:
        """Field and wavelength of each."""
        return [
            f"{self.words}, {field_text(lens, f)}, {lens.wavelengths.um[w]:g} um"
            for f in self.fields
            for w in self.waves
        ]

    @property
    def words(self) -> str:
        """What is measured."""
        raise NotImplementedError


def _with_weight(want: str, key: str, weights: Any, count: int, what: str) -> list[int]:
    """Places of weights above 0; all of them where none are given."""
    if weights is None:
        return list(range(count))
    given = np.atleast_1d(checked_number(want, key, weights))
    if given.shape != (count,) or np.any(given < 0) or not np.any(given > 0):
        raise DesignError(f"{want}: {key} must be {count} numbers, for all {what}, none below 0; got {weights}")
    return np.flatnonzero(given).tolist()


def _of(weights: Any, places: list[int]) -> Any:
    return None if weights is None else np.asarray(weights, float)[places]


def field_text(lens: Lens, field: int) -> str:
    """A field in words."""
    x, y = float(lens.fields.x[field]), float(lens.fields.y[field])
    return f"field {y:g} {lens.fields.unit}" if not x else f"field ({x:g}, {y:g}) {lens.fields.unit}"
