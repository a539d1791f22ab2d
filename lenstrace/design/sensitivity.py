"""Sensitivities: what an error of every construction number of a lens does to its results, out of one Jacobian.

With the rays of a spot r, about their centroid, and their slopes j by a number, an error t of the number makes the RMS
sqrt(|r|^2 + 2 t r.j + t^2 |j|^2): no toleranced lens is traced. Independent errors, each as large as its tolerance on
average, make sqrt(|r|^2 + sum t^2 |j|^2). Source: Rimmer, Appl. Opt. 9, 533 (1970).
"""

from __future__ import annotations

import dataclasses
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import conditions_of, with_pupil
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree, static
from lenstrace.design.geometry_wants import semi_diameters
from lenstrace.design.places import Place, prepared, read, written
from lenstrace.design.pupil_wants import field_text
from lenstrace.design.sensitivities import Sensitivities, Sensitivity, Tolerances
from lenstrace.design.spot_wants import SpotRMS
from lenstrace.design.view import View
from lenstrace.errors import DesignError
from lenstrace.optics.made_media import Melt
from lenstrace.optics.media import Air
from lenstrace.sequential.lens import Lens

KINDS = ("radius", "thickness", "decenter", "tilt", "index", "abbe")


def sensitivity(
    lens: Lens, tolerances: Tolerances | None = None, *, refocus: bool = True, rings: int = 6
) -> Sensitivities:
    """What errors of construction do to focal lengths and spots, of every curvature, gap, surface position and glass.

    tolerances: sizes of the errors; those of `Tolerances` by default.
    refocus:    the last gap is adjusted for each error, for the least sum of the squares of what the error does to the
                rays of all spots; else the image surface stays where it is.
    rings:      of the pupil, hexapolar.
    Rays that the lens as designed loses do not count. LostRaysError where all of them, or all of one field, are lost;
    DesignError for a lens without a focal length.
    """
    tolerances = tolerances or Tolerances()
    lens = lens.astype("float64")
    with_pupil(lens)
    if conditions_of(lens).powerless:
        raise DesignError("sensitivity: the lens is afocal, and its spots and focal lengths are at infinity")
    errors = _errors(lens, tolerances)
    places = tuple(each.place for each in errors if each.place.kind not in ("index", "abbe"))
    whole = prepared(lens, (*places, _focus(lens)))
    want = SpotRMS(polychromatic=True, rings=rings).posed(whole, False)
    asked = _Asked(whole, want, tuple(each.place for each in errors))
    found = jax.device_get(_slopes(asked, np.zeros(len(errors) + 1)))
    if np.any(found.failure):
        want.counting(found.failure)
        # what the lens as designed loses does not count
        asked = dataclasses.replace(asked, want=dataclasses.replace(want, counted=1.0 * (found.failure == 0)))
        found = jax.device_get(_slopes(asked, np.zeros(len(errors) + 1)))
    fields = tuple(field_text(lens, field) for field in range(len(lens.fields.y)))
    return _summed(errors, found, refocus, fields)


class _Error(NamedTuple):
    """Of one number: where it stands, how large, and how it is said."""

    place: Place
    size: float
    name: str
    unit: str
    said: float


@pytree
class _Asked:
    lens: Lens
    want: Any
    places: tuple[Place, ...] = static()


class _Slopes(NamedTuple):
    """Focal lengths (2,), mean squares of the spots (F,); their slopes (2, P), and half of theirs (F, P); squares of
    the slopes of the rays (F, P), and their products with those by the image distance, the last number, (F, P).
    """

    lengths: Any
    squares: Any
    lengths_by: Any
    along: Any
    slopes: Any
    with_focus: Any
    failure: Any


def _errors(lens: Lens, tolerances: Tolerances) -> list[_Error]:
    """Errors of all numbers that matter."""
    found = []
    bending, edges = np.asarray(lens.system.bends), np.asarray(_edges(lens))
    for surface, (row, bends, edge) in enumerate(zip(lens, bending, edges, strict=True), 1):
        if bends:
            curvature = float(row.curvature)
            curved, flat = abs(curvature) * tolerances.radius, 2 * tolerances.flatness / edge**2
            place = Place("curvature", surface)
            if curved > flat:
                # a longer radius is less curvature, whatever its sign
                found.append(
                    _Error(place, -curvature * tolerances.radius, f"radius {surface}", "mm", curved / curvature**2)
                )
            else:
                found.append(_Error(place, flat, f"curvature {surface}", "1/mm", flat))
            for kind, part, unit in (("decenter", 1, "mm"), ("tilt", 0, "deg")):
                place, size = Place(kind, surface, part), getattr(tolerances, kind)
                found.append(_Error(place, size, place.label, unit, size))
        if surface < len(lens):
            found.append(
                _Error(Place("thickness", surface), *_said(tolerances.thickness, f"thickness {surface}", "mm"))
            )
        if not row.mirror and not isinstance(row.medium, Air):
            found.append(_Error(Place("index", surface), *_said(tolerances.index, f"index {surface}", "")))
            if len(lens.wavelengths.um) > 1:
                found.append(_Error(Place("abbe", surface), *_said(tolerances.abbe, f"Abbe number {surface}", "of it")))
    return [error for error in found if error.size != 0]


def _said(size: float, name: str, unit: str) -> tuple[float, str, str, float]:
    return size, name, unit, size


@compiled
def _edges(lens: Lens) -> jax.Array:
    """(S,), mm, how far from the axis light meets each surface; at least a tenth of the pupil's radius."""
    view = View(lens)
    return jnp.maximum(semi_diameters(view), view.pupil_radius / 10)


def _focus(lens: Lens) -> Place:
    return Place("thickness", len(lens))


def _with_errors(lens: Lens, places: tuple[Place, ...], errors: jax.Array) -> Lens:
    """The lens with errors of its numbers; of glasses as of a melt."""
    reference = lens.wavelengths.um[lens.wavelengths.primary]
    changed = dict(zip(places, jnp.unstack(errors), strict=True))
    melted = sorted({place.surface for place in places if place.kind in ("index", "abbe")})
    rows = list(lens.rows)
    for surface in melted:
        shift = changed.pop(Place("index", surface), 0.0)
        # a larger Abbe number is less dispersion
        spread = -changed.pop(Place("abbe", surface), 0.0)
        row = rows[surface - 1]
        rows[surface - 1] = dataclasses.replace(row, medium=Melt(row.medium, shift, spread, reference))
    lens = dataclasses.replace(lens, rows=tuple(rows))
    return written(lens, [(place, read(lens, place) + error) for place, error in changed.items()])


@compiled
def _slopes(asked: _Asked, zero: Any) -> _Slopes:
    places = (*asked.places, _focus(asked.lens))

    def results(errors: jax.Array) -> tuple[tuple[jax.Array, jax.Array], Any]:
        view = View(_with_errors(asked.lens, places, errors))
        first, spots = view.first_order, asked.want.measured(view)
        return (jnp.stack([first.focal_length, first.back_focal_length]), spots.residual), spots.failure

    def along(direction: jax.Array) -> Any:
        return jax.jvp(results, (zero,), (direction,), has_aux=True)

    unit = jnp.eye(len(zero), dtype=zero.dtype)
    (lengths, rays), (lengths_by, rays_by), failure = jax.vmap(along, out_axes=(None, -1, None))(unit)
    return _Slopes(
        lengths,
        jnp.sum(rays * rays, -1),
        lengths_by,
        jnp.einsum("fm,fmp->fp", rays, rays_by),
        jnp.einsum("fmp,fmp->fp", rays_by, rays_by),
        jnp.einsum("fm,fmp->fp", rays_by[..., -1], rays_by),
        failure,
    )


def _summed(errors: list[_Error], found: _Slopes, refocus: bool, fields: tuple[str, ...]) -> Sensitivities:
    # how far the image is moved for a unit of each error, and what the slopes then are
    total = np.sum(found.with_focus[:, -1])
    moved = -np.sum(found.with_focus, 0) / total if refocus and total > 0 else np.zeros(found.along.shape[1])
    along = found.along + moved * found.along[:, -1:]
    slopes = found.slopes + 2 * moved * found.with_focus + moved**2 * found.with_focus[:, -1:]
    rms = np.sqrt(found.squares)
    rows = []
    for i, error in enumerate(errors):
        linear, square = 2 * abs(error.size) * np.abs(along[:, i]), error.size**2 * np.maximum(slopes[:, i], 0)
        worse = np.sqrt(found.squares + linear + square) - rms
        focal, back = (float(a) * error.size for a in found.lengths_by[:, i])
        rows.append(Sensitivity(error.name, error.unit, error.said, focal, back, worse))
    sizes = np.array([error.size for error in errors])
    squares = found.squares + slopes[:, :-1] @ sizes**2
    lengths = np.sqrt(found.lengths_by[:, :-1] ** 2 @ sizes**2)
    rows.sort(key=lambda row: -row.worst)
    (focal, back), (focal_error, back_error) = map(float, found.lengths), map(float, lengths)
    return Sensitivities(tuple(rows), focal, back, rms, focal_error, back_error, np.sqrt(squares), refocus, fields)
