"""What a question needs of a lens, asked before it is traced: a pupil to aim at, an image to look at."""

from __future__ import annotations

import contextlib
import functools

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compiled import compiled, is_outermost
from lenstrace.errors import ImageError, PrescriptionError
from lenstrace.pytree import is_traced
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System

# Lenses whose answers are kept, so that the next question of the same lens does not wait for them.
REMEMBERED = 64


def require_pupil(lens: Lens) -> None:
    """ImageError or PrescriptionError where rays cannot be launched, because the entrance pupil is not to be had.

    While JAX traces the numbers of a lens nothing can be known of them, and nothing is raised.
    """
    found = _known(lens)
    if found is None:
        return
    powerless, far, image_far = found
    if lens.aperture.kind == "image_f_number" and powerless:
        raise ImageError(
            "aperture: image_f_number needs a focal length, and this lens is afocal (power 0); "
            "give entrance_pupil_diameter"
        )
    if lens.fields.kind == "image_height" and image_far:
        raise ImageError("fields: image_height needs an image at a finite distance, and it is at infinity; give angles")
    if far and lens.fields.kind == "angle" and lens.object_distance is not None:
        raise PrescriptionError(
            "fields: an angle of a near object is that of its chief ray, and the entrance pupil is at infinity: all "
            "chief rays are parallel to the axis; give object_height"
        )
    if far and (lens.aperture.kind != "object_na" or lens.object_distance is None):
        raise PrescriptionError(
            f"aperture: the entrance pupil is at infinity (the stop, surface {lens.stop}, stands in the focal plane "
            f"of what is before it), so {lens.aperture.kind} says nothing; give object_na and a finite object_distance"
        )


def require_image(lens: Lens, question: str) -> None:
    """ImageError where the image of the lens is at infinity; `question` begins the message."""
    require_pupil(lens)
    found = _known(lens)
    if found is not None and found[2]:
        why = (
            "this lens is afocal (power 0)"
            if lens.object_distance is None
            else "its object is in the front focal plane"
        )
        raise ImageError(
            f"{question} needs an image at a finite distance, and the image is at infinity: {why}; "
            "add a focusing lens behind it"
        )


def _known(lens: Lens) -> tuple[bool, bool, bool] | None:
    return None if is_traced(lens) else _found(lens)


@functools.lru_cache(maxsize=REMEMBERED)
def _found(lens: Lens) -> tuple[bool, bool, bool]:
    """Whether the lens has no power, its entrance pupil is at infinity, its image is."""
    # the lens is known even where a `jit` around the question traces other things
    with jax.ensure_compile_time_eval() if not is_outermost(lens) else contextlib.nullcontext():
        powerless, far, image_far = np.asarray(_flags(lens.system.at(lens.system.primary)))
    return bool(powerless), bool(far), bool(image_far)


@compiled
def _flags(system: System) -> jax.Array:
    pupil = paraxial.entrance_pupil(system)
    return jnp.stack(
        [paraxial.first_order(system).power == 0, ~jnp.isfinite(pupil.position), paraxial.image_slope(system) == 0]
    )
