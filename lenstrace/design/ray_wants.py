"""Wants of single rays: where they meet a surface, at what angle, and how steeply.

A ray is named as `lenstrace.trace` names it: field in the unit of the lens's fields, y or (x, y); pupil x and y in
units of its radius; wavelength in micrometres. Field and pupil may be arrays; every ray is a term.
"""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar, Literal

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.compute.pytree import pytree, static
from lenstrace.design.view import View
from lenstrace.design.wants import Measured, Scalar, Want, checked_number, lost_residual, or_nothing
from lenstrace.errors import DesignError, LensTraceError
from lenstrace.optics.rays import Ray
from lenstrace.optics.vectors import dot, root_or_zero, rotate, rotate_back
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.normals import surface_normal
from lenstrace.sequential.vertices import vertices

DEGREES = 180 / np.pi
Axis = Literal["x", "y"]


@pytree
class OfRays(Scalar):
    """A want of rays at one surface; S + 1 is the image, which is meant where none is given.

    A lost ray misses its target by what `lost_residual` says, in the unit of the want: its residual is finite, and so
    is its slope.
    """

    field: Any = 0.0
    pupil: Any = (0.0, 0.0)
    wavelength: float | None = static(default=None)
    surface: int | None = static(default=None)

    def figure(self, view: View, path: Ray, surface: int) -> jax.Array:
        """Of rays whose path is given, at one surface."""
        raise NotImplementedError

    @property
    def um(self) -> tuple[float, ...]:
        """Its wavelength."""
        return () if self.wavelength is None else (float(self.wavelength),)

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError for a surface that is none."""
        super().posed(lens, mirrored)
        name = type(self).__name__
        last = len(lens) + 1
        if getattr(self, "axis", "y") not in ("x", "y"):
            raise DesignError(f"{name}: axis must be x or y, got {self.axis!r}")  # pyright: ignore
        if self.wavelength is not None and (
            isinstance(self.wavelength, bool) or not isinstance(self.wavelength, int | float)
        ):
            raise DesignError(f"{name}: wavelength must be a number of micrometres, got {self.wavelength!r}")
        surface = last if self.surface is None else self.surface
        if isinstance(surface, bool) or not isinstance(surface, int | np.integer) or not 1 <= surface <= last:
            raise DesignError(f"{name}: surface must be a number from 1 to {last}, the image, got {self.surface!r}")
        field = self.field if isinstance(self.field, tuple) else (0.0, self.field)
        return dataclasses.replace(
            self, surface=int(surface), field=_pair(name, "field", field), pupil=_pair(name, "pupil", self.pupil)
        )

    def check(self, lens: Lens) -> None:
        """DesignError for rays that there are not."""
        try:
            trace(lens, field=self.field, pupil=self.pupil, wavelength=self.wavelength, path=False, opl=False)
        except LensTraceError as error:
            raise DesignError(f"{type(self).__name__}: {error}") from None

    def names(self, lens: Lens) -> list[str]:
        """Field and pupil of each ray."""
        at = "image" if self.surface == len(lens) + 1 else f"surface {self.surface}"
        rays = zip(*(a.ravel().tolist() for a in np.broadcast_arrays(*self.field, *self.pupil)), strict=True)
        return [
            f"{self.words} at {at}, field {f'{fy:g}' if not fx else f'({fx:g}, {fy:g})'} {lens.fields.unit}, "
            f"pupil ({px:g}, {py:g})"
            for fx, fy, px, py in rays
        ]

    @property
    def words(self) -> str:
        """What is measured."""
        raise NotImplementedError

    def measured(self, view: View) -> Measured:
        """Of each ray; of a lost one no value, and what it counts."""
        assert self.surface is not None
        path = trace(view.lens, field=self.field, pupil=self.pupil, wavelength=self.wavelength, opl=False)
        path = jax.tree.map(lambda a: a.reshape(a.shape[0], -1), path)
        arrives, x, y = path.failure[self.surface] == 0, path.x[self.surface], path.y[self.surface]
        found = self.missed(self.figure(view, path, self.surface))
        lost = lost_residual(x, y, view.pupil_radius)[:, None] * jnp.eye(1, found.residual.shape[1], dtype=x.dtype)
        return Measured(
            jnp.where(arrives, found.value, jnp.nan),
            jnp.where(arrives[:, None], found.residual, lost),
            lost=jnp.sum(jnp.where(arrives, 0.0, 1.0)),
        )


@pytree
class RayHeight(OfRays):
    """x or y of rays where they meet a surface, in its frame, mm."""

    axis: Axis = static(default="y")

    unit: ClassVar = "mm"

    @property
    def words(self) -> str:
        """Height of a ray."""
        return f"ray height {self.axis}"

    def figure(self, view: View, path: Ray, surface: int) -> jax.Array:
        """x or y."""
        _ = view
        return getattr(path, self.axis)[surface]


@pytree
class TransverseError(OfRays):
    """How far rays miss the chief ray of their field at the primary wavelength, x or y on the image surface, mm; the
    target is 0 unless it is given, or limits are."""

    axis: Axis = static(default="y")

    unit: ClassVar = "mm"

    @property
    def words(self) -> str:
        """Transverse error."""
        return f"transverse error {self.axis}"

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """With the target 0 where nothing else is said."""
        if self.surface not in (None, len(lens) + 1):
            raise DesignError(f"TransverseError: it is an error on the image; leave out surface = {self.surface}")
        return super(TransverseError, or_nothing(self)).posed(lens, mirrored)

    def figure(self, view: View, path: Ray, surface: int) -> jax.Array:
        """The difference."""
        chief = trace(view.lens, field=self.field, path=False, opl=False)
        return getattr(path, self.axis)[surface] - jnp.broadcast_to(getattr(chief, self.axis).ravel(), path.x[0].shape)


@pytree
class RayAngle(OfRays):
    """Angle of rays to the z axis behind a surface, in the plane x-z or y-z of its frame, degrees."""

    axis: Axis = static(default="y")

    unit: ClassVar = "deg"

    @property
    def words(self) -> str:
        """Angle of a ray."""
        return f"ray angle {self.axis}"

    def figure(self, view: View, path: Ray, surface: int) -> jax.Array:
        """atan of the slope; light that travels toward -z too has angles about 0."""
        _ = view
        across = path.l if self.axis == "x" else path.m
        along = path.n[surface]
        return DEGREES * jnp.arctan2(across[surface] * jnp.where(along < 0, -1, 1), jnp.abs(along))


@pytree
class IncidenceAngle(OfRays):
    """Angle between rays and the normal of the surface they meet, degrees, 0 to 90. At the image, of chief rays, it is
    what sensors limit."""

    unit: ClassVar = "deg"

    @property
    def words(self) -> str:
        """Angle of incidence."""
        return "incidence"

    def figure(self, view: View, path: Ray, surface: int) -> jax.Array:
        """atan of |N x d| over |N . d|."""
        rotations = vertices(view.system)[0]
        before = (path.l[surface - 1], path.m[surface - 1], path.n[surface - 1])
        # behind the surface before, in its frame; the launch frame is that of the first vertex
        into = rotate(rotations[surface - 2], before) if surface > 1 else before
        direction = rotate_back(rotations[surface - 1], into)
        normal = surface_normal(view.system, surface, (path.x[surface], path.y[surface], path.z[surface]))
        x, y, z = (normal[i - 2] * direction[i - 1] - normal[i - 1] * direction[i - 2] for i in (0, 1, 2))
        return DEGREES * jnp.arctan2(root_or_zero(x * x + y * y + z * z), jnp.abs(dot(normal, direction)))


def _pair(want: str, key: str, given: Any) -> tuple[np.ndarray, np.ndarray]:
    """x and y, numbers or arrays that broadcast; else DesignError."""
    try:
        x, y = given
    except (TypeError, ValueError):
        raise DesignError(f"{want}: {key} must be a pair (x, y), got {given!r}") from None
    return checked_number(want, key, x), checked_number(want, key, y)
