"""Fermat's principle: the optical path of a ray does not change when its corners are displaced a little.

All first derivatives of the optical path by displacements of the corners along their surfaces are 0. The second ones
say what kind of extremum it is: each focus that the light beside the ray runs through before the path ends makes the
path longer than its neighbours in one more direction (Morse), in the plane of incidence and across it. So a path to
the first focus is a minimum, and none beyond it; see `foci` for the closed forms.
Source: M. Born, E. Wolf, Principles of Optics, section 3.3.2; M. Morse, The Calculus of Variations in the Large (1934).
"""

from __future__ import annotations

from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.compiled import compiled
from lenstrace.errors import OptionError
from lenstrace.phenomena.bending.broken_path import BrokenPath, corners, optical_path, path_of_ray
from lenstrace.phenomena.bending.foci import foci
from lenstrace.phenomena.demonstration import RELATIVE_TOLERANCE, Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential import prescription
from lenstrace.sequential.lens import Lens

# Rounding of a direction, which a derivative is made of: so many units in the last place of the whole lens, over the
# shortest piece of the path.
ROUNDING = 16 * float(np.finfo(float).eps)
COUNTED = 0.0  # difference of two counts that agree
# A focus nearer to a corner or the end than this part of the piece leaves a direction in which the path is flat.
AT_FOCUS = 1e-9
STEPS = np.linspace(-1, 1, 21)  # of the displacements drawn
# The largest of them: of the path through the lens, and of the pieces beside a corner.
SHIFT, OF_PIECE = 1e-3, 0.1
NEIGHBOUR = 0.3  # of the height of each corner: displacement of the path drawn beside the ray
# Surfaces are drawn so much higher than the ray, but not beyond this part of their rim.
HIGHER, OF_RIM = 1.25, 0.98
LEAST = 0.1  # of the path through the lens: half height of what is drawn
POINTS = np.linspace(-1, 1, 41)  # along the profile of a surface
BEFORE = 0.3  # of the path through the lens: what is drawn of light from afar
FAR = 10.0  # times that: where a source is too far away to be drawn


@result
class Fermat(Demonstration):
    """The path of the ray, one beside it, and how the optical path changes with displacements.

    path, neighbour:  (2, B + 2), z and y, mm, from the light before the lens to the end.
    surfaces:         (B,), numbers of those with corners.
    profiles:         (2, P, B), z and y of these, mm.
    filled:           places of the surfaces that glass follows.
    shifts, waves:    (B + 1, D), displacements in the plane of one corner, mm, and what they add to the path,
                      wavelengths; last of all corners in the softest direction, by the largest displacement.
    waves_theory:     (B + 1, D), the parabolas of the second derivatives.
    """

    path: np.ndarray
    neighbour: np.ndarray
    surfaces: np.ndarray
    profiles: np.ndarray
    filled: tuple[int, ...]
    shifts: np.ndarray
    waves: np.ndarray
    waves_theory: np.ndarray


@demonstration
def fermat(
    lens: Lens | None = None,
    field: Annotated[float, Option("field, in parts of the largest one", least=-1, most=1)] = 1.0,
    pupil: Annotated[float, Option("height in the pupil, in parts of its radius", least=-1, most=1)] = 0.8,
    end: Annotated[float, Option("where the path ends, in parts of the way to the image", least=1e-3, most=3)] = 0.7,
) -> Fermat:
    """Fermat's principle: the path of a ray is stationary, and a minimum up to its focus.

    OptionError for a ray that fails or leaves the y-z plane, surfaces that touch on it, a path that ends on a focus.
    """
    lens = lens or _singlet()
    path = path_of_ray(lens, field, pupil, end)
    count = len(path.corners)
    with np.errstate(divide="ignore", invalid="ignore"):
        theory = foci(path)
    flat = abs(theory.bent * path.lengths[1:, None]) <= AT_FOCUS * abs(path.index[1:, None])
    if flat.any() or not np.isfinite(theory.bent).all():
        raise OptionError("fermat: the path ends, or has a corner, on a focus; choose another end, field or pupil")
    first, second = jax.device_get(_derivatives(path, jnp.zeros((count, 2))))
    alone = second[np.arange(count), :, np.arange(count), :]
    second = second.reshape(2 * count, 2 * count)
    values, modes = np.linalg.eigh(second)

    patterns = _patterns(path, modes[:, 0])
    flat_patterns = patterns.reshape(count + 1, -1)
    curvatures = np.einsum("pi,ij,pj->p", flat_patterns, second, flat_patterns)
    longer, beside, profiles = jax.device_get(
        _drawn(path, *map(jnp.asarray, (patterns, _aside(path), _along_profiles(path, lens))))
    )
    wave = 1e-3 * lens.wavelengths.um[lens.wavelengths.primary]
    lead = BEFORE * abs(path.lengths[1:]).sum()
    if path.near and abs(path.lengths[0]) < FAR * lead:
        lead = path.lengths[0]
    before = path.points[1] - lead * path.directions[0]
    aside = before + beside[0] - path.points[1] if lead != path.lengths[0] else before

    size = abs(path.points[1:]).max()
    shortest = abs(path.lengths[0 if path.near else 1 :]).min()
    within = ROUNDING * abs(path.index).max() * size / shortest
    negative, by_foci = int((values < 0).sum()), int((theory.bent < 0).sum())
    rows = [Comparison("largest derivative of the optical path by a corner", "", abs(first).max(), 0, within)]
    for i, number in enumerate(path.numbers):
        rows += [
            Comparison(
                f"surface {number}: second derivative, {where}",
                "1/mm",
                alone[i, k, k],
                theory.second[i, k],
                RELATIVE_TOLERANCE * theory.terms[i, k],
            )
            for k, where in enumerate(("tangential", "sagittal"))
        ]
    rows.append(Comparison("directions in which the path is a maximum", "", negative, by_foci, COUNTED))
    return Fermat(
        setting=f"{lens.name or 'a lens'}, field {field:g} and pupil {pupil:g} of the largest; the path to {end:g} of "
        f"the way to the image is {_kind(negative, 2 * count)}",
        rows=tuple(rows),
        path=np.stack([before, *path.points[1:]])[:, :0:-1].T,
        neighbour=np.stack([aside, *beside, path.end])[:, :0:-1].T,
        surfaces=path.numbers,
        profiles=np.moveaxis(profiles[..., :0:-1], -1, 0),
        filled=tuple(int(i) for i in np.flatnonzero(path.index[1:-1] != 1)),
        shifts=abs(patterns).max((1, 2))[:, None] * STEPS,
        waves=longer / wave,
        waves_theory=curvatures[:, None] * STEPS**2 / 2 / wave,
    )


@compiled
def _derivatives(path: BrokenPath, displaced: jax.Array) -> tuple[jax.Array, jax.Array]:
    """First, (B, 2), and second, (B, 2, B, 2), of the optical path by displacements; pure numbers and 1/mm."""
    return jax.grad(optical_path, 1)(path, displaced), jax.hessian(optical_path, 1)(path, displaced)


@compiled
def _drawn(
    path: BrokenPath, patterns: jax.Array, aside: jax.Array, along: jax.Array
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """What patterns of displacements (B + 1, B, 2) at STEPS of their size add to the path, mm; the corners displaced
    aside; the profiles."""

    def longer(displaced: jax.Array) -> jax.Array:
        return optical_path(path, displaced) - optical_path(path, 0 * displaced)

    def at_steps(pattern: jax.Array) -> jax.Array:
        return jax.vmap(lambda step: longer(step * pattern))(jnp.asarray(STEPS))

    return jax.vmap(at_steps)(patterns), corners(path, aside), jax.vmap(lambda each: corners(path, each))(along)


def _patterns(path: BrokenPath, softest: np.ndarray) -> np.ndarray:
    """(B + 1, B, 2), the largest displacements drawn, mm: of each corner in the plane, and of all in a direction."""
    inner = abs(path.lengths[1:])
    before = np.append(abs(path.lengths[0]) if path.near else np.inf, inner[:-1])
    largest = np.minimum(SHIFT * inner.sum(), OF_PIECE * np.minimum(inner, before))
    softest = softest.reshape(-1, 2)
    softest = softest * (largest[:, None] / np.maximum(abs(softest), np.finfo(float).tiny)).min()
    single = np.eye(len(inner))[:, :, None] * largest[:, None, None] * np.array([1.0, 0.0])
    return np.concatenate([single, softest[None]])


def _aside(path: BrokenPath) -> np.ndarray:
    """(B, 2), the displacements of the path drawn beside that of the ray, mm: toward the axis."""
    heights = path.corners[:, 1]
    aside = -NEIGHBOUR * heights if heights.any() else np.full_like(heights, SHIFT * abs(path.lengths[1:]).sum())
    return np.stack([aside, np.zeros_like(aside)], -1)


def _along_profiles(path: BrokenPath, lens: Lens) -> np.ndarray:
    """(P, B, 2), displacements from the lower to the upper end of what is drawn of each surface, mm."""
    own = [lens.rows[number - 1].semi_diameter for number in path.numbers]
    highest = max(HIGHER * abs(path.corners[:, 1]).max(), LEAST * abs(path.lengths[1:]).sum())
    bulge = np.sqrt(np.maximum(path.shapes.curvature**2 * (1 + path.shapes.conic), np.finfo(float).tiny))
    half = np.minimum([highest if size is None else size for size in own], OF_RIM / bulge)
    along = (POINTS[:, None] * half - path.corners[:, 1]) / path.tangents[:, 0, 1]
    return np.stack([along, np.zeros_like(along)], -1)


def _kind(negative: int, directions: int) -> str:
    """In words; negative: in how many of the directions the path is longer than its neighbours."""
    if negative in (0, directions):
        return "a minimum" if not negative else "a maximum"
    return f"a saddle, longer than its neighbours in {negative} of {directions} directions"


def _singlet() -> Lens:
    return prescription.lens(
        [{"radius": 60, "thickness": 12, "index": 1.5, "stop": True}, {"radius": -60, "thickness": 54}],
        {"entrance_pupil_diameter": 30},
        [0, 8],
        [0.5876],
        name="a biconvex lens",
    )
