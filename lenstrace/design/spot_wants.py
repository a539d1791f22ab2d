"""Wants of the whole image: sharp spots, flat wavefronts."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.arrivals import Asked, arrivals
from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.image_rays import image_rays
from lenstrace.analysis.path_difference import Sphere, check_reference, differences
from lenstrace.analysis.spot_figures import loss_text, place
from lenstrace.compute.pytree import pytree, static
from lenstrace.design.view import View
from lenstrace.design.wants import Measured, Want, lost_residual
from lenstrace.errors import DesignError, LostRaysError
from lenstrace.optics.rays import RayStatus, split_failure, status_of
from lenstrace.optics.vectors import root_or_zero
from lenstrace.sequential.document import Wavelengths
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import PupilPoints, half_points, pupil_points

ABOUT = ("centroid", "chief")
# Waves that a lost ray counts at least: far more than a lens that is worth a wavefront is wrong by.
LOST_WAVES = 100.0


@pytree
class OverPupil(Want):
    """A want of the light of all fields and wavelengths, sampled over the pupil; a term for each of them.

    field_weights:       (F,), factors of the weight, 1 by default; what has weight 0 is not traced.
    wavelength_weights:  (W,), as well.
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
        """With its rays."""
        super().posed(lens, mirrored)
        name = type(self).__name__
        fields = _with_weight(name, "field_weights", self.field_weights, len(lens.fields.y), "fields")
        waves = _with_weight(
            name, "wavelength_weights", self.wavelength_weights, len(lens.wavelengths.um), "wavelengths"
        )
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
            wavelength_weights=_of(self.wavelength_weights, waves),
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
        return dataclasses.replace(
            self, counted=1.0 - (np.asarray(status_of(jnp.asarray(failure))) == RayStatus.CLIPPED)
        )

    def share(self) -> jax.Array:
        """(W, F, N), of each spot's rays, of sum 1."""
        assert self.points is not None
        weight = jnp.asarray(self.points.weight) * self.counted
        total = jnp.sum(weight, -1, keepdims=True)
        return weight / jnp.where(total > 0, total, 1)

    def names(self, lens: Lens) -> list[str]:
        """Field and wavelength of each."""
        return [
            f"{self.words}, {_field_text(lens, f)}, {lens.wavelengths.um[w]:g} um"
            for f in self.fields
            for w in self.waves
        ]

    @property
    def words(self) -> str:
        """What is measured."""
        raise NotImplementedError


@pytree
class SpotRMS(OverPupil):
    """RMS radius of spots, mm, as `lenstrace.spots` gives it, of every field and wavelength by itself.

    The residuals of a spot are those of its rays, (x - xc) / sqrt(N) and (y - yc) / sqrt(N): one residual for the
    whole RMS would have no slope to follow near 0, and searches stall.

    about:          the "centroid", or the "chief" ray of each field and wavelength.
    polychromatic:  one spot for each field, all wavelengths together with the weights of the lens (times
                    wavelength_weights), about their common centroid or the primary chief ray.
    """

    about: str = static(default="centroid")
    polychromatic: bool = static(default=False)

    unit: ClassVar = "mm"

    @property
    def words(self) -> str:
        """RMS spot."""
        return "RMS spot"

    def names(self, lens: Lens) -> list[str]:
        """Field, and wavelength unless they are taken together."""
        if not self.polychromatic:
            return super().names(lens)
        return [f"RMS spot, {_field_text(lens, f)}" for f in self.fields]

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError for an unknown word; else see `OverPupil`."""
        if self.about not in ABOUT:
            raise DesignError(f"SpotRMS: about must be one of {', '.join(ABOUT)}, got {self.about!r}")
        made = super().posed(lens, mirrored)
        assert isinstance(made, SpotRMS)
        if self.polychromatic and self.about == "chief" and lens.wavelengths.primary not in made.waves:
            raise DesignError("SpotRMS: about the primary chief ray, but the primary wavelength has weight 0")
        return made

    def measured(self, view: View) -> Measured:
        """See the class."""
        x, y, failures = self._arrived(view)
        x, y, failure, share = (jnp.swapaxes(a, 0, 1) for a in (x, y, failures, self.share()))
        primary = 0
        factor = jnp.ones((len(self.fields), len(self.waves)))
        if self.field_weights is not None:
            factor = factor * jnp.asarray(self.field_weights)[:, None]
        if self.polychromatic:
            colour = jnp.asarray(view.system.weights)[np.array(self.waves)]
            colour = colour if self.wavelength_weights is None else colour * self.wavelength_weights
            share = share * (colour / jnp.sum(colour))[:, None]
            primary = self.waves.index(view.system.primary) if self.about == "chief" else 0
            factor = factor[:, :1]
        elif self.wavelength_weights is not None:
            factor = factor * self.wavelength_weights
        terms = factor.size
        chief_x, chief_y = (a[:, primary, 0] if self.polychromatic else a[..., 0].ravel() for a in (x, y))
        x, y, failure = (a[..., 1:].reshape(terms, -1) for a in (x, y, failure))
        share = share.reshape(terms, -1)
        arrives = failure == 0
        living = jnp.where(arrives, share, 0)
        if self.about == "chief":
            centre_x, centre_y = chief_x[:, None], chief_y[:, None]
        else:
            total = jnp.sum(living, -1, keepdims=True)
            total = jnp.where(total > 0, total, 1)
            centre_x = 0.0 if self.halved else jnp.sum(living * x, -1, keepdims=True) / total
            centre_y = jnp.sum(living * y, -1, keepdims=True) / total
        x, y = x - centre_x, y - centre_y
        root = jnp.sqrt(share)
        lost = lost_residual(jnp.where(arrives, 0, x), jnp.where(arrives, 0, y), view.pupil_radius)
        residual = jnp.concatenate([root * jnp.where(arrives, x, lost), root * jnp.where(arrives, y, 0)], -1)
        value = root_or_zero(jnp.sum(residual**2, -1))
        return Measured(value, factor.reshape(-1, 1) * residual, failures[..., 1:])

    def _arrived(self, view: View) -> tuple[jax.Array, jax.Array, jax.Array]:
        """x, y and failure of the rays, (W, F, 1 + N), the chief ray first."""
        assert self.points is not None
        waves = np.array(self.waves)
        light = jax.tree.map(lambda a: a[waves], view.system.light)
        fields = view.system.fields[np.array(self.fields)]
        return arrivals(Asked(view.front, light, place), fields, self.points.x, self.points.y)


@pytree
class WavefrontRMS(OverPupil):
    """RMS of the optical path difference from a reference sphere, its mean taken away, in wavelengths, as `rms` of
    `lenstrace.wavefront`.

    reference:  the centre of the sphere: "chief", "primary" or "best", see `Sphere`.
    """

    reference: str = static(default="chief")

    unit: ClassVar = "waves"

    @property
    def words(self) -> str:
        """RMS wavefront."""
        return "RMS wavefront"

    def check(self, lens: Lens) -> None:
        """ImageError where the image is at infinity."""
        with_image(lens, "WavefrontRMS")

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """RayError for an unknown reference; else see `OverPupil`."""
        check_reference(self.reference)
        # the best centre is sought to both sides
        return super().posed(lens, mirrored and self.reference != "best")

    def measured(self, view: View) -> Measured:
        """See the class."""
        opd, failure, x, y = self._arrived(view)
        share = jnp.swapaxes(self.share(), 0, 1)
        arrives = failure == 0
        living = jnp.where(arrives, share, 0)
        total = jnp.sum(living, -1, keepdims=True)
        opd = opd - jnp.sum(jnp.where(arrives, living * opd, 0), -1, keepdims=True) / jnp.where(total > 0, total, 1)
        radius = view.pupil_radius
        lost = lost_residual(jnp.where(arrives, 0, x), jnp.where(arrives, 0, y), radius) * (LOST_WAVES / radius)
        residual = jnp.sqrt(share) * jnp.where(arrives, opd, lost)
        factor = jnp.ones((len(self.fields), len(self.waves)))
        factor = factor if self.field_weights is None else factor * jnp.asarray(self.field_weights)[:, None]
        factor = factor if self.wavelength_weights is None else factor * self.wavelength_weights
        value = root_or_zero(jnp.sum(residual**2, -1)).ravel()
        weighted = (factor[..., None] * residual).reshape(len(value), -1)
        return Measured(value, weighted, jnp.swapaxes(failure, 0, 1))

    def _arrived(self, view: View) -> tuple[jax.Array, ...]:
        """Path difference, failure, x and y of the rays, (F, W, N)."""
        assert self.points is not None
        fields, waves = view.lens.fields, view.lens.wavelengths
        # the primary wavelength is needed by the reference sphere
        traced = sorted({*self.waves, waves.primary})
        lens = dataclasses.replace(
            view.lens,
            fields=dataclasses.replace(
                fields, x=tuple(fields.x[f] for f in self.fields), y=tuple(fields.y[f] for f in self.fields)
            ),
            wavelengths=Wavelengths(
                tuple(waves.weights[w] for w in traced),
                tuple(waves.um[w] for w in traced),
                traced.index(waves.primary),
            ),
        )
        found = differences(
            image_rays(lens, self.points.x, self.points.y), Sphere(self.reference), jnp.asarray(self.points.weight)
        )
        kept = np.array([traced.index(w) for w in self.waves])
        return tuple(a[:, kept] for a in (found.opd, found.failure, found.x, found.y))


def _with_weight(want: str, key: str, weights: Any, count: int, what: str) -> list[int]:
    """Places of weights above 0; all of them where none are given."""
    if weights is None:
        return list(range(count))
    given = np.asarray(weights, float)
    if given.shape != (count,) or not np.all(np.isfinite(given)) or np.any(given < 0) or not np.any(given > 0):
        raise DesignError(f"{want}: {key} must be {count} numbers, for all {what}, none below 0; got {weights}")
    return np.flatnonzero(given).tolist()


def _of(weights: Any, places: list[int]) -> Any:
    return None if weights is None else np.asarray(weights, float)[places]


def _field_text(lens: Lens, field: int) -> str:
    x, y = float(lens.fields.x[field]), float(lens.fields.y[field])
    return f"field {y:g} {lens.fields.unit}" if not x else f"field ({x:g}, {y:g}) {lens.fields.unit}"
