"""Normals of the surfaces of a lens, at points on them."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.vectors import Vector
from lenstrace.sequential.system import System


def surface_normal(system: System, surface: int, point: Vector) -> Vector:
    """Along the normal of one of the surfaces 1 ... S + 1, of any length, at points on it, mm in its frame."""
    i = surface - 1
    numbers = system.curvature[i], system.conic[i], system.coefficients[i], system.norm_radius[i]
    return _normal(numbers, system.kinds[i].powers, point)


def surface_normals(system: System, points: Vector) -> Vector:
    """The same of all surfaces 1 ... S + 1, at points of each, (K, ...)."""
    numbers = system.curvature, system.conic, system.coefficients, system.norm_radius
    conics = jax.vmap(lambda surface, p: _normal(surface, (), p))(numbers, points)
    powers = max((kind.powers for kind in system.kinds), key=len)
    if not powers:
        return conics
    aspheres = jax.vmap(lambda surface, p: _normal(surface, powers, p))(numbers, points)
    aspheric = np.array([bool(kind.powers) for kind in system.kinds]).reshape(-1, *(1,) * (points[0].ndim - 1))
    x, y, z = (jnp.where(aspheric, a, b) for a, b in zip(aspheres, conics, strict=True))
    return x, y, z


def _normal(numbers: tuple[jax.Array, ...], powers: tuple[int, ...], point: Vector) -> Vector:
    """Of one surface; numbers: its curvature, conic, coefficients and norm radius."""
    curvature, conic, coefficients, norm_radius = numbers
    if not powers:
        return Conic(curvature, conic).normal(*point)
    return Asphere(curvature, conic, coefficients, norm_radius, powers).normal(point[0], point[1])
