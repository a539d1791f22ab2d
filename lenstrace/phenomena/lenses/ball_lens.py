"""A ball as a lens: its focal length, and where rays far from the axis go.

Of radius R and index n (over that of what is around it), counted from its centre, F' lies at

    f' = n R / (2 (n - 1)).

A ray at the height h falls in at sin i = h / R, runs inside at sin r = sin i / n, is turned by 2 (i - r), and crosses
the axis at h / sin(2 (i - r)).
Source: Hecht, Optics (5th ed.), section 6.1.
"""

from __future__ import annotations

from typing import Annotated

import jax
import numpy as np

from lenstrace.errors import OptionError
from lenstrace.phenomena.axis import beam
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.prescription import lens

RAYS = 22  # drawn; none of them on the axis
NEAR = 1e-12  # of the focal length: rounding of what is measured from a vertex


@result
class BallLens(Demonstration):
    """A ball and a beam; mm, z from the centre.

    radius, focal_length.
    ray_z, ray_y:     (4, N): before the ball, in it, behind it, and at the end of the picture.
    heights:          (N,).      crossings, theory: (N,), where the rays cross the axis.
    """

    radius: float
    focal_length: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    heights: np.ndarray
    crossings: np.ndarray
    theory: np.ndarray


@demonstration
def ball_lens(
    radius: Annotated[float, Option("radius of the ball", "mm", above=0, most=1e6, slider=(1, 20))] = 5.0,
    index: Annotated[float, Option("refractive index, over that around it", above=0, most=10, slider=(1.2, 2.5))] = 1.5,
    height: Annotated[float, Option("outermost ray, of the radius", above=0, below=1, slider=(0.05, 0.99))] = 0.8,
) -> BallLens:
    """A ball of glass as a lens, and its spherical aberration.

    OptionError for a ball that bends nothing (index 1), or reflects the outermost ray totally.
    """
    if index == 1:
        raise OptionError("ball-lens: a ball of index 1 bends no light; choose another index")
    if height >= index:
        raise OptionError(f"ball-lens: at index {index:g} rays beyond {index:g} of the radius are reflected totally")
    ball = lens(
        [{"radius": radius, "thickness": 2 * radius, "index": index, "stop": True}, {"radius": -radius}],
        {"entrance_pupil_diameter": 2 * radius * height},
        [0.0],
        [0.5876],
    )
    heights = radius * height * np.linspace(-1, 1, RAYS)
    rays = jax.device_get(jax.jit(beam)(ball, np.append(heights, 0.0)))
    # from the last vertex to the centre
    crossings = rays.crossing + radius
    focal_length = index * radius / (2 * (index - 1))
    incidence = np.arcsin(heights / radius)
    theory = heights / np.sin(2 * (incidence - np.arcsin(heights / radius / index)))
    half, last = RAYS // 2 + RAYS // 4, RAYS - 1
    end = radius * 1.5 if crossings[last] < 0 else max(focal_length * 1.25, radius * 1.5)
    z, y = rays.path.z[1:3, :-1] + np.array([[-radius], [radius]]), rays.path.y[1:3, :-1]
    slope = rays.path.m[2, :-1] / rays.path.n[2, :-1]
    return BallLens(
        setting=f"a beam along the axis meets a ball of radius {radius:g} mm and index {index:g}",
        rows=(
            Comparison("focal length", "mm", -1 / rays.slope_rate[-1], focal_length),
            Comparison("last vertex to F'", "mm", rays.crossing[-1], focal_length - radius, NEAR * abs(focal_length)),
            *(
                Comparison(f"ray at {heights[i]:.4g} mm: centre to axis crossing", "mm", crossings[i], theory[i])
                for i in (half, last)
            ),
        ),
        radius=radius,
        focal_length=focal_length,
        ray_z=np.array([np.full(RAYS, -1.8 * radius), *z, np.full(RAYS, end)]),
        ray_y=np.array([heights, *y, y[1] + slope * (end - z[1])]),
        heights=heights,
        crossings=crossings[:-1],
        theory=theory,
    )
