"""The Luneburg lens: a ball whose index falls outward so that it focuses a beam on its own far side.

With n^2 = 2 - r^2 / R^2, which is 1 at the surface, a ray moves like a mass on a spring: all rays of a beam come to the
point of the surface opposite to where the beam comes from, and all paths to there are equal:

    L = R (1 + pi / 2)      from the plane that touches the ball in front.

Source: Luneburg, Mathematical Theory of Optics (1944, reprinted 1964), section 29.
"""

from __future__ import annotations

from typing import Annotated

import jax
import numpy as np

from lenstrace.analysis.rays import ray
from lenstrace.optics.graded import GradedPath, follow
from lenstrace.optics.rays import Ray
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration

RAYS = 16  # drawn; none of them on the axis
STEPS = (2, 4, 6, 9, 14, 20, 30, 45, 70)  # of the method, for the plot of what accuracy costs
FINEST = 100
LOOSE = 1.0  # a tolerance that asks for no more steps
LONGEST = 2.7  # of the radius: a little more than the 1 + pi / 2 of the ray in the middle
DRAWN = 120  # points of a drawn ray
FOCUS = 1e-8  # of the radius


@result
class Luneburg(Demonstration):
    """A beam through the ball; mm, from its centre.

    radius.
    ray_z, ray_y:    (K, N), the course of the rays, nan beyond the ball.
    evaluations, errors:  (Q,), how often the method asked for the gradient; and by how much the rays then miss, mm.
    """

    radius: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    evaluations: np.ndarray
    errors: np.ndarray


@demonstration
def luneburg(
    radius: Annotated[float, Option("radius of the ball", "mm", least=1e-3, most=1e6, slider=(1, 100))] = 10.0,
    height: Annotated[float, Option("outermost ray, of the radius", above=0, most=0.999, slider=(0.1, 0.99))] = 0.95,
) -> Luneburg:
    """The Luneburg lens: a graded ball that focuses a beam without aberration."""
    y = height * np.linspace(-1, 1, RAYS)
    finest = _followed(y, FINEST)
    focus = finest.first(_beyond)
    paths = 1 - np.sqrt(1 - y * y) + focus.opl
    within = FOCUS * radius
    rows = []
    for at in (RAYS // 2 + RAYS // 4, RAYS - 1):
        label = f"ray at {y[at] * radius:.4g} mm"
        rows += [
            Comparison(f"{label}: leaves the ball at y", "mm", float(focus.y[at]) * radius, 0.0, within),
            Comparison(f"{label}: and at z", "mm", float(focus.z[at]) * radius, radius, within),
            Comparison(
                f"{label}: path from the front plane", "mm", float(paths[at]) * radius, (1 + np.pi / 2) * radius, within
            ),
        ]
    trials = [_followed(y, steps, LOOSE) for steps in STEPS]
    drawn = finest.at(np.linspace(0, 1, DRAWN)[:, None] * np.asarray(focus.opl))
    return Luneburg(
        setting=f"a beam of {2 * height * radius:g} mm meets a ball of radius {radius:g} mm and n^2 = 2 - r^2 / R^2",
        rows=tuple(rows),
        radius=radius,
        ray_z=radius * np.concatenate([np.full((1, RAYS), -1.5), drawn.z]),
        ray_y=radius * np.concatenate([y[None], drawn.y]),
        evaluations=np.array([trial.evaluations for trial in trials]),
        errors=radius * np.array([np.abs(trial.first(_beyond).y).max() for trial in trials]),
    )


def _squared_index(x: jax.Array, y: jax.Array, z: jax.Array) -> jax.Array:
    """In units of the radius."""
    return 2 - (x * x + y * y + z * z)


def _followed(y: np.ndarray, steps: int, tolerance: float = 1e-13) -> GradedPath:
    """A beam along z from the surface of the unit ball on."""
    zero = 0 * y
    beam = ray((zero, y, -np.sqrt(1 - y * y)), (zero, zero, zero + 1))
    return follow(_squared_index, beam, LONGEST, tolerance=tolerance, steps=steps)


def _beyond(ray: Ray) -> np.ndarray:
    """Above 0 outside the ball, behind it."""
    outside = np.asarray(ray.x**2 + ray.y**2 + ray.z**2) - 1
    return np.where(np.asarray(ray.z) > 0, outside, -1.0)
