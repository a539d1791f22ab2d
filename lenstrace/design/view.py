"""What wants see of a lens while the search traces its numbers: each figure is computed once, and only if asked for."""

from __future__ import annotations

import functools

import jax

from lenstrace.sequential import paraxial
from lenstrace.sequential.launch import Front, front_of
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.paraxial_rays import heights_and_slopes, largest_field, rays_of_pupil
from lenstrace.sequential.system import System


class View:
    """A lens whose numbers JAX traces, and what several wants ask of it."""

    def __init__(self, lens: Lens) -> None:
        self.lens = lens

    @functools.cached_property
    def system(self) -> System:
        """Of all wavelengths."""
        return self.lens.system

    @functools.cached_property
    def front(self) -> Front:
        """What launching rays needs."""
        return front_of(self.primary)

    @functools.cached_property
    def primary(self) -> System:
        """At the primary wavelength."""
        return self.system.at(self.system.primary)

    @functools.cached_property
    def first_order(self) -> paraxial.FirstOrder:
        """At the primary wavelength."""
        return paraxial.first_order(self.primary)

    @functools.cached_property
    def paraxial_rays(self) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Marginal and chief ray of the largest field at the primary wavelength, see `heights_and_slopes`."""
        return paraxial_rays(self.primary, self.system.fields, self.front.scale)

    @property
    def pupil_radius(self) -> jax.Array:
        """Of the entrance pupil, mm."""
        return self.front.entrance.diameter / 2


def paraxial_rays(primary: System, fields: jax.Array, scale: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Marginal and chief ray of the largest of some fields (F, 2), see `heights_and_slopes`; scale: see `Front`."""
    return heights_and_slopes(primary, rays_of_pupil(primary, largest_field(primary, fields) / scale))
