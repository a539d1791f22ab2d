"""Wants of what a lens is made of: thicknesses on the axis and at the edge, and its length."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree, static
from lenstrace.design.variables import Surfaces, surfaces_of
from lenstrace.design.view import View
from lenstrace.design.wants import Scalar, Want
from lenstrace.errors import DesignError
from lenstrace.optics.vectors import safe_sqrt
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System

# Beyond this part of the radius at which a conic ends, its sag goes on along the tangent: an edge that no lens has
# still has a thickness, and a slope that leads back.
END = 0.98


@pytree
class OfGaps(Scalar):
    """A want of the gaps behind some surfaces: numbers, "glass", "air" or "all"; the gap before the image is none of
    those that a word names."""

    surfaces: Surfaces = static(default="glass")

    unit: ClassVar = "mm"

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """With the numbers of the surfaces."""
        name = type(self).__name__
        found = surfaces_of(lens, "thickness", self.surfaces, ("all", "glass", "air"))
        chosen = [n for n in found if n < len(lens)] if isinstance(self.surfaces, str) else found
        if not chosen:
            raise DesignError(f"{name}: there is no gap of {self.surfaces}; name surfaces by their numbers")
        return super(OfGaps, dataclasses.replace(self, surfaces=tuple(chosen))).posed(lens, mirrored)

    @property
    def words(self) -> str:
        """What is measured."""
        raise NotImplementedError

    def names(self, lens: Lens) -> list[str]:
        """One for each gap."""
        _ = lens
        assert not isinstance(self.surfaces, str | int)
        return [f"{self.words} {surface}" for surface in self.surfaces]


@pytree
class CentreThickness(OfGaps):
    """Thicknesses on the axis, mm, taken along the light: behind a mirror too they are positive."""

    @property
    def words(self) -> str:
        """Its name."""
        return "centre thickness"

    def values(self, view: View) -> jax.Array:
        """Along the light."""
        gaps = np.array(self.surfaces) - 1
        along = np.array(view.system.orientation[1:], float)[gaps]
        return jnp.asarray(view.system.thickness)[gaps] * along


@pytree
class EdgeThickness(OfGaps):
    """Thicknesses at the edge, mm: between two surfaces at the larger of their semi-diameters.

    A semi-diameter is that of the row; where it has none, |y| + |ybar| of the marginal ray and the chief ray of the
    largest field, the paraxial height of all light.
    """

    @property
    def words(self) -> str:
        """Its name."""
        return "edge thickness"

    def values(self, view: View) -> jax.Array:
        """Thickness and the difference of the sags."""
        gaps = np.array(self.surfaces) - 1
        heights = jnp.append(semi_diameters(view), 0.0)
        edge = jnp.maximum(heights[gaps], heights[gaps + 1])
        along = np.array(view.system.orientation[1:], float)[gaps]
        thickness = jnp.asarray(view.system.thickness)[gaps]
        return (thickness + _sag(view.system, gaps + 1, edge) - _sag(view.system, gaps, edge)) * along


@pytree
class TotalTrack(Scalar):
    """The place of the image on the axis, from the first vertex, mm."""

    unit: ClassVar = "mm"

    def names(self, lens: Lens) -> list[str]:
        """Its name."""
        _ = lens
        return ["total track"]

    def values(self, view: View) -> jax.Array:
        """The sum of the thicknesses."""
        return jnp.sum(jnp.asarray(view.system.thickness))


def semi_diameters(view: View) -> jax.Array:
    """(S,), mm: see `EdgeThickness`."""
    heights, _, _ = view.paraxial_rays
    light = jnp.sum(jnp.abs(heights), 0)
    drawn = [row.semi_diameter for row in view.lens]
    return jnp.where(np.array([d is not None for d in drawn]), np.array([d or 0.0 for d in drawn]), light)


def _sag(system: System, surfaces: Any, height: jax.Array) -> jax.Array:
    """Of some surfaces, by their places, at a height each; finite and smooth beyond the rim of a conic."""
    c, k = jnp.asarray(system.curvature)[surfaces], jnp.asarray(system.conic)[surfaces]
    bend = (1 + k) * c * c
    rim = END / safe_sqrt(bend)
    inside = jnp.where(bend > 0, jnp.minimum(height, rim), height)
    root = safe_sqrt(1 - bend * inside * inside)
    sag = c * inside * inside / (1 + root) + (height - inside) * c * inside / root
    for power in sorted({power for kind in system.kinds for power in kind.powers}):
        sag = sag + system.term(power)[surfaces] * height**power
    return sag
