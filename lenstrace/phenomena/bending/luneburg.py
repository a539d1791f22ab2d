"""Luneburg's lens: a ball without edges in its index, that brings every parallel beam to a point of its surface.

With n^2 = 2 - r^2 / R^2 the equation d^2 r / dt^2 = -r / R^2 of a ray (see `optics.graded`) is that of an oscillator:

    r(t) = s cos(t / R) + R d sin(t / R)

for a ray that enters at s in the direction d: an ellipse about the centre. All rays of a beam are at R d when
t = pi R / 2, each under the angle to d under which it met the surface, all after the optical path R (1 + pi / 2) from
the plane that touches the ball.
Source: R. K. Luneburg, Mathematical Theory of Optics (1944).
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

REACH = 2.0  # radii, of t; rays end at pi / 2
SAMPLES = 41  # along each ray, drawn and compared
BEFORE = 0.7  # radii before the ball where the drawn beam begins


@result
class Luneburg(Demonstration):
    """Rays through the ball, about its centre; mm.

    radius:        of the ball.                  focus: (2,), z and y of it.
    ray_z, ray_y:  (samples + 1, N), the course of N rays.
    cost:          computed when it is called, of tolerances: error of the focus in radii.
    """

    radius: float
    focus: np.ndarray
    ray_z: np.ndarray
    ray_y: np.ndarray
    cost: Callable[[], Cost]


@pytree
class Ball:
    """n^2 = 2 - r^2 / R^2."""

    radius: jax.Array | float

    def square(self, x: jax.Array, y: jax.Array, z: jax.Array) -> jax.Array:
        """n^2 at points, mm."""
        return 2 - (x * x + y * y + z * z) / (self.radius * self.radius)


@demonstration
def luneburg(
    radius: Annotated[float, positive_length("radius of the ball", slider=(1, 100))] = 20.0,
    aperture: Annotated[float, Option("height of the outermost ray, in radii", above=0, most=0.999)] = 0.95,
    angle: Annotated[float, Option("direction of the beam, against the axis", "deg", least=-180, most=180)] = 10.0,
    rays: Annotated[int, Option("rays of the beam", least=2, most=101)] = 15,
    tolerance: Annotated[float, STEP_ERROR] = 1e-12,
) -> Luneburg:
    """Luneburg's lens: a graded ball that focuses every parallel beam on its surface."""
    sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
    # y and z of the direction of the beam, and of the one across it
    along, across = np.array([[sine], [cosine]]), np.array([[cosine], [-sine]])
    heights = np.linspace(-aperture, aperture, rays)
    depths = np.sqrt(1 - heights**2)
    entry = radius * (heights * across - depths * along)
    zero = np.zeros(rays)
    start = living(*map(jnp.asarray, (zero, *entry, zero, *(along + zero))))

    def leaving(points: np.ndarray, _: np.ndarray) -> np.ndarray:
        return (points**2).sum(0) - radius**2

    def follow(tolerance: float, samples: int = 2) -> Course:
        return through(Ball(radius), start, REACH * radius, leaving, tolerance=tolerance, samples=samples)

    def farthest(course: Course) -> float:
        """From the focus, in radii."""
        return float(np.hypot(*(course.points[1:, -1] / radius - along)).max())

    course = follow(tolerance, SAMPLES)
    phase = np.linspace(0, math.pi / 2, SAMPLES)[:, None]
    ellipse = entry[:, None] * np.cos(phase) + radius * along[:, None] * np.sin(phase)
    off_ellipse = np.hypot(*(course.points[1:] - ellipse)).max()
    path = np.asarray(course.end.opl) + radius * (1 - depths)
    arrival = (np.stack([course.end.m, course.end.n])[:, -1:] * np.hstack([across, along])).sum(0)
    # a ray that grazes the ball is displaced that much farther along its surface
    within = GROWTH * tolerance / math.sqrt(1 - aperture**2)
    path_theory = radius * (1 + math.pi / 2)
    drawn = np.concatenate([(entry - (BEFORE + 1 - depths) * radius * along)[:, None], course.points[1:]], 1)
    return Luneburg(
        setting=f"a ball of radius {radius:g} mm whose index falls from 1.414 at its centre to 1 at its surface; a "
        f"parallel beam of {rays} rays at {angle:g} deg",
        rows=(
            Comparison("farthest ray from the focus", "mm", farthest(course) * radius, 0, within * radius),
            Comparison("farthest departure from an ellipse", "mm", off_ellipse, 0, within * radius),
            Comparison("shortest optical path of the beam", "mm", path.min(), path_theory, within * radius),
            Comparison("longest optical path of the beam", "mm", path.max(), path_theory, within * radius),
            Comparison(
                "angle of the outermost ray at the focus, against the beam",
                "deg",
                math.degrees(math.atan2(*arrival)),
                -math.degrees(math.asin(aperture)),
                math.degrees(within),
            ),
            Comparison("largest departure of |dr/dt| from the index, relative", "", abs(course.drift).max(), 0, within),
        ),
        radius=radius,
        focus=radius * along[::-1, 0],
        ray_z=drawn[1],
        ray_y=drawn[0],
        cost=functools.cache(lambda: cost(follow, farthest)),
    )
