"""Air over a hot road: two profiles of its index, and all rays through them in closed form.

With y the height above the road, n the index relative to the cool air and C = n cos t kept along every ray,
q = n sin t downward at the eye's height e, in the parameter t = z / C of `optics.graded`:

    n^2 = 1 - F exp(-y / h):     y = h ln((F / E) cosh^2(sqrt(E) (t - T) / 2h)),  E = q^2 + F exp(-e / h),
                                 T = (2 h / sqrt(E)) arsinh(q / sqrt(F exp(-e / h)));
    n^2 = 1 - F + F y / h:       y = e - q t + F t^2 / 4h,  a parabola,  T = 2 h q / F.

The second has no cool air above: it is that of air up to the height h, at which n is 1.
Rays turn upward at t = T and are back at the height e at t = 2 T; those that would turn below 0 end on the road.
n - 1 of air is inverse to its absolute temperature (Gladstone and Dale). The paths follow from d^2 y / dt^2 =
(1/2) d(n^2)/dy, once integrated.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree

# n - 1 of air at 15 degrees Celsius and 1013 hPa in yellow light; the zero of Celsius in kelvin.
REFRACTIVITY, STANDARD_KELVIN, ZERO_CELSIUS = 2.77e-4, 288.15, 273.15


class Paths(NamedTuple):
    """Of rays at several angles: C, where they turn (z and height) and how high they are at a distance; m."""

    invariant: np.ndarray
    turn: np.ndarray
    lowest: np.ndarray
    height: np.ndarray


@pytree
class Exponential:
    """n^2 = 1 - F exp(-y / h)."""

    fall: jax.Array | float
    layer: jax.Array | float

    @property
    def top(self) -> float:
        """The height up to which it holds, m."""
        return math.inf

    def square(self, _x: jax.Array, y: jax.Array, _z: jax.Array) -> jax.Array:
        """n^2 at points, m."""
        return 1 - self.fall * jnp.exp(-y / self.layer)

    def above_road(self, height: float) -> float:
        """By how much n^2 is more at a height than at the road."""
        return -float(self.fall) * math.expm1(-height / float(self.layer))

    def paths(self, eye: float, below: np.ndarray, distance: float) -> Paths:
        """Rays from the eye at angles below the horizontal, radians."""
        fall, layer = float(self.fall), float(self.layer)
        q, c = _split(self, eye, below)
        here = fall * math.exp(-eye / layer)
        root = np.sqrt(q * q + here)
        turn = 2 * layer / root * np.arcsinh(q / math.sqrt(here))
        lowest = layer * np.log(fall / root**2)
        # ln cosh, where cosh itself would overflow
        phase = abs(root * (distance / c - turn) / (2 * layer))
        return Paths(c, c * turn, lowest, lowest + 2 * layer * (phase + np.log1p(np.exp(-2 * phase)) - math.log(2)))


@pytree
class Linear:
    """n^2 = 1 - F + F y / h."""

    fall: jax.Array | float
    layer: jax.Array | float

    @property
    def top(self) -> float:
        """The height up to which it holds, m."""
        return float(self.layer)

    def square(self, _x: jax.Array, y: jax.Array, _z: jax.Array) -> jax.Array:
        """n^2 at points, m."""
        return 1 - self.fall + self.fall * y / self.layer

    def above_road(self, height: float) -> float:
        """By how much n^2 is more at a height than at the road."""
        return float(self.fall) * height / float(self.layer)

    def paths(self, eye: float, below: np.ndarray, distance: float) -> Paths:
        """Rays from the eye at angles below the horizontal, radians."""
        steepness = float(self.fall) / float(self.layer)
        q, c = _split(self, eye, below)
        turn, t = 2 * q / steepness, distance / c
        return Paths(c, c * turn, eye - q * turn / 2, eye - q * t + steepness * t**2 / 4)


HotAir = Exponential | Linear


def steepest(hot: HotAir, eye: float) -> float:
    """The angle below the horizontal, radians, of the ray that turns on the road: its n cos t is the index there."""
    more = hot.above_road(eye)
    return math.asin(math.sqrt(more / (1 - float(hot.fall) + more)))


def fall_of(road: float, air: float) -> float:
    """F, by how much n^2 relative to the air is less at the road; temperatures in degrees Celsius."""
    hot, cool = (REFRACTIVITY * STANDARD_KELVIN / (ZERO_CELSIUS + celsius) for celsius in (road, air))
    return (cool - hot) * (2 + cool + hot) / (1 + cool) ** 2


def _split(hot: HotAir, eye: float, below: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """q and C."""
    index = math.sqrt(1 - float(hot.fall) + hot.above_road(eye))
    return index * np.sin(below), index * np.cos(below)
