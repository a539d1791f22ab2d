"""The want of flat wavefronts."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.image_rays import image_rays
from lenstrace.analysis.path_difference import Sphere, check_reference, differences
from lenstrace.compute.pytree import pytree, static
from lenstrace.design.pupil_wants import OverPupil
from lenstrace.design.view import View
from lenstrace.design.wants import Measured, Want, lost_residual
from lenstrace.optics.vectors import root_or_zero
from lenstrace.sequential.document import Wavelengths
from lenstrace.sequential.lens import Lens

# Waves that a lost ray counts at least: far more than a lens that is worth a wavefront is wrong by.
LOST_WAVES = 100.0


@pytree
class WavefrontRMS(OverPupil):
    """RMS of the optical path difference from a reference sphere, its mean taken away, in wavelengths, as `rms` of
    `lenstrace.wavefront`.

    reference:  the centre of the sphere: "chief", "primary" or "best", see `Sphere`.
    """

    reference: str = static(default="chief")
    pattern: str = static(default="gaussian")

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
        total = total[..., 0]
        square = jnp.sum(living * opd * opd, -1) / jnp.where(total > 0, total, 1)
        value = jnp.where(total > 0, root_or_zero(square), jnp.nan).ravel()
        weighted = (factor[..., None] * residual).reshape(len(value), -1)
        failures = jnp.swapaxes(failure, 0, 1)
        return Measured(value, weighted, failures, self.lost(failures))

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
