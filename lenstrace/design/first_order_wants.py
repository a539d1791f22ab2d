"""Wants of first order: focal lengths, magnification, the course of the two paraxial rays; all at the primary
wavelength."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import jax
import jax.numpy as jnp

from lenstrace.analysis.conditions import conditions_of, with_image
from lenstrace.compute.pytree import pytree, static
from lenstrace.design.view import View
from lenstrace.design.wants import Scalar, Want
from lenstrace.errors import DesignError
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens


@pytree
class FirstOrderWant(Scalar):
    """A figure of `lenstrace.first_order`, mm."""

    unit: ClassVar = "mm"

    def names(self, lens: Lens) -> list[str]:
        """Its words."""
        _ = lens
        return [_words(self)]

    def check(self, lens: Lens) -> None:
        """DesignError for a lens that has no finite focal length."""
        if conditions_of(lens).powerless:
            raise DesignError(f"{type(self).__name__}: the lens is afocal at the start; begin with some power")


@pytree
class FocalLength(FirstOrderWant):
    """f', mm."""

    def values(self, view: View) -> jax.Array:
        """f'"""
        return view.first_order.focal_length


@pytree
class BackFocalLength(FirstOrderWant):
    """From the last vertex that bends light to the rear focal point, mm."""

    def values(self, view: View) -> jax.Array:
        """BFL"""
        return view.first_order.back_focal_length


@pytree
class FNumber(FirstOrderWant):
    """|f'| over the diameter of the entrance pupil."""

    unit: ClassVar = ""

    def values(self, view: View) -> jax.Array:
        """|f'| / D"""
        return jnp.abs(view.first_order.focal_length) / (2 * view.pupil_radius)


@pytree
class Magnification(Scalar):
    """Paraxial lateral magnification of an object at a finite distance."""

    unit: ClassVar = ""

    def names(self, lens: Lens) -> list[str]:
        """Its word."""
        _ = lens
        return ["magnification"]

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError for an object at infinity."""
        if lens.object_distance is None:
            raise DesignError("Magnification: the object is at infinity; want a FocalLength, or give object_distance")
        return super().posed(lens, mirrored)

    def check(self, lens: Lens) -> None:
        """ImageError where the image is at infinity."""
        with_image(lens, "Magnification")

    def values(self, view: View) -> jax.Array:
        """m"""
        return paraxial.magnification(view.primary)


@pytree
class ParaxialHeight(Scalar):
    """Height at a surface of the marginal ray, or of the chief ray of the largest field, mm; S + 1 is the image."""

    surface: int = static(default=1)
    ray: Literal["marginal", "chief"] = static(default="marginal")

    unit: ClassVar = "mm"

    def names(self, lens: Lens) -> list[str]:
        """Ray and surface."""
        at = "image" if self.surface == len(lens) + 1 else f"surface {self.surface}"
        return [f"{self.ray} ray height at {at}"]

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError for another ray or surface."""
        _check_ray(self, self.ray, self.surface, len(lens) + 1)
        return super().posed(lens, mirrored)

    def values(self, view: View) -> jax.Array:
        """y"""
        height, slope = _at(view, self.ray, self.surface)
        return height if self.surface <= view.system.surfaces else height + slope * view.primary.thickness[-1]


@pytree
class ParaxialSlope(Scalar):
    """Slope dy/dz behind a surface of the marginal ray, or of the chief ray of the largest field."""

    surface: int = static(default=1)
    ray: Literal["marginal", "chief"] = static(default="marginal")

    unit: ClassVar = ""

    def names(self, lens: Lens) -> list[str]:
        """Ray and surface."""
        _ = lens
        return [f"{self.ray} ray slope behind surface {self.surface}"]

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError for another ray or surface."""
        _check_ray(self, self.ray, self.surface, len(lens))
        return super().posed(lens, mirrored)

    def values(self, view: View) -> jax.Array:
        """u"""
        return _at(view, self.ray, self.surface + 1)[1]


def _at(view: View, ray: str, surface: int) -> tuple[jax.Array, jax.Array]:
    """Height at a surface, or at the last one for a surface beyond it, and slope before it."""
    heights, before, behind = view.paraxial_rays
    place = 0 if ray == "marginal" else 1
    index = paraxial.signed_index(view.primary)
    if surface <= view.system.surfaces:
        return heights[place, surface - 1], before[place, surface - 1] / index[surface - 1]
    return heights[place, -1], behind[place] / index[-1]


def _check_ray(want: Any, ray: str, surface: Any, last: int) -> None:
    name = type(want).__name__
    if ray not in ("marginal", "chief"):
        raise DesignError(f"{name}: ray must be marginal or chief, got {ray!r}")
    if isinstance(surface, bool) or not isinstance(surface, int) or not 1 <= surface <= last:
        raise DesignError(f"{name}: surface must be a number from 1 to {last}, got {surface!r}")


def _words(want: Want) -> str:
    """FocalLength: "focal length"."""
    name = type(want).__name__
    return "".join(f" {c.lower()}" if c.isupper() else c for c in name).strip() if name != "FNumber" else "f-number"
