"""What is known of a lens before it is traced: its symmetries, and whether anything stops rays."""

from __future__ import annotations

import jax
import numpy as np

from lenstrace.optics.apertures import ApertureKind
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rows import Row
from lenstrace.sequential.system import System


def is_centred(lens: Lens) -> bool:
    """True where the lens is a body of revolution about its axis: nothing tilted or decentred, all apertures and phase
    screens round."""
    rows = (*lens.rows, lens.image)
    return not any(row.is_posed or row.aperture_kind is ApertureKind.RECTANGLE or _has_sides(row) for row in rows)


def is_mirrored(lens: Lens) -> bool:
    """True where the lens, and the light of all its fields, is its own mirror image in the plane x = 0."""
    return not np.any(jax.device_get(lens.fields.x)) and all(map(_is_mirrored, lens.rows))


def has_apertures(system: System) -> bool:
    """True where something may stop a ray."""
    return any(kind.aperture is not ApertureKind.NONE for kind in system.kinds)


def _is_mirrored(row: Row) -> bool:
    """Decentred in y and tilted about x only; a screen with sides may have any."""
    if _has_sides(row):
        return False
    moved = (row.decenter or (0.0, 0.0))[0], *(row.tilt or (0.0, 0.0, 0.0))[1:]
    return not np.any(jax.device_get(moved))


def _has_sides(row: Row) -> bool:
    """True where a phase screen is not known to be round."""
    return row.screen is not None and not row.screen.is_round
