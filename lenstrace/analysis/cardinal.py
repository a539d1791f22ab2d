"""First-order figures of a lens: cardinal points per wavelength, pupils, F-number, magnification, total track."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.paraxial import FirstOrder, Pupil
from lenstrace.sequential.system import System
from lenstrace.sequential.vertices import vertices


@pytree
class Overview:
    """What holds for the whole lens, at its primary wavelength; lengths in mm.

    f_number:       |f'| / entrance pupil diameter, whatever the object's distance; inf for an afocal lens, nan where
                    the entrance pupil is at infinity.
    entrance_pupil: position from the first vertex.        exit_pupil: position from the image surface.
    magnification:  lateral, of a finite object at its paraxial image; None for an object at infinity.
    total_track:    z of the image surface minus z of the first vertex.
    """

    f_number: jax.Array
    entrance_pupil: Pupil
    exit_pupil: Pupil
    magnification: jax.Array | None
    total_track: jax.Array


def first_order(lens: Lens) -> FirstOrder:
    """Focal lengths, focal points, principal planes and nodal points, each (W,) in mm, in the order of the
    lens's wavelengths. Rear points count from the last vertex that bends light, front points from the first
    vertex. An afocal lens has power 0 and inf elsewhere."""
    return _first_order(lens.system)


def overview(lens: Lens) -> Overview:
    """F-number, pupils, magnification and total track of a lens at its primary wavelength."""
    return _overview(lens.system)


@compiled
def _first_order(system: System) -> FirstOrder:
    return jax.vmap(lambda light: paraxial.first_order(system.with_light(light)))(
        jax.tree.map(jnp.asarray, system.light)
    )


@compiled
def _overview(system: System) -> Overview:
    primary = system.at(system.primary)
    entrance = paraxial.entrance_pupil(primary)
    return Overview(
        f_number=jnp.where(
            jnp.isfinite(entrance.diameter),
            jnp.abs(paraxial.first_order(primary).focal_length) / entrance.diameter,
            jnp.nan,
        ),
        entrance_pupil=entrance,
        exit_pupil=paraxial.exit_pupil(primary),
        magnification=None if system.object_distance is None else paraxial.magnification(primary),
        total_track=vertices(system)[1][-1, 2],
    )
