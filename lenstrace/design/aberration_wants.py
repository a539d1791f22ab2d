"""Wants of aberrations that have names: Seidel sums, colour, distortion."""

from __future__ import annotations

from typing import ClassVar

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.aberrations import seidel
from lenstrace.analysis.colour import paraxial_focus
from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.rays import trace
from lenstrace.compute.pytree import pytree, static
from lenstrace.design.view import View
from lenstrace.design.wants import Scalar, Want, or_nothing
from lenstrace.errors import DesignError, LensTraceError
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.paraxial_rays import largest_field

RIGHT_ANGLE = 90
SUMS = ("spherical", "coma", "astigmatism", "petzval", "distortion", "axial_colour", "lateral_colour")


@pytree
class OfAberration(Scalar):
    """A figure that should be 0 unless another target, or limits, are given."""

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """With the target 0 where nothing else is said."""
        return super(OfAberration, or_nothing(self)).posed(lens, mirrored)


@pytree
class SeidelSum(OfAberration):
    """One of the Seidel sums S_I ... S_V, C_I, C_II of the lens at full aperture and its largest field, mm: spherical,
    coma, astigmatism, petzval, distortion, axial_colour, lateral_colour; see `lenstrace.seidel`."""

    name: str = static(default="spherical")

    unit: ClassVar = "mm"

    def names(self, lens: Lens) -> list[str]:
        """Its name."""
        _ = lens
        return [f"Seidel sum, {self.name.replace('_', ' ')}"]

    def posed(self, lens: Lens, mirrored: bool) -> Want:
        """DesignError for an unknown sum."""
        if self.name not in SUMS:
            raise DesignError(f"SeidelSum: name must be one of {', '.join(SUMS)}, got {self.name!r}")
        return super().posed(lens, mirrored)

    def check(self, lens: Lens) -> None:
        """DesignError where there are no Seidel sums, or no colour."""
        if self.name.endswith("colour"):
            _check_colours(lens)
        _check_seidel(self, lens)

    def values(self, view: View) -> jax.Array:
        """Its total."""
        return getattr(seidel(view.lens).total, self.name)


@pytree
class Petzval(OfAberration):
    """Curvature of the Petzval surface, 1/mm, positive when its centre is at larger z."""

    unit: ClassVar = "1/mm"

    def names(self, lens: Lens) -> list[str]:
        """Its name."""
        _ = lens
        return ["Petzval curvature"]

    def check(self, lens: Lens) -> None:
        """DesignError where there are no Seidel sums."""
        _check_seidel(self, lens)

    def values(self, view: View) -> jax.Array:
        """See `Seidel.petzval_curvature`."""
        return seidel(view.lens).petzval_curvature


@pytree
class AxialColour(OfAberration):
    """Paraxial focus of the shortest wavelength less that of the longest, mm."""

    unit: ClassVar = "mm"

    def names(self, lens: Lens) -> list[str]:
        """Its name."""
        _ = lens
        return ["axial colour"]

    def check(self, lens: Lens) -> None:
        """ImageError where the image is at infinity; DesignError for one wavelength."""
        _check_colours(lens)
        with_image(lens, "axial colour")

    def values(self, view: View) -> jax.Array:
        """The difference."""
        um = view.lens.wavelengths.um
        short, long = (paraxial_focus(view.system.at(int(end))) for end in (np.argmin(um), np.argmax(um)))
        return short - long


@pytree
class LateralColour(OfAberration):
    """Chief ray of the largest field, shortest less longest wavelength, along the line on which the image of the field
    lies from that of the axis, mm: of a centred lens the last height of `lenstrace.lateral_colour`."""

    unit: ClassVar = "mm"

    def names(self, lens: Lens) -> list[str]:
        """Its name."""
        _ = lens
        return ["lateral colour"]

    def check(self, lens: Lens) -> None:
        """DesignError for one wavelength, and where the largest field is 0; ImageError where the image is far."""
        _check_colours(lens)
        _check_field(lens, "lateral colour")

    def values(self, view: View) -> jax.Array:
        """The difference."""
        um = view.lens.wavelengths.um
        (dx, dy), (x, y) = (_chief_ray(view, wavelength) for wavelength in (None, min(um)))
        u, v = _chief_ray(view, max(um))
        return ((x - u) * dx + (y - v) * dy) / jnp.sqrt(dx * dx + dy * dy)


@pytree
class Distortion(OfAberration):
    """Distortion of the largest field at the primary wavelength, percent: its chief ray against the paraxial one on the
    image surface where it stands; of a centred lens the last of `lenstrace.distortion`.

    f_theta: against what goes with the angle, not its tangent.
    """

    f_theta: bool = static(default=False)
    unit: ClassVar = "%"

    def names(self, lens: Lens) -> list[str]:
        """Its name."""
        _ = lens
        return ["distortion, f theta" if self.f_theta else "distortion"]

    def check(self, lens: Lens) -> None:
        """DesignError where the largest field is 0, or none is an angle below 90 degrees; ImageError where the image is
        far."""
        _check_field(lens, "distortion")
        if self.f_theta and lens.fields.kind != "angle":
            raise DesignError("Distortion: f_theta is of fields that are angles")

    def values(self, view: View) -> jax.Array:
        """Of the distance from the image of the axis."""
        x, y = _chief_ray(view)
        heights, _, behind = view.paraxial_rays
        index = paraxial.signed_index(view.primary)[-1]
        ideal = jnp.abs(heights[1, -1] + behind[1] / index * view.primary.thickness[-1])
        if self.f_theta:
            tangent = largest_field(view.primary, jnp.asarray(view.system.fields))
            ideal = ideal * jnp.arctan(tangent) / tangent
        return 100 * (jnp.sqrt(x * x + y * y) / ideal - 1)


def _chief_ray(view: View, wavelength: float | None = None) -> tuple[jax.Array, jax.Array]:
    """Where the chief ray of the largest field meets the image, from that of the axis, mm."""
    fields = jnp.asarray(view.system.fields)
    far = fields[jnp.argmax(jnp.sum(fields * fields, -1))] / view.lens.fields.scale
    x, y = (jnp.stack([component, 0 * component]) for component in far)
    ray = trace(view.lens, field=(x, y), wavelength=wavelength, path=False, opl=False)
    return ray.x[0] - ray.x[1], ray.y[0] - ray.y[1]


def _check_field(lens: Lens, what: str) -> None:
    with_image(lens, what)
    fields = np.abs(np.array([lens.fields.x, lens.fields.y], float))
    if not fields.any() or (lens.fields.kind == "angle" and fields.max() >= RIGHT_ANGLE):
        raise DesignError(f"{what}: the largest field must be above 0, and an angle below 90 degrees")


def _check_seidel(want: Want, lens: Lens) -> None:
    try:
        seidel(lens)
    except LensTraceError as error:
        raise DesignError(f"{type(want).__name__}: {error}") from None


def _check_colours(lens: Lens) -> None:
    if len(lens.wavelengths.um) < 2:
        raise DesignError("the lens has one wavelength; colour needs two")
