"""What a reader must know of a result by waves: how it may be wrong, in one sentence each, said alike everywhere.

A result keeps its sentences as `notes`; each is an `AccuracyWarning` too. While JAX traces the numbers there are none.
"""

from __future__ import annotations

import warnings

import jax
import numpy as np

from lenstrace.analysis.pupil_function import MOST_STEP, PupilFunction
from lenstrace.compute.pytree import is_traced
from lenstrace.errors import AccuracyWarning
from lenstrace.sequential.lens import Lens

# Of a transform: contrast, and density, are wrong by about as much as rays miss their nodes, in units of the pupil's
# half width. Beyond, there is no figure.
MOST_MISSED = 1e-2
# Wavelengths, RMS: 0.01 takes 0.4 % from the Strehl ratio of a perfect lens, more from that of one less perfect.
MOST_ROUNDED = 0.01
# RMS error of path differences over eps times the path along the axis, both in wavelengths: 0.05 to 0.07 of a
# double Gauss, a triplet and three mirrors in float32, 0.007 of two mirrors, 0.2 of a lens as in phones.
ROUNDED = 1 / 16
MM_PER_UM = 1e-3


def rounding(lens: Lens) -> float:
    """About the RMS error that rounding leaves in path differences, wavelengths: ROUNDED times eps times the path.

    The path is that along the axis from the first vertex to the image, the sum of |n t|.
    """
    system = lens.system
    thickness, index = np.asarray(system.thickness, float), np.asarray(system.index, float)
    path = np.max(np.sum(np.abs(thickness * index[:, 1 : 1 + len(thickness)]), -1))
    eps = float(np.finfo(system.curvature.dtype).eps)
    return ROUNDED * eps * path / (min(map(float, lens.wavelengths.um)) * MM_PER_UM)


def rounding_notes(lens: Lens) -> tuple[str, ...]:
    """That the precision of a lens does not carry its optical paths."""
    if is_traced(lens):
        return ()
    waves = rounding(lens)
    if waves <= MOST_ROUNDED:
        return ()
    name = np.dtype(lens.system.curvature.dtype).name
    return (
        f"rounding: in {name} the path differences of this lens may be wrong by {waves:.1g} waves; trace it in float64",
    )


def transform_notes(lens: Lens, pupil: PupilFunction, *, what: str) -> tuple[str, ...]:
    """What is wrong with a transform of a pupil function; `what` says what becomes of fields that are too distorted."""
    if is_traced(pupil) or is_traced(lens):
        return ()
    notes = []
    bad = np.flatnonzero((~np.asarray(trusted(pupil)) & (np.asarray(pupil.energy) > 0)).any(-1))
    if len(bad):
        fields = ", ".join(f"({float(lens.fields.x[f]):g}, {float(lens.fields.y[f]):g})" for f in bad)
        missed = np.max(np.asarray(pupil.distorted)[bad])
        notes.append(
            f"field {fields} {lens.fields.unit}: rays miss their nodes by {missed:.1g} of the pupil, too distorted for "
            f"a transform: {what}"
        )
    good = np.asarray(trusted(pupil))
    step = float(np.max(np.asarray(pupil.step), initial=0.0, where=good))
    if step > MOST_STEP:
        notes.append(
            f"samples: the path changes by {step:.2g} wavelengths from one cell of the pupil to the next, more than "
            f"{MOST_STEP:g}: too coarse for a transform; give more samples"
        )
    return (*notes, *rounding_notes(lens))


def trusted(pupil: PupilFunction) -> jax.Array:
    """(F, W): where the rays came near enough to the nodes of the grid."""
    return pupil.distorted <= MOST_MISSED


def warned(notes: tuple[str, ...]) -> tuple[str, ...]:
    """The notes, each given as a warning at the caller of a function of this package."""
    for note in notes:
        warnings.warn(note, AccuracyWarning, stacklevel=3)
    return notes
