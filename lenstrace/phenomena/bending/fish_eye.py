"""Maxwell's fish-eye: a medium in which every ray is a circle, and every point has a perfect image.

In n = n0 / (1 + r^2 / R^2) all rays from a point at the distance a on one side of the centre meet at the distance

    b = R^2 / a

on the other side, after the optical path pi n0 R / 2 (half a great circle of the sphere that the plane is a
stereographic projection of). With the z axis from the point to its image, D = a + b, a ray that leaves under the angle
t is an arc of the circle through both with the radius D / (2 sin t); it arrives under -t.
Source: J. C. Maxwell, Camb. Dublin Math. J. 8, 188 (1854); Born & Wolf, Principles of Optics, section 4.2.2.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree
from lenstrace.optics.graded import Course, through
from lenstrace.optics.rays import living
from lenstrace.phenomena.bending.tolerance import GROWTH, STEP_ERROR, Cost, cost
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration, positive_length

SAMPLES = 101  # along each ray, drawn and compared
# Rays are followed so much longer than the closed form says they take.
LONGER = 1.2


@result
class FishEye(Demonstration):
    """Rays from the point to its image, about the centre of the medium; mm.

    radius:        R, where the index is half that at the centre.
    source, image: z of them, both with y = 0.
    ray_z, ray_y:  (samples, N), the course of N rays.
    cost:          computed when it is called, of tolerances: error of the image, in units of its distance from
                   the point.
    """

    radius: float
    source: float
    image: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    cost: Callable[[], Cost]


@pytree
class Medium:
    """n = n0 / (1 + r^2 / R^2)."""

    index: jax.Array | float
    radius: jax.Array | float

    def square(self, x: jax.Array, y: jax.Array, z: jax.Array) -> jax.Array:
        """n^2 at points, mm."""
        return (self.index / (1 + (x * x + y * y + z * z) / (self.radius * self.radius))) ** 2


@demonstration
def fish_eye(
    source: Annotated[float, Option("distance of the point from the centre, in radii", least=0.2, most=5)] = 0.6,
    spread: Annotated[float, Option("angle of the outermost rays to the image", "deg", above=0, most=120)] = 100.0,
    rays: Annotated[int, Option("rays on either side", least=1, most=50)] = 8,
    index: Annotated[float, Option("refractive index at the centre", least=0.1, most=10)] = 2.0,
    radius: Annotated[float, positive_length("where the index is half of that")] = 20.0,
    tolerance: Annotated[float, STEP_ERROR] = 1e-12,
) -> FishEye:
    """Maxwell's fish-eye: rays are circles, and every point has a perfect image."""
    before, behind = source * radius, radius / source
    apart = before + behind
    # as many on either side, none along the axis itself, which it would never leave
    angles = np.radians(spread) * np.linspace(-1, 1, 2 * rays)
    side, zero = np.sign(angles), np.zeros(2 * rays)
    start = living(*map(jnp.asarray, (zero, zero, zero - before, zero, np.sin(angles), np.cos(angles))))
    reach = LONGER * _longest(before, behind, angles) / index

    def back_on_axis(points: np.ndarray, _: np.ndarray) -> np.ndarray:
        return -side * points[1]

    def follow(tolerance: float, samples: int = 2) -> Course:
        return through(Medium(index, radius), start, reach, back_on_axis, tolerance=tolerance, samples=samples)

    def farthest(course: Course) -> float:
        """From the image, in units of its distance from the point."""
        return float(np.hypot(course.points[1, -1], course.points[2, -1] - behind).max() / apart)

    course = follow(tolerance, SAMPLES)
    _, y, z = course.points
    # of the circle's equation, divided by the length of its gradient
    off_circle = ((z + before) * (z - behind) + y * y) * np.sin(angles) / apart + y * np.cos(angles)
    path, path_theory = np.asarray(course.end.opl), math.pi * index * radius / 2
    # where the index is that much less than at the centre, an error of n d turns a ray that much farther
    within = GROWTH * tolerance * (1 + max(source, 1 / source) ** 2)
    return FishEye(
        setting=f"a medium of index {index:g} / (1 + r^2 / R^2), R = {radius:g} mm, and {2 * rays} rays from a point "
        f"{before:g} mm from its centre",
        rows=(
            Comparison("distance of the image from the centre", "mm", z[-1, -1], behind, within * apart),
            Comparison("farthest ray from the image", "mm", farthest(course) * apart, 0, within * apart),
            Comparison("farthest departure from a circle", "mm", abs(off_circle).max(), 0, within * apart),
            Comparison("shortest optical path", "mm", path.min(), path_theory, within * path_theory),
            Comparison("longest optical path", "mm", path.max(), path_theory, within * path_theory),
            Comparison(
                "angle of the outermost ray at the image",
                "deg",
                math.degrees(math.atan2(course.end.m[-1], course.end.n[-1])),
                -spread,
                math.degrees(within),
            ),
            Comparison("largest departure of |dr/dt| from the index, relative", "", abs(course.drift).max(), 0, within),
        ),
        radius=radius,
        source=-before,
        image=behind,
        ray_z=z,
        ray_y=y,
        cost=functools.cache(lambda: cost(follow, farthest)),
    )


def _longest(before: float, behind: float, angles: np.ndarray) -> float:
    """The largest t that a ray of n0 = 1 takes to the image, mm: the integral of ds / n along its circle."""
    half = np.linspace(0, 1, SAMPLES)[:, None] * angles
    chord = (before + behind) * np.sin(half) / np.sin(angles)
    y, z = chord * np.sin(angles - half), chord * np.cos(angles - half) - before
    lengths = (before + behind) * angles / np.sin(angles)
    return float((lengths * (1 + (y * y + z * z) / (before * behind)).mean(0)).max())
