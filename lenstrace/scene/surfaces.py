"""Curved surfaces in the words of a prescription, and implicit ones by a formula, as shapes of a scene."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import jax
import numpy as np

from lenstrace.errors import SceneError
from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.asphere_cap import AsphereCap
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.shapes.conic_cap import ConicCap
from lenstrace.optics.shapes.implicit import Implicit
from lenstrace.scene.formula import formula
from lenstrace.scene.formula_bounds import slopes_within
from lenstrace.scene.number_rules import number, obeyed, positive

AXES = ("x", "y", "z")
# Places where the bounds that a person gives are tried, by how much they may be short, and a short way, in reaches.
TRIED, SHORT, NEAR = 4096, 1e-4, 1e-5


def conic(radius: float, semi_diameter: float, conic: float = 0.0) -> ConicCap:
    """A conic about its vertex at the origin, its axis z.

    radius: of curvature, positive where the centre lies toward +z, inf for a plane.     semi_diameter: of its rim, inf
    for all of it.      conic: k, -1 a paraboloid.      Lengths of the scene. SceneError for a radius of 0.
    """
    return ConicCap(Conic(_curvature(radius), conic), semi_diameter)  # type: ignore[arg-type]


def asphere(
    radius: float, semi_diameter: float, conic: float = 0.0, terms: Mapping[int | str, float] | None = None
) -> AsphereCap:
    """A conic with a series in the distance r from the axis added, a_p r^p.

    terms: a_p by the powers p, which are whole and positive.      Else as `conic`; semi_diameter is finite.
    """
    powers = {}
    for power, value in (terms or {}).items():
        if not str(power).isdigit() or int(power) < 1:
            raise SceneError(f"terms: a power must be a whole number from 1 on, got {power!r}")
        powers[int(power)] = value
    if not powers:
        raise SceneError("terms: give at least one, such as { 4 = 1e-5 }; without any it is a conic")
    order = tuple(sorted(powers))
    norm = obeyed("semi_diameter", positive, semi_diameter)
    scaled = np.array([obeyed(f"terms: {p}", number, powers[p]) * norm ** (p - 1) for p in order], float)
    return AsphereCap(Asphere(_curvature(radius), conic, scaled, norm, order), semi_diameter)  # type: ignore[arg-type]


def implicit(
    function: str,
    reach: float,
    constants: Mapping[str, float] | None = None,
    steepness: float | None = None,
    bending: float | None = None,
) -> Implicit:
    """The solid where a formula of x, y and z is negative, inside the cube |x|, |y|, |z| <= reach.

    constants:  by name; other ones compile nothing anew.
    steepness:  no gradient of the function in the cube is longer.    bending: no second derivative of it is greater.
    None: both are found by interval arithmetic. SceneError for a formula that is none, or whose slope has no bound.
    """
    given = {name: obeyed(f"constants: {name}", number, value) for name, value in (constants or {}).items()}
    reach = obeyed("reach", positive, reach)
    if steepness is None:
        found = slopes_within(formula(function, AXES, given), reach)
        steepness, bending = max(found[0], math.ulp(0.0)), found[1] if bending is None else bending
    bending = math.inf if bending is None else bending
    return Implicit(reach, steepness, bending, tuple(given.values()), formula(function, (*AXES, *given)))  # type: ignore[arg-type]


def check_implicit(shape: Implicit) -> None:
    """SceneError where the function is seen to be steeper or more bent than it is said to be: the march along a ray
    would step over its surface."""
    reach = float(shape.reach)
    places = np.random.default_rng(0).uniform(-1, 1, (3, TRIED)) * (reach * (1 - NEAR))
    numbers = [np.float64(number) for number in shape.numbers]
    gradient = jax.vmap(jax.grad(lambda *place: shape.function(*place, *numbers), (0, 1, 2)))
    slopes = gradient(*places)
    length = np.sqrt(sum(np.asarray(slope) ** 2 for slope in slopes))
    worst = int(np.argmax(np.where(np.isnan(length), np.inf, length)))
    where = ", ".join(f"{each:.4g}" for each in places[:, worst])
    if not np.isfinite(length[worst]):
        raise SceneError(f"function: its gradient is not finite at ({where}), in the cube of reach {reach:g}")
    if length[worst] > float(shape.steepness) * (1 + SHORT):
        raise SceneError(
            f"steepness {float(shape.steepness):g} is too small: at ({where}) the gradient is {length[worst]:.4g} "
            "long; give a bound for all of the cube, or leave it out for a formula"
        )
    bending, step = float(shape.bending), reach * NEAR
    if not np.isfinite(bending):
        return
    # the change of the slope along a short way is a second derivative somewhere on it
    way = np.random.default_rng(1).normal(size=places.shape)
    way /= np.linalg.norm(way, axis=0)
    change = np.asarray(gradient(*(places + step * way))) - np.asarray(slopes)
    rounding = 16 * np.finfo(float).eps * length
    second = np.maximum(np.abs(np.sum(change * way, 0)) - rounding, 0) / step
    worst = int(np.argmax(second))
    if second[worst] > bending * (1 + SHORT):
        where = ", ".join(f"{each:.4g}" for each in places[:, worst])
        raise SceneError(
            f"bending {bending:g} is too small: near ({where}) the second derivative is {second[worst]:.4g}; give a "
            "bound for all of the cube, or leave it out"
        )


def _curvature(radius: Any) -> float:
    return 1 / obeyed("radius", _radius, radius)


def _radius(value: Any) -> float:
    if isinstance(value, float) and math.isinf(value):
        return value
    if number(value) == 0:
        raise SceneError("must not be 0; inf is a plane")
    return float(value)
