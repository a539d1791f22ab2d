"""Brewster's angle, at which reflected light is polarized; what part of the light a surface reflects, and all around.

Where the refracted ray would stand at right angles to the reflected one, the surface sends back no light polarized in
the plane of incidence:

    tan t_B = n,      R_s(t_B) = ((n^2 - 1) / (n^2 + 1))^2,      and at 45 degrees always  R_p = R_s^2.

What is not reflected goes on: with the amplitudes t_s = 2 cos t1 / (cos t1 + n cos t2),
t_p = 2 cos t1 / (n cos t1 + cos t2) the part is T = (n cos t2 / cos t1) t^2, and R + T = 1. Even light from all sides,
2 int R cos t sin t dt with both polarizations, is reflected by

    1/2 + (n - 1)(3n + 1) / (6 (n + 1)^2) + n^2 (n^2 - 1)^2 / (n^2 + 1)^3 ln((n - 1) / (n + 1))
        - 2 n^3 (n^2 + 2n - 1) / ((n^2 + 1)(n^4 - 1)) + 8 n^4 (n^4 + 1) / ((n^2 + 1)(n^4 - 1)^2) ln n

from outside, r, and by 1 - (1 - r) / n^2 from inside.
Source: Born & Wolf, Principles of Optics (7th ed.), section 1.5, Eqs. (20), (21), (33)-(36); J. W. T. Walsh (1926), as
Eq. (B41) of S. A. Prahl, Light Transport in Tissue (thesis, University of Texas at Austin, 1988).
"""

from __future__ import annotations

import math
from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.fresnel import reflectances
from lenstrace.optics.vectors import Vector, dot
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.edge import edge
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.phenomena.surface import reflected, refracted

CURVE = np.radians(np.linspace(0, 90, 91))
NODES = 48  # of the sum over all directions: its error is rounding
ROUNDING = 1e-14  # of a reflectance


@result
class Brewster(Demonstration):
    """A ray at Brewster's angle, and the reflectances; angles in radians.

    polarizing, refracted:  the angle measured, and that of the ray behind the surface.
    angles:                 (A,), of incidence.
    curves, theory:         (2, A), R_s and R_p, measured and by the closed forms.
    diffuse:                the part reflected of light from all sides.
    index:                  behind the surface.
    """

    polarizing: float
    refracted: float
    angles: np.ndarray
    curves: np.ndarray
    theory: np.ndarray
    diffuse: float
    index: float


@demonstration
def brewster(
    index: Annotated[float, Option("refractive index behind the surface", least=1.05, most=5)] = 1.5,
    angle: Annotated[float, Option("angle of incidence in the table", "deg", least=0, most=89.9)] = 45.0,
) -> Brewster:
    """Brewster's angle: light reflected there is polarized; Fresnel's reflectances."""
    t, theory = math.radians(angle), math.atan(index)
    places, weights = np.polynomial.legendre.leggauss(NODES)
    cosines, weights = (places + 1) / 2, weights / 2
    angles = np.concatenate([np.arccos(cosines), [t, math.pi / 4], CURVE])
    polarizing, bent, outer, inner = jax.device_get(_measured(index, angles))
    (s, s_45, *s_curve, s_there), (p, p_45, *p_curve, p_there) = outer[:, NODES:]
    diffuse = (2 * weights * cosines * outer[:, :NODES].mean(0)).sum()
    # cos t sin t dt inside is that outside, divided by n^2; beyond the critical angle all is reflected
    trapped = 1 - (2 * weights * cosines * (1 - inner[:, :NODES].mean(0))).sum() / index**2
    reflectance, transmittance = _by_amplitudes(np.append(t, CURVE), index)
    walsh = _walsh(index)
    at = f"at {angle:.4g} deg"
    # what rounding of the ray behind makes of the cosine before the surface
    grazing = ROUNDING * index**2 / math.cos(t)
    rows = (
        Comparison("Brewster's angle", "deg", math.degrees(polarizing[0]), math.degrees(theory)),
        Comparison("refracted ray there", "deg", math.degrees(bent[0]), 90 - math.degrees(theory)),
        Comparison("there: R_p", "", p_there, 0.0, ROUNDING),
        Comparison("there: R_s", "", s_there, ((index**2 - 1) / (index**2 + 1)) ** 2),
        Comparison(f"{at}: R_s", "", s, reflectance[0, 0], grazing),
        Comparison(f"{at}: R_p", "", p, reflectance[1, 0], grazing),
        Comparison(f"{at}: R_s + T_s", "", s + transmittance[0, 0], 1.0, grazing),
        Comparison(f"{at}: R_p + T_p", "", p + transmittance[1, 0], 1.0, grazing),
        Comparison("at 45 deg: R_p / R_s, which is R_s", "", p_45 / s_45, s_45),
        Comparison("light from all sides, outside: R", "", diffuse, walsh),
        Comparison("light from all sides, inside: R", "", trapped, 1 - (1 - walsh) / index**2),
    )
    return Brewster(
        setting=f"light from air onto a surface of index {index:g}",
        rows=rows,
        polarizing=float(polarizing[0]),
        refracted=float(bent[0]),
        angles=CURVE,
        curves=np.array([s_curve, p_curve]),
        theory=reflectance[:, 1:],
        diffuse=float(diffuse),
        index=index,
    )


@jax.jit
def _measured(index: jax.Array, angles: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array, jax.Array]:
    """The angle where refracted and reflected ray are at right angles and that of the refracted one, (1,); R_s and R_p
    (2, ...) of light that comes at the angles, and there, and of that which comes back their way from inside.

    Either is that of the other side, whose angle the ray there has.
    """

    def rays(angle: jax.Array) -> tuple[Vector, Vector]:
        zero = jnp.zeros_like(angle)
        direction, normal = (zero, jnp.sin(angle), jnp.cos(angle)), (zero, zero, zero + 1)
        return refracted(direction, normal, zero + 1, index)[0], reflected(direction, normal)

    zero = jnp.zeros((1,))
    polarizing = edge(lambda angle: dot(*rays(angle)) < 0, zero, zero + math.pi / 2)
    (_, y, z), (_, _, back) = rays(jnp.append(angles, polarizing))
    one = jnp.ones_like(index)
    outer, inner = reflectances(jnp.abs(z), index, one), reflectances(jnp.abs(back), one, index)
    return polarizing, jnp.arctan2(y, z)[-1:], jnp.stack(outer), jnp.stack(inner)


def _by_amplitudes(angles: np.ndarray, index: float) -> tuple[np.ndarray, np.ndarray]:
    """R and T, (2, A), s and p; see the docstring of this file."""
    before, behind = np.cos(angles), np.sqrt(1 - (np.sin(angles) / index) ** 2)
    s, p = before + index * behind, index * before + behind
    reflected = np.array([(before - index * behind) / s, (index * before - behind) / p])
    passed = np.array([2 * before / s, 2 * before / p])
    return reflected**2, index * behind / before * passed**2


def _walsh(n: float) -> float:
    """Part of even light from all sides that is reflected; see the docstring of this file."""
    m, fourth = n * n, n**4
    return (
        0.5
        + (n - 1) * (3 * n + 1) / (6 * (n + 1) ** 2)
        + m * (m - 1) ** 2 / (m + 1) ** 3 * math.log((n - 1) / (n + 1))
        - 2 * n**3 * (m + 2 * n - 1) / ((m + 1) * (fourth - 1))
        + 8 * fourth * (fourth + 1) / ((m + 1) * (fourth - 1) ** 2) * math.log(n)
    )
