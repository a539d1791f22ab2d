"""Field curvature and astigmatism: where narrow bundles about the chief ray of each field come to a focus."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.field_line import (
    Beside,
    FieldLine,
    beside,
    chief_and_beside,
    crossing,
    field_line,
    shares_of,
)
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree
from lenstrace.optics.rays import has_course
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System


@pytree
class FieldCurvature:
    """Foci of P fields from the axis to the largest one, and W wavelengths.

    field:                 (P,), from the axis, in the unit of the lens's fields (degrees, or the file's length).
    direction:             (2,), unit vector in x and y toward the largest field.
    tangential, sagittal:  (P, W), mm along z of the image's frame, from the image surface where the chief ray meets it
                           to the focus of the rays beside it, in the plane of field and axis and across it; inf where
                           these are parallel, nan where there is no chief ray. In a lens that is not symmetric about
                           that plane: where they come nearest to the chief ray.
    petzval_radius:        (W,), mm, of the surface on which third-order theory puts both foci of a lens without
                           astigmatism: 1/radius = -N' sum c (N2 - N1) / (N1 N2), N signed indices; inf where it is
                           flat. Tilts and decentres do not count in it. Source: Welford (1986), section 8.2.
    """

    field: jax.Array
    direction: jax.Array
    tangential: jax.Array
    sagittal: jax.Array
    petzval_radius: jax.Array

    @property
    def astigmatism(self) -> jax.Array:
        """(P, W), tangential minus sagittal, mm along z."""
        return self.tangential - self.sagittal


def field_curvature(lens: Lens, *, points: int = 21) -> FieldCurvature:
    """Tangential and sagittal foci against field, by the exact derivative of the trace about the chief ray.

    points: fields from 0 to the largest, evenly spaced; one if the lens has the field 0 alone.
    ImageError where the image is at infinity.
    """
    system, front = with_image(lens, "field curvature")
    line = field_line(system, shares_of(lens, points))
    chief, along, across = chief_and_beside(line)
    found = (beside(front, system.light, chief, toward) for toward in (along, across))
    return _field_curvature(system, line, tuple(found), lens.fields.scale)


@compiled
def _field_curvature(
    system: System, line: FieldLine, found: tuple[Beside, ...], scale: jax.Array | float
) -> FieldCurvature:
    tangential, sagittal = (
        jnp.where(has_course(each.failure), crossing(each.change) - each.ray.z, jnp.nan).T for each in found
    )
    petzval = jax.vmap(lambda light: petzval_radius(system.with_light(light)))(jax.tree.map(jnp.asarray, system.light))
    return FieldCurvature(line.height / scale, line.direction, tangential, sagittal, petzval)


def petzval_radius(system: System) -> jax.Array:
    """See `FieldCurvature`; the system at one wavelength."""
    index = paraxial.signed_index(system)
    before, behind = index[:-1], index[1:]
    curvature = -index[-1] * jnp.sum(paraxial.effective_curvature(system)[:-1] * (behind - before) / (before * behind))
    flat = curvature == 0
    return jnp.where(flat, jnp.inf, 1 / jnp.where(flat, 1, curvature))
