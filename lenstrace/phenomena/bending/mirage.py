"""A mirage: a hot road is a mirror to those who look at it flatly enough.

Above the road n^2 = N^2 - D exp(-y / h), lower by D at the ground. A ray keeps b = n cos t, t its angle to the
horizontal, and is turned back where n = b, at the height and after the distance

    y_t = h ln(D / A),      x_t = 2 b h arcosh(exp((y - y_t) / 2h)) / sqrt(A),      A = N^2 - b^2,

from where it comes down at the height y; beyond it goes up as it came down. With A > D it meets the road.
Source: from b dy/dx = sqrt(n^2 - b^2); Tape, Sci. Am. 252 (6), 120 (1985), on the phenomenon.
"""

from __future__ import annotations

import math
from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import ray
from lenstrace.errors import OptionError
from lenstrace.optics.graded import follow
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration

AIR = 1.000277  # index at 15 C, 101325 Pa, 0.589 um: Ciddor, Appl. Opt. 35, 1566 (1996)
SHARES = np.array([0.3, 0.5, 0.7, 0.9, 0.99])  # of the steepest angle that is turned back
DRAWN = 300  # points of a drawn ray
WITHIN = 1e-10  # of the height of the eye, and of the distance
SHALLOW = 1e-7  # of a distance: where a ray is lowest is as uncertain as the root of how low


@result
class Mirage(Demonstration):
    """Rays to an eye above a road; metres, x along the road away from the eye, y upward.

    ray_x, ray_y:    (K, N), nan beyond where they are as high as the eye again.
    eye:             height.     angles: (N,), below the horizontal, milliradians.
    turning:         (N,), heights where they are turned back.      steepest: of those angles, milliradians.
    heights, index:  (P,), the profile of the index, less 1, in millionths.
    """

    ray_x: np.ndarray
    ray_y: np.ndarray
    eye: float
    angles: np.ndarray
    turning: np.ndarray
    steepest: float
    heights: np.ndarray
    index: np.ndarray


@demonstration
def mirage(
    contrast: Annotated[
        float, Option("index less at the ground, millionths", above=0, most=200, slider=(5, 60))
    ] = 30.0,
    layer: Annotated[
        float, Option("height of the hot layer (to 1/e)", "m", least=1e-3, most=10, slider=(0.05, 1))
    ] = 0.3,
    eye: Annotated[float, Option("height of the eye", "m", above=0, most=100, slider=(0.5, 3))] = 1.5,
) -> Mirage:
    """A mirage: rays turned back by hot air above a road, by their closed form."""
    # in units of the height of the layer
    drop, height = contrast * 1e-6 * (2 * AIR - contrast * 1e-6), eye / layer
    at_eye = AIR**2 - drop * math.exp(-height)
    # sin^2 of the angle whose ray is turned back at the ground, A = D
    steepest = math.asin(math.sqrt(drop * (1 - math.exp(-height)) / at_eye))
    if steepest == 0:
        raise OptionError("mirage: no ray is turned back above the road; give more contrast, or an eye above the road")
    angles = SHARES * steepest
    momentum = np.sqrt(at_eye) * np.cos(angles)
    # A = N^2 - b^2 as a sum of what does not cancel
    excess = drop * math.exp(-height) + at_eye * np.sin(angles) ** 2
    turning = np.log(drop / excess)
    half = 2 * momentum * np.arccosh(np.exp((height - turning) / 2)) / np.sqrt(excess)

    def squared(x: jax.Array, y: jax.Array, z: jax.Array) -> jax.Array:
        return AIR**2 - drop * jnp.exp(-y) + 0 * (x + z)

    zero = 0 * angles
    rays = ray((zero, zero + height, zero), (zero, -np.sin(angles), np.cos(angles)))
    path = follow(squared, rays, 1.05 * AIR * 2 * float(half.max()))
    lowest = path.first(lambda ray: np.asarray(ray.m))
    back = path.first(lambda ray: np.where(np.asarray(ray.m) > 0, np.asarray(ray.y) - height, -1.0))
    rows = []
    for at, angle in enumerate(angles):
        label = f"ray {1e3 * angle:.4g} mrad down"
        rows += [
            Comparison(
                f"{label}: turned back at height", "m", float(lowest.y[at]) * layer, turning[at] * layer, WITHIN * eye
            ),
            Comparison(
                f"{label}: distance of that",
                "m",
                float(lowest.z[at]) * layer,
                half[at] * layer,
                SHALLOW * half[at] * layer,
            ),
            Comparison(f"{label}: as high as the eye again at", "m", float(back.z[at]) * layer, 2 * half[at] * layer),
        ]
    drawn = path.at(np.linspace(0, 1, DRAWN)[:, None] * np.asarray(back.opl))
    heights = np.linspace(0, 1.2 * eye, DRAWN)
    return Mirage(
        setting=f"an eye {eye:g} m above a road; the index is {contrast:g} millionths lower at the ground, 1/e of that "
        f"{layer:g} m above it; rays up to {1e3 * steepest:.4g} mrad down are turned back",
        rows=tuple(rows),
        ray_x=layer * np.asarray(drawn.z),
        ray_y=layer * np.asarray(drawn.y),
        eye=eye,
        angles=1e3 * angles,
        turning=layer * turning,
        steepest=1e3 * steepest,
        heights=heights,
        index=1e6 * (np.sqrt(AIR**2 - drop * np.exp(-heights / layer)) - 1),
    )
