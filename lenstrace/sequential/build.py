"""From the document to the numbers: a `System` stacked out of the rows of a lens."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import is_traced
from lenstrace.errors import LensTraceError, MediumError, PrescriptionError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.interactions import Interaction
from lenstrace.optics.media import Constant, Medium
from lenstrace.sequential.document import DEGREE, Document
from lenstrace.sequential.rows import Row
from lenstrace.sequential.system import Kind, Light, Placement, System

# Of norm radii, mm: their 15th powers stay finite, in either direction.
LARGEST_EXPONENT = 60
MM_PER_UM = 1e-3


def build_system(lens: Document) -> System:
    """The system of a lens. In numpy, unless JAX traces one of the numbers.

    Glass formulas are evaluated here: MediumError (WavelengthError) names the surface.
    """
    rows = (*lens.rows, lens.image)
    media = _media(lens)
    index = _indices(media, lens.wavelengths.um)
    if lens.aperture.kind == "object_na" and not is_traced((index, lens.aperture.value)):
        limit = float(np.abs(index[:, 0]).min())
        if lens.aperture.value >= limit:
            got = f"{float(lens.aperture.value):g}"
            raise PrescriptionError(
                f"aperture: object_na must be below the index of the object space, {limit:g}, got {got}"
            )
    # one list of powers for all aspheres, so that they are one kind whatever terms they have
    powers = tuple(sorted({power for row in rows for power in row.powers}))
    terms = _table([[row.asphere.get(power, 0.0) for power in powers] for row in rows])
    exponent = _norm_exponents(terms, powers)
    openings = [*map(lens.opening, lens.rows), (lens.image.aperture_kind, lens.image.aperture)]
    return System(
        curvature=_stack(row.curvature for row in rows),
        conic=_stack(row.conic for row in rows),
        coefficients=terms * _power_of_two(exponent[:, None] * (np.array(powers, int) - 1)),
        norm_radius=_power_of_two(exponent),
        thickness=_stack(row.thickness for row in lens.rows),
        index=index,
        wavelength=_stack(um * MM_PER_UM for um in lens.wavelengths.um),
        decenter=_table([row.decenter or (0.0, 0.0) for row in rows]),
        tilt=_table([row.tilt or (0.0, 0.0, 0.0) for row in rows]) * DEGREE,
        aperture=_table([sizes for _, sizes in openings], 2),
        object_distance=None if lens.object_distance is None else _number(lens.object_distance),
        stop_size=_number(lens.aperture.value),
        fields=_table(list(zip(lens.fields.x, lens.fields.y, strict=True))) * lens.fields.scale,
        weights=_stack(lens.wavelengths.weights),
        screens=tuple(jax.tree.map(_number, row.screen.prepared()) for row in rows if row.screen is not None),
        kinds=tuple(
            _kind(row, opening, before, behind, powers, screen)
            for row, (opening, _), (before, behind), screen in zip(
                rows, openings, itertools.pairwise((*media, media[-1])), _screen_places(rows), strict=True
            )
        ),
        stop=lens.stop,
        primary=lens.wavelengths.primary,
        aperture_kind=lens.aperture.kind,
        field_kind=lens.fields.kind,
        ray_aiming=lens.ray_aiming,
    )


def _media(lens: Document) -> list[tuple[str, Medium]]:
    """Where, and which: the object space, then the medium behind each surface; a mirror keeps the one before."""
    media: list[tuple[str, Medium]] = [("object space", lens.object_medium)]
    for number, row in enumerate(lens.rows, 1):
        media.append(media[-1] if row.mirror else (f"surface {number}", row.medium))
    return media


def light_of(lens: Document, um: Sequence[float] | np.ndarray) -> Light:
    """Of any wavelengths, in the precision of the lens. MediumError (WavelengthError) names the surface."""
    light = Light(_indices(_media(lens), [float(each) for each in um]), np.asarray(um, float) * MM_PER_UM)
    return jax.tree.map(lambda a: a.astype(lens.precision), light)


def _indices(media: list[tuple[str, Medium]], wavelengths: Sequence[float]) -> Any:
    """(W, S + 1). Each medium is evaluated once. MediumError (WavelengthError) names the surface."""
    known: dict[int, list[Any]] = {}
    for where, medium in media:
        if id(medium) in known:
            continue
        try:
            known[id(medium)] = [medium.index(um) for um in wavelengths]
        except LensTraceError as error:
            raise type(error)(f"{where}: {error}") from None
        if any(not isinstance(n, jax.Array) and not (np.isfinite(n) and n != 0) for n in known[id(medium)]):
            got = float(known[id(medium)][0])
            raise MediumError(f"{where}: the index of {medium.name} must be finite and not 0, got {got:g}")
    return _table([[known[id(medium)][w] for _, medium in media] for w in range(len(wavelengths))])


def _norm_exponents(terms: Any, powers: tuple[int, ...]) -> Any:
    """(K,) of int, e where the terms (K, T) of an asphere are taken in r / 2^e: the smallest radius at which one of its
    terms above the first power has a sag as large as it; 0 where there are none. Nothing is differentiated through it.
    """
    xp = jnp if is_traced(terms) else np
    terms = jax.lax.stop_gradient(terms) if is_traced(terms) else terms
    above = np.array(powers, int) > 1
    counted = above & (terms != 0)
    logarithm = xp.log2(xp.abs(xp.where(counted, terms, 1.0))) / np.where(above, 1.0 - np.array(powers, int), 1.0)
    least = xp.min(xp.where(counted, logarithm, np.inf), -1, initial=np.inf)
    least = xp.where(xp.isfinite(least), least, 0.0)
    return xp.clip(xp.round(least), -LARGEST_EXPONENT, LARGEST_EXPONENT).astype(int)


def _power_of_two(exponent: Any) -> Any:
    """2^exponent, exactly."""
    return jnp.ldexp(jnp.ones(exponent.shape), exponent) if is_traced(exponent) else np.ldexp(1.0, exponent)


def _kind(
    row: Row,
    opening: ApertureKind,
    before: tuple[str, Medium],
    behind: tuple[str, Medium],
    powers: tuple[int, ...],
    screen: int | None,
) -> Kind:
    """The structure of a surface between two media."""
    interaction = Interaction.REFRACT
    if row.mirror:
        interaction = Interaction.REFLECT
    elif _sign(before[1]) != 1 or _sign(behind[1]) != 1:
        interaction = Interaction.REFRACT_EITHER_SIGN
    placement = Placement.CENTRED
    if row.is_break:
        placement = Placement.BREAK
    elif row.is_posed:
        placement = Placement.POSED
    return Kind(powers if row.powers else (), interaction, opening, placement, row.turned, screen=screen)


def _screen_places(rows: Sequence[Row]) -> list[int | None]:
    """Which of the screens each row carries."""
    count = itertools.count()
    return [None if row.screen is None else next(count) for row in rows]


def _sign(medium: Medium) -> int:
    """+1 for an index known to be positive, else -1: only a constant can be negative, or be traced and unknown."""
    return 1 if not isinstance(medium, Constant) or (not is_traced(medium) and medium.n > 0) else -1


def _number(value: Any) -> Any:
    """A scalar array."""
    return value if is_traced(value) else np.asarray(value, float)


def _stack(values: Iterable[Any]) -> Any:
    """One array out of numbers; jnp only where JAX holds one of them."""
    values = list(values)
    return _stacked(values) if is_traced(values) else np.array(values, float)


@jax.jit
def _stacked(values: list[Any]) -> jax.Array:
    return jnp.stack([jnp.asarray(value, float) for value in values])


def _table(rows: Sequence[Sequence[Any]], width: int = 0) -> Any:
    """(len(rows), widest row) array, padded with zeros."""
    width = max([width, *(len(row) for row in rows)])
    flat = _stack(value for row in rows for value in (*row, *[0.0] * (width - len(row))))
    return flat.reshape(len(rows), width)
