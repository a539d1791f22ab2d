"""What a question needs of a lens before it is traced: a pupil to aim at, an image to look at."""

from __future__ import annotations

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced
from lenstrace.errors import ImageError, PrescriptionError
from lenstrace.sequential import paraxial
from lenstrace.sequential.launch import Front, front_of
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System

# Lenses whose fronts are kept, so that the next question of the same lens does not wait for it.
REMEMBERED = 64


class Conditions(NamedTuple):
    """Whether the lens has no power, its entrance pupil lies at infinity, its image does; and where its exit pupil is,
    mm from the vertex of the image surface, inf at infinity."""

    powerless: jax.Array
    far: jax.Array
    image_far: jax.Array
    exit_position: jax.Array


def with_pupil(lens: Lens) -> tuple[System, Front]:
    """The numbers of a lens, and its front; ImageError or PrescriptionError where there is no entrance pupil.

    While JAX traces the numbers of a lens nothing can be known of them, and nothing is raised.
    """
    if is_traced(lens):
        system = lens.system
        return system, _computed(system.at(system.primary))[0]
    front, conditions = _kept(lens)
    if lens.aperture.kind == "image_f_number" and conditions.powerless:
        raise ImageError(
            "aperture: image_f_number needs a focal length, and this lens is afocal (power 0); "
            "give entrance_pupil_diameter"
        )
    if lens.fields.kind == "image_height" and conditions.image_far:
        raise ImageError("fields: image_height needs an image at a finite distance, and it is at infinity; give angles")
    if conditions.far and lens.fields.kind == "angle" and lens.object_distance is not None:
        raise PrescriptionError(
            "fields: an angle of a near object is that of its chief ray, and the entrance pupil is at infinity: all "
            "chief rays are parallel to the axis; give object_height"
        )
    if conditions.far and (lens.aperture.kind != "object_na" or lens.object_distance is None):
        raise PrescriptionError(
            f"aperture: the entrance pupil is at infinity (the stop, surface {lens.stop}, stands in the focal plane "
            f"of what is before it), so {lens.aperture.kind} says nothing; give object_na and a finite object_distance"
        )
    return lens.system, front


def with_image(lens: Lens, question: str) -> tuple[System, Front]:
    """As `with_pupil`; ImageError where the image is at infinity too; `question` begins the message."""
    numbers = with_pupil(lens)
    if image_is_far(lens):
        why = (
            "this lens is afocal (power 0)"
            if lens.object_distance is None
            else "its object is in the front focal plane"
        )
        raise ImageError(
            f"{question} needs an image at a finite distance, and the image is at infinity: {why}; "
            "add a focusing lens behind it"
        )
    return numbers


def image_is_far(lens: Lens) -> bool:
    """True where the image lies at infinity; False while JAX traces the numbers of the lens, when nothing can be
    known."""
    return not is_traced(lens) and bool(conditions_of(lens).image_far)


def conditions_of(lens: Lens) -> Conditions:
    """The conditions of a lens; traced where JAX traces its numbers."""
    return (_computed(lens.system.at(lens.system.primary)) if is_traced(lens) else _kept(lens))[1]


@functools.lru_cache(maxsize=REMEMBERED)
def _kept(lens: Lens) -> tuple[Front, Conditions]:
    front, conditions = _computed(lens.system.at(lens.system.primary))
    return front, jax.device_get(conditions)


@compiled
def _computed(system: System) -> tuple[Front, Conditions]:
    front = front_of(system)
    whole = paraxial.whole_matrix(system)
    far = ~jnp.isfinite(front.entrance.position)
    image_far = paraxial.image_slope(system, whole) == 0
    return front, Conditions(paraxial.is_afocal(whole), far, image_far, paraxial.exit_pupil(system).position)
