"""Maxwell's fish-eye: a medium without surfaces in which every point has a perfect image.

With n = n0 / (1 + r^2 / a^2) all rays are circles. Those from a point at the distance s from the centre meet again on
the other side at a^2 / s, each after the path

    L = pi n0 a / 2,

and the ray that leaves at the angle t to the line through the centre is on a circle of radius
(a^2 / s + s) / (2 sin t).
Source: Maxwell (1854); Born & Wolf, Principles of Optics (7th ed.), section 4.2.2.
"""

from __future__ import annotations

import math
from typing import Annotated

import jax
import numpy as np

from lenstrace.analysis.rays import ray
from lenstrace.optics.graded import follow
from lenstrace.optics.rays import Ray
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration

DRAWN = 241  # points of a drawn ray
ANGLES = np.radians([20.0, 45.0, 70.0, 90.0, 110.0, 135.0, 160.0])
EQUAL = 1e-8  # of the lengths
LONGEST = 1.7  # of n0 a: a little more than pi / 2


@result
class FishEye(Demonstration):
    """Rays of one point; mm, from the centre.

    scale:             a.        source, image: z of the point and of its image.
    ray_z, ray_y:      (K, N), up to the image and on.
    angles:            (N,), radians.       misses: (N,), by which each misses the image.
    """

    scale: float
    source: float
    image: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    angles: np.ndarray
    misses: np.ndarray


@demonstration
def fish_eye(
    index: Annotated[float, Option("refractive index n0 at the centre", above=0, most=10, slider=(1, 3))] = 2.0,
    scale: Annotated[float, Option("radius a where the index is half of it", "mm", least=1e-3, most=1e6)] = 10.0,
    source: Annotated[float, Option("distance of the source, in units of a", least=0.3, most=3, slider=(0.3, 3))] = 0.5,
) -> FishEye:
    """Maxwell's fish-eye: rays are circles, and every point has an image."""

    def squared(x: jax.Array, y: jax.Array, z: jax.Array) -> jax.Array:
        return 1 / (1 + x * x + y * y + z * z) ** 2

    # all in units of a and n0
    zero = 0 * ANGLES
    rays = ray((zero, zero, zero - source), (zero, np.sin(ANGLES), np.cos(ANGLES)))
    path = follow(squared, rays, LONGEST)
    there = path.first(_beyond)
    paths = np.asarray(there.opl)
    image = 1 / source
    radius = (image + source) / (2 * np.sin(ANGLES))
    # the centre of a circle through source and image lies between them, and off the axis away from where the ray goes
    centre = (image - source) / 2, radius * np.cos(ANGLES) * -1
    drawn = path.at(np.linspace(0, 1, DRAWN)[:, None] * paths)
    off = np.hypot(drawn.z - centre[0], drawn.y - centre[1]) / radius - 1
    rows = []
    for at, angle in enumerate(np.degrees(ANGLES)):
        label = f"ray at {angle:.4g} deg"
        rows += [
            Comparison(
                f"{label}: crosses the axis at", "mm", float(there.z[at]) * scale, image * scale, EQUAL * scale * image
            ),
            Comparison(
                f"{label}: path to there",
                "mm",
                float(paths[at]) * index * scale,
                math.pi / 2 * index * scale,
                EQUAL * scale * index,
            ),
        ]
    rows.append(
        Comparison("largest distance from their circles, of the radius", "", float(np.abs(off).max()), 0.0, EQUAL)
    )
    return FishEye(
        setting=f"a medium of index {index:g} at its centre and half of that {scale:g} mm from it, a point "
        f"{source * scale:g} mm from the centre",
        rows=tuple(rows),
        scale=scale,
        source=-source * scale,
        image=image * scale,
        ray_z=scale * np.asarray(drawn.z),
        ray_y=scale * np.asarray(drawn.y),
        angles=ANGLES,
        misses=scale * np.abs(np.asarray(there.z) - image),
    )


def _beyond(ray: Ray) -> np.ndarray:
    """Above 0 once a ray that set out upward is below the axis, on the far side of the centre."""
    return np.where(np.asarray(ray.z) > 0, -np.asarray(ray.y), -1.0)
