"""A camera that takes pictures through a lens as it is prescribed: stopped down, focused, its pupil found.

What its rays are is said in `through_lens.py`, where the numbers made here are used.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced
from lenstrace.errors import CameraError, WavelengthError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.scene.cameras.focusing import focused
from lenstrace.scene.cameras.pupil import PupilFound, PupilSearch, search
from lenstrace.scene.cameras.through_lens import LensCamera
from lenstrace.scene.cameras.view import View
from lenstrace.scene.dispersion import Dispersion, dispersions_of
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reversed import reversed_lens
from lenstrace.sequential.rows import Number, Row
from lenstrace.sequential.system import Placement, System

FULL_FRAME = 24.0
"""The shorter side of 35 mm film, mm."""

SEARCHED_UM = (0.4,)  # beside the primary wavelength: the pupil is a little another one, in blue light most
# A stop that is opened beyond what the rims let through on the axis is not open: so much less is allowed.
HINDERED = 0.97


def lens_camera(
    lens: Lens,
    position: tuple[Number, Number, Number],
    target: tuple[Number, Number, Number],
    up: tuple[Number, Number, Number] = (0.0, 1.0, 0.0),
    *,
    film: Number = FULL_FRAME,
    focus: Number | None = math.inf,
    f_number: Number | None = None,
    unit_mm: float = 1.0,
    aspect: float = 2.0,
    rims: bool = True,
    irradiance: bool = False,
    colour: bool = True,
    fresnel: bool = False,
    absorption: Mapping[int, Number] | None = None,
) -> LensCamera:
    """A camera that looks through a lens.

    position:    of the entrance pupil: the picture has the perspective of a pinhole there.
    target, up:  a point on the axis; what is upright in the picture.
    film:        the shorter side of the film, mm. The film is plane, whatever image surface the lens has.
    focus:       from the film to the sharp plane along the axis, lengths of the scene; inf is allowed. None leaves the
                 film where the lens has its image surface.
    f_number:    f' over the diameter of the entrance pupil; None: as the lens has it.
    unit_mm:     mm in a length of the scene.
    aspect:      the longer side of pictures over the shorter one, at most: how far the pupil is looked for.
    rims:        a semi_diameter is the rim of its surface, and stops light. False: apertures alone do, as in all other
                 traces. The radius of the stop follows from f_number or the aperture of the lens.
    irradiance:  weights give the irradiance of the film for the radiance of the scene, about pi / (4 N^2) of it. False:
                 it is divided by what it is in the middle of a clear lens, so that a white wall of radiance 1 is 1
                 there whatever the stop, as a pinhole shows it; what is darker toward the corners stays so.
    colour:      each sample has a wavelength, with the indices of the glasses there. False: all have the primary one,
                 without colour fringes and their noise.
    fresnel:     surfaces reflect as without coatings.
    absorption:  1/mm, of the media behind surfaces, by their numbers in the lens: light falls by exp(-a t).

    Numbers of the lens, and those given here, may be traced by JAX: then nothing is checked.
    CameraError where the lens takes no such picture; PrescriptionError for a row with break = true.
    """
    _check(position, target, up, film, unit_mm, aspect)
    opened = focused(lens.astype(np.float64), focus, f_number=f_number, unit_mm=unit_mm)
    _check_film(opened)
    prepared = dataclasses.replace(
        opened,
        rows=_with_stop(opened),
        clip_at_semi_diameters=rims or lens.clip_at_semi_diameters,
    )
    turned = reversed_lens(prepared)
    system = turned.system.at(turned.system.primary)
    dispersion = _dispersion(turned)
    round_apertures = all(kind.aperture is not ApertureKind.RECTANGLE for kind in system.kinds)
    index = jnp.asarray(system.index)[None]
    if dispersion is not None:
        others = jax.tree.map(lambda a: a[:, None], dispersion).index(np.asarray(SEARCHED_UM))
        index = jnp.concatenate([index, others.T])
    widest = jnp.asarray(film) / 2 * math.sqrt(1 + aspect * aspect)
    found = search(
        PupilSearch(
            system,
            index,
            jnp.asarray(prepared.aperture.value, float),
            jnp.asarray(widest, float),
            _is_round(turned, system) and round_apertures,
            round_apertures,
            is_traced(prepared),
        )
    )
    if not is_traced(found):
        _check_pupil(found, f_number)
    ahead, sign = _outside(prepared.system.at(prepared.system.primary))
    # radiance over n^2 is what stays the same
    ratio = system.index[0] / system.index[-1]
    gain = ratio * ratio if irradiance else 1 / found.irradiance
    camera = LensCamera(
        View(*(tuple(jnp.asarray(a, float) for a in each) for each in (position, target, up))),  # type: ignore[arg-type]
        system,
        dispersion if colour else None,
        jnp.asarray(film, float) / 2 * sign,
        ahead,
        found.chief,
        found.marginal,
        found.bound,
        gain,
        jnp.asarray(unit_mm, float),
        _absorption(lens, absorption),
        fresnel,
    )
    return camera.astype(float)


def _with_stop(lens: Lens) -> tuple[Row, ...]:
    """The rows, what stops light at the stop no wider than its radius."""
    radius = lens.aperture.value
    rows = []
    for row in lens.rows:
        if not row.stop:
            rows.append(row)
            continue
        kind = row.aperture_kind
        sizes: tuple[Any, ...] = row.aperture
        match kind:
            case ApertureKind.NONE:
                kind, sizes = ApertureKind.CIRCLE, (radius,)
            case ApertureKind.CIRCLE:
                sizes = (_smaller(sizes[0], radius),)
            case ApertureKind.OBSCURATION:
                kind, sizes = ApertureKind.ANNULUS, (sizes[0], radius)
            case ApertureKind.ANNULUS:
                sizes = (sizes[0], _smaller(sizes[1], radius))
            case ApertureKind.RECTANGLE:
                raise CameraError(
                    "the stop has a rectangular aperture, and a stop that follows from an f-number is round; "
                    "give the rectangle to a row of its own beside it"
                )
        if kind is ApertureKind.ANNULUS and not is_traced(sizes) and sizes[0] >= sizes[1]:
            raise CameraError(
                f"the stop is open from {sizes[0]:g} to {sizes[1]:g} mm, that is not at all; take a smaller f_number"
            )
        rows.append(dataclasses.replace(row, aperture_kind=kind, aperture=sizes))
    return tuple(rows)


def _smaller(a: Number, b: Number) -> Number:
    return jnp.minimum(a, b) if is_traced((a, b)) else min(a, b)


def _dispersion(lens: Lens) -> Dispersion | None:
    """Of the media of a lens; None where one of them is dark."""
    media = [lens.object_medium]
    for row in lens.rows:
        media.append(media[-1] if row.mirror else row.medium)
    try:
        return dispersions_of(media)
    except WavelengthError:
        return None


def _is_round(lens: Lens, system: System) -> bool:
    """Whether it is one of revolution."""
    screens = all(row.screen is None or row.screen.is_round for row in lens.rows)
    return screens and all(kind.placement is Placement.CENTRED for kind in system.kinds)


@compiled
def _outside(system: System) -> tuple[jax.Array, jax.Array]:
    """From the entrance pupil to the first vertex, mm along the view, 0 for a pupil at infinity; +1 for an upright
    image, else -1. The lens as given, at one wavelength."""
    entrance = paraxial.entrance_pupil(system).position
    far = system.object_distance is None
    size = paraxial.first_order(system).object_focal_length if far else paraxial.magnification(system)
    return jnp.where(jnp.isfinite(entrance), entrance, 0), jnp.where(size > 0, 1, -1)


def _absorption(lens: Lens, given: Mapping[int, Number] | None) -> jax.Array | None:
    """(S + 1,), in the order of light that runs backward."""
    if given is None:
        return None
    for surface, value in given.items():
        if isinstance(surface, bool) or not isinstance(surface, int) or not 0 <= surface <= len(lens):
            raise CameraError(f"absorption: surface {surface!r} does not exist; this lens has 1 to {len(lens)}")
        if not is_traced(value) and not (math.isfinite(value) and value >= 0):
            raise CameraError(f"absorption: behind surface {surface} must not be negative, 1/mm, got {value}")
    forward = [given.get(surface, 0.0) for surface in range(len(lens) + 1)]
    return jnp.stack([jnp.asarray(value, float) for value in reversed(forward)])


def _check(position: Any, target: Any, up: Any, film: Any, unit_mm: Any, aspect: Any) -> None:
    if is_traced((position, target, up, film, unit_mm, aspect)):
        return
    for name, value in (("film", film), ("unit_mm", unit_mm), ("aspect", aspect)):
        if not (math.isfinite(value) and value > 0):
            raise CameraError(f"{name} must be positive, got {value}")
    if aspect < 1:
        raise CameraError(f"aspect is the longer side over the shorter one, at least 1, got {aspect}")
    View(position, target, up).require_axes()


def _check_film(lens: Lens) -> None:
    distance = lens.rows[-1].thickness
    if not is_traced(distance) and lens.system.orientation[-1] * distance <= 0:
        raise CameraError(
            f"the film would stand {float(distance):g} mm behind the last surface; give a focus that the lens has"
        )


def _check_pupil(found: PupilFound, f_number: Number | None) -> None:
    if not math.isfinite(float(found.marginal)) or not math.isfinite(float(found.chief)):
        raise CameraError("the film stands in the image of the stop: every point of it sees the stop as one point")
    if not float(found.irradiance) > 0:
        raise CameraError("no light reaches the middle of the film; open the stop, or look at apertures and rims")
    if f_number is not None and float(found.reach) < HINDERED:
        raise CameraError(
            f"f_number {float(f_number):g} opens the stop wider than the rims of this lens let light through on the "
            f"axis, about f/{float(f_number) / float(found.reach):.3g}; take that, or rims=False"
        )
