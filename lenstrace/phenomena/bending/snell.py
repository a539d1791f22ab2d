"""The law of refraction, n1 sin t1 = n2 sin t2, in the plane and as directions in space.

With the unit vectors N across the surface, T along it in the plane of incidence, and light that goes down,

    d1 = sin t1 T - cos t1 N,      d2 = (n1 / n2) sin t1 T - sqrt(1 - (n1 sin t1 / n2)^2) N,

and the reflected light is sin t1 T + cos t1 N. All three lie in one plane and have the length 1; light turned round
runs back on its way. The surface stands askew here, so that none of this is true by the choice of axes. An index
below 0 bends the ray to its own side of the normal.
Source: Born & Wolf, Principles of Optics (7th ed.), section 3.2.2, Eq. (19); Veselago, Sov. Phys. Usp. 10, 509 (1968).
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.vectors import Vector, dot
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration, index_of_either_sign, positive_index
from lenstrace.phenomena.surface import reflected, refracted

# T, N and the direction across both: rows of a rotation matrix of small whole numbers.
ALONG, ACROSS, ASIDE = np.array([[3, -6, 2], [2, 3, 6], [-6, -2, 3]]) / 7
SWEEP = 1 - np.linspace(1, 0.01, 61) ** 2  # of the largest angle that is refracted: closer where the curve is steep
ROUNDING = 1e-14  # of unit vectors, and of sines


@result
class Snell(Demonstration):
    """A ray at a surface, and all others; angles in radians from the normal, positive on the far side of it.

    angle, refracted:     of incidence, and where the light goes on; None: it is reflected totally.
    largest:              angle of incidence that is refracted: the critical angle, or 90 degrees.
    angles:               (A,), of incidence, up to there.        bent, bent_theory: (A,), behind the surface.
    indices:              n1 and n2.
    """

    angle: float
    refracted: float | None
    largest: float
    angles: np.ndarray
    bent: np.ndarray
    bent_theory: np.ndarray
    indices: tuple[float, float]


class _Bent(NamedTuple):
    """Components of directions along T, across (N) and out of the plane of incidence, and their lengths; (A,)."""

    along: jax.Array
    across: jax.Array
    aside: jax.Array
    length: jax.Array


@demonstration
def snell(
    angle: Annotated[float, Option("angle of incidence", "deg", least=0, most=89.9)] = 30.0,
    index: Annotated[float, index_of_either_sign("refractive index behind the surface", (1, 3))] = 1.5,
    index_before: Annotated[float, positive_index("refractive index before it", (1, 3))] = 1.0,
) -> Snell:
    """Snell's law: a ray is bent at a plane surface, in the plane of incidence."""
    t = math.radians(angle)
    largest = math.asin(min(1.0, abs(index) / index_before))
    angles = np.append(t, SWEEP * largest)
    behind, back, turned, goes_on = jax.device_get(_at_the_surface(angles, index_before, index))
    sines = index_before * np.sin(angles) / index
    critical = float(abs(abs(sines[0]) - 1) < ROUNDING)  # rounding decides there
    sent_back = _degrees(back.along, back.across)
    rows = [
        Comparison("angle of the reflected ray", "deg", sent_back, angle, math.degrees(ROUNDING)),
        Comparison("reflected ray: out of the plane of incidence", "", back.aside[0], 0.0, ROUNDING),
        Comparison("rays that go on", "", float(goes_on[0]), float(abs(sines[0]) < 1), critical),
    ]
    if goes_on[0]:
        sine = max(-1.0, min(1.0, sines[0]))
        cosine = math.sqrt(1 - sine * sine)
        # rounding grows on the way into a thinner medium, and in an angle near 90 degrees
        rounding, back_again = (ROUNDING * max(1.0, mu * mu) for mu in (index_before / index, index / index_before))
        near = rounding / max(cosine, math.sqrt(rounding))
        slanted, upright = _degrees(behind.along, -behind.across), _degrees(turned.along, turned.across)
        far = math.degrees((rounding + back_again) / math.cos(t))
        rows += [
            Comparison("angle of the refracted ray", "deg", slanted, math.degrees(math.asin(sine)), math.degrees(near)),
            Comparison("its direction: along the surface", "", behind.along[0], sine, rounding),
            Comparison("its direction: across the surface", "", behind.across[0], -cosine, near),
            Comparison("its direction: out of the plane of incidence", "", behind.aside[0], 0.0, ROUNDING),
            Comparison("its direction: length", "", behind.length[0], 1.0, rounding),
            Comparison("turned round, it leaves at", "deg", upright, angle, far),
        ]
    change = np.abs(index * behind.along - index_before * np.sin(angles))[1:].max()
    rows.append(Comparison("all angles: largest change of n sin t", "", change, 0.0, ROUNDING * index_before))
    bent = np.arctan2(behind.along, -behind.across)
    return Snell(
        setting=f"a ray at {angle:g} deg from the index {index_before:g} onto a plane surface of the index {index:g}"
        + ("" if goes_on[0] else ": reflected totally"),
        rows=tuple(rows),
        angle=t,
        refracted=float(bent[0]) if goes_on[0] else None,
        largest=largest,
        angles=angles[1:],
        bent=bent[1:],
        bent_theory=np.arcsin(sines[1:]),
        indices=(index_before, index),
    )


@jax.jit
def _at_the_surface(
    angles: jax.Array, index_before: jax.Array, index: jax.Array
) -> tuple[_Bent, _Bent, _Bent, jax.Array]:
    """Refracted and reflected light, the refracted sent back the way it came, and where any is refracted; (A,)."""
    normal = _vector(ACROSS, jnp.ones_like(angles))
    direction = _sum(_vector(ALONG, jnp.sin(angles)), _vector(ACROSS, -jnp.cos(angles)))
    behind, goes_on = refracted(direction, normal, index_before, index)
    x, y, z = behind
    turned, _ = refracted((-x, -y, -z), normal, index, index_before)
    return _parts(behind), _parts(reflected(direction, normal)), _parts(turned, -1.0), goes_on


def _vector(unit: np.ndarray, size: jax.Array) -> Vector:
    return unit[0] * size, unit[1] * size, unit[2] * size


def _sum(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _parts(direction: Vector, sense: float = 1.0) -> _Bent:
    """sense: -1 for light that runs back."""
    one = jnp.ones_like(direction[0])
    along, across, aside = (dot(direction, _vector(unit, one)) for unit in (ALONG, ACROSS, ASIDE))
    return _Bent(sense * along, across, aside, jnp.sqrt(dot(direction, direction)))


def _degrees(along: np.ndarray, across: np.ndarray) -> float:
    """Angle of the first ray against the normal."""
    return math.degrees(math.atan2(along[0], across[0]))
