"""Veselago's flat lens: a slab of negative index images a point without a curved surface.

A ray that leaves the axis at the angle t in the medium n0, a distance a before a slab of index n and thickness d, runs
inside at sin t' = n0 sin t / n, and crosses the axis inside and again behind the slab, from the front and the back
face, at

    -a tan t / tan t',      z = -a - d tan t' / tan t,      dz/dn = d n0 |n| cos t / (n^2 - n0^2 sin^2 t)^(3/2).

With n = -n0 these are a and d - a for every angle, and the optical path from the source to there is 0.
Source: V. G. Veselago, Sov. Phys. Usp. 10, 509 (1968).
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.phenomena.axis import Fan, fan
from lenstrace.phenomena.demonstration import RELATIVE_TOLERANCE, Comparison, Demonstration, result
from lenstrace.phenomena.negative_index.total_reflection import refuse_total_reflection
from lenstrace.phenomena.options import Option, demonstration, index_of_either_sign, positive_index, positive_length
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

RAYS = 33  # drawn; an odd number has one on the axis
DEPARTURES = np.geomspace(1e-8, 1e-2, 19)  # of the index from -n0, in units of n0: what they cost
AGREEMENT = 1e-12  # of the lengths that are added up along a ray
ROUNDING = 1e-13  # of a sine, before the faces magnify it
PERFECT = 1e-14  # of the thickness, or the distance of the source: how small the spot of a perfect image is


@result
class Slab(Demonstration):
    """Rays through the slab, and what is left of the image; lengths in mm, z from the front face.

    ray_z, ray_y:          (4, N), the course of N rays: source, both faces, one thickness behind the last of these
                           and the image.
    caustic_z, caustic_y:  (N,), where neighbouring rays meet behind the slab.
    thickness:             of the slab.           image: where rays near the axis meet behind it.
    departures:            (D,), |n + n0|.
    spots, spots_theory:   (2, D), height of the steepest ray in the image of those near the axis, for n above -n0 and
                           below.
    """

    ray_z: np.ndarray
    ray_y: np.ndarray
    caustic_z: np.ndarray
    caustic_y: np.ndarray
    thickness: float
    image: float
    departures: np.ndarray
    spots: np.ndarray
    spots_theory: np.ndarray


class _Theory(NamedTuple):
    """Closed forms for several angles: where rays cross the axis inside and behind, mm, how fast the latter moves with
    the index, the optical path to there, mm."""

    inside: np.ndarray
    behind: np.ndarray
    moving: np.ndarray
    path: np.ndarray


@demonstration
def slab(
    index: Annotated[float, index_of_either_sign("refractive index of the slab", (-2, -0.99))] = -1.0,
    thickness: Annotated[float, positive_length("thickness of the slab", slider=(0.5, 4))] = 2.0,
    source: Annotated[float, positive_length("distance of the source before the slab", slider=(0.1, 4))] = 1.0,
    surroundings: Annotated[float, positive_index("refractive index around the slab", (1, 2))] = 1.0,
    aperture: Annotated[float, Option("sine of the steepest ray", above=0, below=1, slider=(0.1, 0.98))] = 0.98,
    angles: Annotated[tuple[float, ...], Option("rays in the table, against the axis", "deg", least=0, below=90)] = (
        *(0.0, 30.0, 60.0),
    ),
) -> Slab:
    """A slab of negative index: a flat plate that images a point.

    OptionError where a ray is reflected totally.
    """
    t = np.array([*np.radians(angles), math.asin(aperture)])
    refuse_total_reflection("slab", t.max(), index, surroundings, "all rays")
    plate = lens(
        [{"thickness": thickness, "index": index, "stop": True}, {"index": surroundings}],
        {"object_na": aperture * surroundings},
        [0.0],
        [0.5876],
        object_distance=source,
        object_index=surroundings,
    )
    fan_of_rays = np.arcsin(np.linspace(-aperture, aperture, RAYS))
    traced = jax.device_get(_through(plate, index, np.append(t, fan_of_rays)))
    rays, moving = jax.tree.map(lambda a: a[..., : len(t)], traced)
    drawn, _ = jax.tree.map(lambda a: a[..., len(t) :], traced)
    steepest = t[-1:]
    indices = surroundings * (np.array([[1.0], [-1.0]]) * DEPARTURES - 1)
    spots = np.asarray(_heights(plate, np.append(indices, index), steepest))

    theory = _theory(index, surroundings, thickness, source, t)
    spots_theory = [_height(n, surroundings, thickness, steepest) for n in (*indices.flat, index)]
    path = rays.path.opl[-1] + surroundings * rays.crossing / np.cos(t)
    # what the faces make of a rounded sine: as the square of the ratio of the indices, and of the cosine inside
    ratio, inner = abs(index) / surroundings, 1 - (surroundings * np.sin(t) / index) ** 2
    noise = ROUNDING * (ratio + 1 / ratio) ** 2 / inner
    within = AGREEMENT * (source + thickness) / np.cos(t) + noise * abs(theory.behind)
    path_within = within * max(1.0, surroundings) / np.cos(t) + noise * abs(theory.path)
    moving_within = (RELATIVE_TOLERANCE + 10 * noise) * abs(theory.moving)
    rows = []
    labels = [f"ray at {angle:.4g} deg" for angle in np.degrees(t)]
    for i, at in enumerate(labels):
        rows += [
            Comparison(f"{at}: crosses the axis behind", "mm", rays.crossing[i], theory.behind[i], within[i]),
            Comparison(
                f"{at}: how fast that moves with the index", "mm", moving[i], theory.moving[i], moving_within[i]
            ),
            Comparison(f"{at}: optical path to there", "mm", path[i], theory.path[i], path_within[i]),
        ]
    inside = -rays.path.y[1, -1] * rays.path.n[1, -1] / rays.path.m[1, -1]
    smallest = PERFECT * max(thickness, source) + (RELATIVE_TOLERANCE + 10 * noise[-1]) * abs(spots_theory[-1])
    rows += [
        Comparison(f"{labels[-1]}: crosses the axis inside", "mm", inside, theory.inside[-1], within[-1]),
        Comparison(f"{labels[-1]}: height in the image plane", "mm", spots[-1], spots_theory[-1], smallest),
    ]
    image = thickness + _theory(index, surroundings, thickness, source, np.zeros(1)).behind[0]
    last = max(image, thickness) + thickness
    y, slope = drawn.path.y[-1], drawn.path.m[-1] / drawn.path.n[-1]
    zero = np.zeros(RAYS)
    return Slab(
        setting=f"a slab of index {index:g}, {thickness:g} mm thick, in a medium of index {surroundings:g}; a point on "
        f"the axis {source:g} mm before it, {_what_image(image - thickness)}",
        rows=tuple(rows),
        ray_z=np.array([zero - source, zero, zero + thickness, zero + last]),
        ray_y=np.array([zero, drawn.path.y[1], y, y + slope * (last - thickness)]),
        caustic_z=drawn.caustic_z + thickness,
        caustic_y=drawn.caustic_y,
        thickness=thickness,
        image=image,
        departures=surroundings * DEPARTURES,
        spots=np.abs(spots[:-1]).reshape(indices.shape),
        spots_theory=np.abs(spots_theory[:-1]).reshape(indices.shape),
    )


@jax.jit
def _through(plate: Lens, index: jax.Array, angles: jax.Array) -> tuple[Fan, jax.Array]:
    """Rays from the source, z from the back face, and the derivative of their crossings by the index of the slab."""

    def crossing(index: jax.Array) -> tuple[jax.Array, Fan]:
        rays = fan(plate.replace(surface=1, index=index), angles)
        return rays.crossing, rays

    _, change, rays = jax.jvp(crossing, (index,), (jnp.ones_like(index),), has_aux=True)
    return rays, change


@jax.jit
def _heights(plate: Lens, indices: jax.Array, angle: jax.Array) -> jax.Array:
    """(D,), height of a ray, angle: (1,), in the image plane of rays near the axis, for slabs of D indices."""

    def height(index: jax.Array) -> jax.Array:
        rays, _ = _through(plate, index, jnp.append(0.0, angle))
        slope = rays.path.m[-1, 1] / rays.path.n[-1, 1]
        return rays.path.y[-1, 1] + slope * rays.crossing[0]

    return jax.vmap(height)(indices)


def _what_image(behind: float) -> str:
    """In words; behind: where rays near the axis meet, mm from the back face."""
    if abs(behind) < AGREEMENT:
        return "its image on the back face"
    return "a real image behind it" if behind > 0 else "no real image behind it"


def _theory(index: float, around: float, thickness: float, source: float, t: np.ndarray) -> _Theory:
    """See the docstring of this file."""
    cosine, root = np.cos(t), np.copysign(np.sqrt(index**2 - (around * np.sin(t)) ** 2), index)  # root: n cos t'
    behind = -source - thickness * around * cosine / root
    return _Theory(
        inside=-source * root / (around * cosine),
        behind=behind,
        moving=thickness * around * index * cosine / root**3,
        path=around * (source + behind) / cosine + index**2 * thickness / root,
    )


def _height(index: float, around: float, thickness: float, t: np.ndarray) -> float:
    """Of a ray at the angle t, in the image plane of rays near the axis; the difference of two crossings, written so
    that nothing cancels."""
    sine, cosine = math.sin(t[0]), math.cos(t[0])
    root = math.sqrt(index**2 - (around * sine) ** 2)
    # cos t / |n cos t'| - 1 / |n|
    excess = sine**2 * (around - index) * (around + index) / (abs(index) * root * (abs(index) * cosine + root))
    return math.copysign(1, index) * thickness * around * excess * sine / cosine
