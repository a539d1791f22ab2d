"""From the document to the numbers: a `System` stacked out of the rows of a lens."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.errors import LensTraceError, MediumError
from lenstrace.pytree import is_traced
from lenstrace.sequential.document import DEGREE, Document
from lenstrace.sequential.rows import Row
from lenstrace.sequential.system import Interaction, Kind, Placement, System

# Slack in deciding that a tilt turns the axis beyond 90 degrees: a right angle itself does not.
TURNED = -1e-9


def build_system(lens: Document) -> System:
    """The system of a lens. In numpy, unless JAX traces one of the numbers.

    Glass formulas are evaluated here: MediumError (WavelengthError) names the surface.
    """
    rows = (*lens.rows, lens.image)
    index = _indices(lens)
    # one list of powers for all aspheres, so that neighbours share a loop whatever terms they have
    powers = tuple(sorted({power for row in rows for power in row.powers}))
    return System(
        curvature=_stack(row.curvature for row in rows),
        conic=_stack(row.conic for row in rows),
        coefficients=_table([[row.asphere.get(power, 0.0) for power in powers] for row in rows]),
        thickness=_stack(row.thickness for row in lens.rows),
        index=index,
        decenter=_table([row.decenter for row in rows]),
        tilt=_table([row.tilt for row in rows]) * DEGREE,
        aperture=_table([row.aperture for row in rows], 2),
        object_distance=None if lens.object_distance is None else _number(lens.object_distance),
        stop_size=_number(lens.aperture.value),
        fields=_table(list(zip(lens.fields.x, lens.fields.y, strict=True))) * lens.fields.scale,
        weights=_stack(lens.wavelengths.weights),
        kinds=tuple(_kind(row, index, i, powers) for i, row in enumerate(rows)),
        bends=tuple(row.mirror or _changes(index, i) for i, row in enumerate(lens.rows)),
        stop=lens.stop,
        primary=lens.wavelengths.primary,
        aperture_kind=lens.aperture.kind,
        field_kind=lens.fields.kind,
        ray_aiming=lens.ray_aiming,
    )


def _indices(lens: Document) -> Any:
    """(W, S + 1): the object space, then the medium behind each surface; a mirror repeats the one before."""
    media = [("object space", lens.object_medium)]
    for number, row in enumerate(lens.rows, 1):
        media.append(media[-1] if row.mirror else (f"surface {number}", row.medium))
    known: dict[int, list[Any]] = {}
    for where, medium in media:
        if id(medium) in known:
            continue
        try:
            known[id(medium)] = [medium.index(um) for um in lens.wavelengths.um]
        except LensTraceError as error:
            raise type(error)(f"{where}: {error}") from None
        if any(not isinstance(n, jax.Array) and not (np.isfinite(n) and n != 0) for n in known[id(medium)]):
            raise MediumError(
                f"{where}: the index of {medium.name} must be finite and not 0, got {float(known[id(medium)][0]):g}"
            )
    return _table([[known[id(medium)][w] for _, medium in media] for w in range(len(lens.wavelengths.um))])


def _kind(row: Row, index: Any, place: int, powers: tuple[int, ...]) -> Kind:
    """The structure of the surface at `place`, counted from 0; the image is the last and bends nothing."""
    interaction = Interaction.REFRACT
    if row.mirror:
        interaction = Interaction.REFLECT
    elif is_traced(index) or (index[:, place] * index[:, min(place + 1, index.shape[1] - 1)] < 0).any():
        interaction = Interaction.REFRACT_EITHER_SIGN
    placement = Placement.CENTRED
    if row.is_break:
        placement = Placement.BREAK
    elif row.is_posed:
        placement = Placement.POSED
    return Kind(
        powers if row.powers else (),
        interaction,
        row.aperture_kind,
        placement,
        placement is not Placement.CENTRED and _turns(row),
    )


def _turns(row: Row) -> bool:
    """True where a tilt turns the axis by more than 90 degrees; a traced tilt counts as small."""
    if is_traced(row.tilt):
        return False
    return bool(np.prod(np.cos(np.array(row.tilt[:2], float) * DEGREE)) < TURNED)


def _changes(index: Any, place: int) -> bool:
    """True where the index before and behind a surface differ at any wavelength; traced indices count as different."""
    if is_traced(index):
        return True
    return bool((index[:, place] != index[:, place + 1]).any())


def _number(value: Any) -> Any:
    """A scalar array."""
    return value if isinstance(value, jax.Array) else np.asarray(value, float)


def _stack(values: Iterable[Any]) -> Any:
    """One array out of numbers; jnp only where JAX holds one of them."""
    values = list(values)
    if any(isinstance(value, jax.Array) for value in values):
        return jnp.stack([jnp.asarray(value, float) for value in values])
    return np.array(values, float)


def _table(rows: Sequence[Sequence[Any]], width: int = 0) -> Any:
    """(len(rows), widest row) array, padded with zeros."""
    width = max([width, *(len(row) for row in rows)])
    flat = _stack(value for row in rows for value in (*row, *[0.0] * (width - len(row))))
    return flat.reshape(len(rows), width)
