"""The want of sharp spots."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree, static
from lenstrace.compute.slopes import sloped
from lenstrace.design.pupil_wants import OverPupil, field_text
from lenstrace.design.view import View
from lenstrace.design.wants import Measured, Want, lost_residual
from lenstrace.errors import DesignError
from lenstrace.optics.vectors import root_or_zero
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import Light
from lenstrace.sequential.trace import trace

ABOUT = ("centroid", "chief")


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
        return [f"RMS spot, {field_text(lens, f)}" for f in self.fields]

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError for an unknown word; else see `OverPupil`."""
        if self.about not in ABOUT:
            raise DesignError(f"SpotRMS: about must be one of {', '.join(ABOUT)}, got {self.about!r}")
        # together, colours have the weights of the lens anyway
        alone = self.polychromatic and self.wavelength_weights is None
        even = [float(weight > 0) for weight in lens.wavelengths.weights]
        made = super(SpotRMS, dataclasses.replace(self, wavelength_weights=even) if alone else self).posed(
            lens, mirrored
        )
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
        total = jnp.sum(living, -1)
        square = jnp.sum(living * (x * x + y * y), -1) / jnp.where(total > 0, total, 1)
        value = jnp.where(total > 0, root_or_zero(square), jnp.nan)
        failures = failures[..., 1:]
        return Measured(value, factor.reshape(-1, 1) * residual, failures, self.lost(failures))

    def _arrived(self, view: View) -> tuple[jax.Array, jax.Array, jax.Array]:
        """x, y and failure of the rays, (W, F, 1 + N), the chief ray first."""
        assert self.points is not None
        # asked for here, or it would be known inside the loop alone
        front, light = view.front, jax.tree.map(lambda a: a[np.array(self.waves)], view.system.light)
        fields = jnp.asarray(view.system.fields)[np.array(self.fields)]
        pupil = (jnp.append(0.0, each) for each in (self.points.x, self.points.y))
        rays = jnp.broadcast_arrays(*(fields[:, i, None] for i in (0, 1)), *pupil)
        flat = tuple(each.ravel() for each in rays)
        (x, y), failure = jax.lax.map(lambda each: sloped(_places)((front, each), flat), light)
        return tuple(each.reshape(-1, *rays[0].shape) for each in (x, y, failure))  # pyright: ignore[reportReturnType]


def _places(lens: tuple[Front, Light], rays: tuple[jax.Array, ...]) -> tuple[tuple[jax.Array, jax.Array], jax.Array]:
    """Where rays, given by their fields and points of the pupil, meet the image, mm; and how they failed."""
    front, light = lens
    field_x, field_y, pupil_x, pupil_y = rays
    ray = trace(front.system.with_light(light), launch(front, light, (field_x, field_y), (pupil_x, pupil_y)))
    return (ray.x, ray.y), ray.failure
