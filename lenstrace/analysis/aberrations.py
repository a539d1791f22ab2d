"""Third-order aberrations: the Seidel sums of a lens surface by surface, and what follows from them.

With the marginal ray (y, u) and the chief ray (ybar, ubar), signed index N, curvature c at the vertex, D the change
across a surface, A = N (u + y c), Abar = N (ubar + ybar c), H = A ybar - Abar y the same everywhere:

    S_I = -A^2 y D(u/N)        S_II = -A Abar y D(u/N)      S_III = -Abar^2 y D(u/N)      S_IV = -H^2 c D(1/N)
    S_V = Abar (ybar c (2 Abar y - A ybar) D(1/N) - Abar^2 y D(1/N^2))
    C_I = A y D(dN/N)          C_II = Abar y D(dN/N)

A departure a r^4 from the sphere adds g y^4, g y^3 ybar, g y^2 ybar^2, 0, g y ybar^3 to S_I ... S_V, g = 8 a D(N).
The usual S_V = (Abar/A)(S_III + S_IV) is the same with D(u/N) = A D(1/N^2) - y c D(1/N), but fails at A = 0. The wave
aberration, positive where light is ahead of its sphere, at pupil radius rho (rim 1) and azimuth phi (0 toward +y):

    W = S_I rho^4 / 8 + S_II rho^3 cos(phi) / 2 + S_III rho^2 cos^2(phi) / 2 + (S_III + S_IV) rho^2 / 4
        + S_V rho cos(phi) / 2,     and a ray misses its paraxial image by (dW/dx, dW/dy) / (N' u').

Source: Welford, Aberrations of Optical Systems (1986), chapters 8 and 10.
"""

from __future__ import annotations

import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike

from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.third_order import Seidel, Sums
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced
from lenstrace.errors import PrescriptionError, RayError
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.paraxial_rays import heights_and_slopes, largest_field, rays_of_pupil
from lenstrace.sequential.system import System

UM_PER_MM = 1000.0
# Asphere terms that bend light less than third order would, at the vertex.
BELOW_THIRD_ORDER = (1, 3)


def seidel(lens: Lens, *, field: ArrayLike | None = None) -> Seidel:
    """Third-order aberrations of a lens, at full aperture, its primary wavelength and one field.

    field:  distance from the axis in the unit of the lens's fields; the largest of them by default. It is turned to
            +y, so that S_II and S_V have the signs of an upward field; an angle counts by its tangent.
    Colour: between the shortest and the longest wavelength of the lens; 0 if it has one.
    The pupil is the paraxial one, also with ray aiming.

    PrescriptionError for an angle of 90 degrees or more, and for terms r^1 and r^3, which no third-order theory
    covers; while JAX traces the numbers of the lens the sums are nan there.
    """
    system = lens.system
    dtype = system.curvature.dtype
    if field is not None:
        system = system.replace(fields=_one_field(lens, field, dtype))
    if not is_traced((lens, field)):
        _check(lens, np.asarray(system.fields))
    scale = with_pupil(lens)[1].scale
    waves = lens.wavelengths
    ends = np.array([np.argmin(waves.um), np.argmax(waves.um)])
    return _seidel(system, scale, ends, np.asarray(waves.um[waves.primary] / UM_PER_MM, dtype))


def _one_field(lens: Lens, field: ArrayLike, dtype: Any) -> Any:
    """(1, 2), as `System.fields`."""
    if np.ndim(field) or not (is_traced(field) or np.isfinite(field)):
        raise RayError(f"field must be one finite number, got {field!r}")
    value = jnp.asarray(field, dtype) if is_traced(field) else np.asarray(field, dtype)
    return value.reshape(1, 1) * np.array([[0, lens.fields.scale]], dtype)


def _check(lens: Lens, fields: np.ndarray) -> None:
    """PrescriptionError for what third-order theory does not describe here."""
    if lens.fields.kind == "angle" and (largest := np.abs(fields).max()) >= math.pi / 2:
        raise PrescriptionError(
            f"fields: third-order theory takes an angle by its tangent, below 90 degrees, got {np.degrees(largest):g}; "
            "ask for a smaller field"
        )
    for number, row in enumerate(lens, 1):
        for power, coefficient in zip(row.powers, row.coefficients, strict=True):
            if power in BELOW_THIRD_ORDER and coefficient != 0:
                raise PrescriptionError(
                    f"surface {number}: the asphere term r^{power} aberrates at order {power - 1}, below the third: "
                    "there are no Seidel sums; fit the surface with even powers"
                )
        if row.screen is not None:
            raise PrescriptionError(
                f"surface {number}: a phase screen ({row.screen.label}) has no Seidel sums; ask for the wavefront and "
                "its Zernike coefficients"
            )


@compiled
def _seidel(
    system: System, scale: jax.Array, ends: jax.Array | np.ndarray, wavelength: jax.Array | np.ndarray
) -> Seidel:
    """scale: see `Front`; ends: places of the shortest and the longest wavelength; wavelength: primary, mm."""
    indices = jnp.asarray(system.index)
    fields, system = jnp.asarray(system.fields), system.at(system.primary)
    index, c = paraxial.signed_index(system), paraxial.effective_curvature(system)[:-1]
    distance = largest_field(system, fields)
    start = rays_of_pupil(system, distance / scale)
    (y, chief_y), (before, chief_before), (slope, _) = heights_and_slopes(system, start)

    first, then = index[:-1], index[1:]
    change, change_square = 1 / then - 1 / first, 1 / then**2 - 1 / first**2
    a, chief_a = before + first * c * y, chief_before + first * c * chief_y
    bend = a * change_square - y * c * change  # D(u/N)
    invariant = start[1, 0] * start[0, 1] - start[1, 1] * start[0, 0]
    dispersion = (indices[ends[0]] - indices[ends[1]]) / indices[system.primary]
    spread = dispersion[1:] - dispersion[:-1]
    spherical_part = Sums(
        spherical=-(a**2) * y * bend,
        coma=-a * chief_a * y * bend,
        astigmatism=-(chief_a**2) * y * bend,
        petzval=-(invariant**2) * c * change,
        distortion=chief_a * (chief_y * c * (2 * chief_a * y - a * chief_y) * change - chief_a**2 * y * change_square),
        axial_colour=a * y * spread,
        lateral_colour=chief_a * y * spread,
    )
    g, zero = 8 * _departure(system, c) * (then - first), jnp.zeros_like(y)
    aspheric_part = Sums(g * y**4, g * y**3 * chief_y, g * y**2 * chief_y**2, zero, g * y * chief_y**3, zero, zero)
    far = paraxial.image_slope(system) == 0
    surfaces = jax.tree.map(jnp.add, spherical_part, aspheric_part)
    return Seidel(
        jax.tree.map(jnp.sum, surfaces),
        surfaces,
        spherical_part,
        aspheric_part,
        marginal_height=y,
        chief_height=chief_y,
        lagrange_invariant=invariant,
        petzval_curvature=then[-1] * _sum(c * change),
        image_index=then[-1],
        image_slope=jnp.where(far, jnp.nan, slope / then[-1]),
        field=jnp.arctan(distance) if system.field_kind == "angle" else distance,
        wavelength=jnp.asarray(wavelength),
    )


def _sum(terms: jax.Array) -> jax.Array:
    """Their sum; 0 where it is rounding only."""
    total, noise = jnp.sum(terms), jnp.finfo(terms.dtype).eps * jnp.sum(jnp.abs(terms))
    return jnp.where(jnp.abs(total) <= paraxial.AFOCAL * noise, total - jax.lax.stop_gradient(total), total)


def _departure(system: System, vertex_curvature: jax.Array) -> jax.Array:
    """Coefficient of r^4 over the sphere of the curvature at the vertex, (S,), mm^-3; nan with r^1 or r^3 terms.

    A conic is c r^2 / 2 + (1 + k) c^3 r^4 / 8 + ..., a sphere the same with k = 0.
    """
    c, k, fourth = system.curvature[:-1], system.conic[:-1], system.term(4)[:-1]
    covered = jnp.all(jnp.stack([system.term(power)[:-1] == 0 for power in BELOW_THIRD_ORDER]), 0)
    return jnp.where(covered, fourth + (k * c**3 + (c**3 - vertex_curvature**3)) / 8, jnp.nan)
