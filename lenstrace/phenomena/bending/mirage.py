"""A mirage: over a hot road the index rises with height, and light from the sky or a car is bent up to the eye.

With y the height above the road, n n(y) the index relative to the cool air and C = n cos t kept along every ray,
q = n sin t downward at the eye's height e, all rays are known (see `optics.graded` for the parameter t = z / C):

    n^2 = 1 - F exp(-y / h):     y = h ln((F / E) cosh^2(sqrt(E) (t - T) / 2h)),  E = q^2 + F exp(-e / h),
                                 T = (2 h / sqrt(E)) arsinh(q / sqrt(F exp(-e / h)));
    n^2 = 1 - F + F y / h:       y = e - q t + F t^2 / 4h,  a parabola,  T = 2 h q / F.

They turn upward at t = T and are back at the height e at t = 2 T; those that would turn below 0 end on the road.
n - 1 of air is inverse to its absolute temperature (Gladstone and Dale).
Source: derived from the conserved n cos t; for the phenomenon M. Minnaert, Light and Color in the Outdoors (1993).
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree
from lenstrace.errors import OptionError
from lenstrace.optics.graded import FLOOR, through
from lenstrace.optics.rays import Ray, living
from lenstrace.phenomena.bending.tolerance import GROWTH, STEP_ERROR
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration

EXPONENTIAL, LINEAR = "exponential", "linear"
# n - 1 of air at 15 degrees Celsius and 1013 hPa in yellow light; the zero of Celsius in kelvin.
REFRACTIVITY, STANDARD_KELVIN, ZERO_CELSIUS = 2.77e-4, 288.15, 273.15
RAYS = 61  # to the object; every few of them are drawn
SAMPLES = 201  # along each
GRAZING = 0.9999  # of the steepest angle that clears the road
TRIED = 2001  # angles, to find how much of the object to show
HIGHER = 1.1  # than the eye and than what is seen upside down, the object is shown
CONSERVED = 100.0  # times the tolerance of a step: what n cos t may change by
LONGER = 1.1  # than the closed form says, rays are followed


@result
class Mirage(Demonstration):
    """Rays from the eye to a distant object, traced against the light; lengths in m, they are those of a road.

    layer:           height of the warm layer.
    ray_z, ray_y:    (samples, N), the course of N rays from the eye, lowest first.
    angles:          (N,), at the eye above the horizontal, radians.
    heights, heights_theory:  (N,), where on the object they end.
    inverted:        (N,), True where a higher point of the object is seen lower.
    """

    layer: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    angles: np.ndarray
    heights: np.ndarray
    heights_theory: np.ndarray
    inverted: np.ndarray


@pytree
class Exponential:
    """n^2 = 1 - F exp(-y / h)."""

    fall: jax.Array | float
    layer: jax.Array | float

    def square(self, _x: jax.Array, y: jax.Array, _z: jax.Array) -> jax.Array:
        """n^2 at points, m."""
        return 1 - self.fall * jnp.exp(-y / self.layer)


@pytree
class Linear:
    """n^2 = 1 - F + F y / h."""

    fall: jax.Array | float
    layer: jax.Array | float

    def square(self, _x: jax.Array, y: jax.Array, _z: jax.Array) -> jax.Array:
        """n^2 at points, m."""
        return 1 - self.fall + self.fall * y / self.layer


class _Theory(NamedTuple):
    """Of rays at several angles: C, where they turn (z and height) and where they are at a distance; m."""

    invariant: np.ndarray
    turn: np.ndarray
    lowest: np.ndarray
    height: np.ndarray


@demonstration
def mirage(
    profile: Annotated[str, Option("how n^2 rises with height", choices=(EXPONENTIAL, LINEAR))] = EXPONENTIAL,
    road: Annotated[float, Option("temperature of the road", "deg C", least=-50, most=200)] = 60.0,
    air: Annotated[float, Option("temperature of the air above", "deg C", least=-50, most=60)] = 30.0,
    layer: Annotated[float, Option("height of the warm layer", "m", least=0.02, most=5)] = 0.1,
    eye: Annotated[float, Option("height of the eye", "m", least=0.1, most=10)] = 1.5,
    distance: Annotated[float, Option("distance of the object", "m", least=1, most=1e5, slider=(300, 2000))] = 500.0,
    angles: Annotated[tuple[float, ...], Option("rays of the table, downward", "deg", least=1e-3, most=30)] = (
        *(0.1, 0.25, 0.38),
    ),
    tolerance: Annotated[float, STEP_ERROR] = 1e-12,
) -> Mirage:
    """A mirage over a hot road: rays that turn before they reach it, and an image upside down.

    OptionError where the road is not the warmer, a ray of the table ends on it, or the object is too near.
    """
    fall = _fall(road, air)
    steepest = _steepest(profile, fall, layer, eye)
    below = np.radians(angles)
    if below.max() >= steepest:
        raise OptionError(
            f"mirage: the ray at {math.degrees(below.max()):.4g} deg ends on the road; keep all below "
            f"{math.degrees(steepest):.4g} deg"
        )
    nearest = _theory(profile, fall, layer, eye, np.array([steepest]), distance).turn[0]
    if distance <= nearest:
        raise OptionError(
            f"mirage: no ray is bent upward before the object {distance:g} m away; put it farther than {nearest:.4g} m"
        )
    seen = _seen(profile, fall, layer, eye, distance, GRAZING * steepest)
    theory = _theory(profile, fall, layer, eye, below, distance)
    of_object = _theory(profile, fall, layer, eye, -seen, distance)

    field = (Exponential if profile == EXPONENTIAL else Linear)(fall, layer)
    count = len(below)

    def turned_or_back(points: np.ndarray, momenta: np.ndarray) -> np.ndarray:
        """Half of the rays end where they turn, the others where they are back at the height of the eye."""
        return np.concatenate([momenta[1, :count], points[1, count:] - eye])

    def at_object(points: np.ndarray, _: np.ndarray) -> np.ndarray:
        return points[2] - distance

    back_at = 2 * theory.turn
    reach = LONGER * (back_at / theory.invariant).max()
    # an error of the height moves the place where a flat ray is back
    back_within = GROWTH * tolerance * (back_at + FLOOR * reach / np.sin(below))
    table = through(field, _from_eye(eye, -np.tile(below, 2)), reach, turned_or_back, tolerance=tolerance)
    reach = LONGER * distance / of_object.invariant.min()
    drawn = through(field, _from_eye(eye, seen), reach, at_object, tolerance=tolerance, samples=SAMPLES)

    turn, back = np.split(table.points[:, -1], 2, 1)
    invariant = (table.end_index * np.asarray(table.end.n))[count:]
    within = GROWTH * tolerance
    rows = []
    for i, angle in enumerate(angles):
        at = f"ray at {angle:.4g} deg"
        rows += [
            Comparison(f"{at}: height where it turns", "m", turn[1, i], theory.lowest[i], within * eye),
            Comparison(f"{at}: distance where it is back", "m", back[2, i], back_at[i], back_within[i]),
            Comparison(f"{at}: n cos t there", "", invariant[i], theory.invariant[i], CONSERVED * tolerance),
        ]
    heights = drawn.points[1, -1]
    off = abs(heights - of_object.height).max()
    rows.append(Comparison("largest departure of a ray from its height on the object", "m", off, 0, within * distance))
    return Mirage(
        setting=f"a road at {road:g} deg C, air at {air:g} deg C, {profile} in a layer of {layer:g} m; an eye "
        f"{eye:g} m high, an object {distance:g} m away",
        rows=tuple(rows),
        layer=layer,
        ray_z=drawn.points[2],
        ray_y=drawn.points[1],
        angles=seen,
        heights=heights,
        heights_theory=of_object.height,
        inverted=np.gradient(heights, seen) < 0,
    )


def _from_eye(eye: float, angles: np.ndarray) -> Ray:
    """Rays at angles above the horizontal."""
    zero = np.zeros(len(angles))
    return living(*map(jnp.asarray, (zero, zero + eye, zero, zero, np.sin(angles), np.cos(angles))))


def _fall(road: float, air: float) -> float:
    """F, by how much n^2 relative to the air is less at the road."""
    if road <= air:
        raise OptionError(f"mirage: the road must be warmer than the air, got {road:g} and {air:g} deg C")
    hot, cool = (REFRACTIVITY * STANDARD_KELVIN / (ZERO_CELSIUS + celsius) for celsius in (road, air))
    return (cool - hot) * (2 + cool + hot) / (1 + cool) ** 2


def _at_eye(profile: str, fall: float, layer: float, eye: float) -> tuple[float, float]:
    """n^2 at the eye, and by how much that is more than at the road."""
    if profile == EXPONENTIAL:
        return 1 - fall * math.exp(-eye / layer), -fall * math.expm1(-eye / layer)
    return 1 - fall + fall * eye / layer, fall * eye / layer


def _steepest(profile: str, fall: float, layer: float, eye: float) -> float:
    """The angle below the horizontal, radians, of the ray that turns on the road: there n cos t is the index."""
    square, more = _at_eye(profile, fall, layer, eye)
    return math.asin(math.sqrt(more / square))


def _theory(profile: str, fall: float, layer: float, eye: float, below: np.ndarray, distance: float) -> _Theory:
    """Rays at angles below the horizontal, radians; see the docstring of this file."""
    index = math.sqrt(_at_eye(profile, fall, layer, eye)[0])
    q, c = index * np.sin(below), index * np.cos(below)
    t = distance / c
    if profile == LINEAR:
        turn = 2 * layer * q / fall
        return _Theory(c, c * turn, eye - q * turn / 2, eye - q * t + fall * t**2 / (4 * layer))
    here = fall * math.exp(-eye / layer)
    root = np.sqrt(q * q + here)
    turn = 2 * layer / root * np.arcsinh(q / math.sqrt(here))
    lowest = layer * np.log(fall / root**2)
    # ln cosh, which cosh itself would overflow in
    phase = abs(root * (t - turn) / (2 * layer))
    return _Theory(c, c * turn, lowest, lowest + 2 * layer * (phase + np.log1p(np.exp(-2 * phase)) - math.log(2)))


def _seen(profile: str, fall: float, layer: float, eye: float, distance: float, steepest: float) -> np.ndarray:
    """Angles above the horizontal, radians, (RAYS,), under which the object is seen: from the steepest to where the
    upright image reaches higher than the inverted one, and than the eye."""
    tried = np.linspace(-steepest, steepest + math.atan(2 * eye / distance), TRIED)
    heights = _theory(profile, fall, layer, eye, -tried, distance).height
    upright = np.arange(TRIED) > heights.argmin()
    high = upright & (heights > HIGHER * max(heights[0], eye))
    return np.linspace(-steepest, tried[high.argmax() if high.any() else -1], RAYS)
