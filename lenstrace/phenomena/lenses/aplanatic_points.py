"""The aplanatic points of a sphere: a point inside is imaged without spherical aberration at any aperture.

A sphere of radius R and index n (over that around it) sends every ray from a point at R / n from its centre on as if it
came from n R, on the same side. With U the angle of a ray inside and U' outside,

    sin U' = sin U / n,      so that the sine condition holds with the magnification n sin U / sin U' = n^2.

Two more points have no spherical aberration: the centre, and the vertex itself.
Source: Born & Wolf, Principles of Optics (7th ed.), section 4.2.3.
"""

from __future__ import annotations

import math
from typing import Annotated

import jax
import numpy as np

from lenstrace.errors import OptionError
from lenstrace.phenomena.axis import Fan, fan
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

RAYS = 21  # drawn, one of them on the axis
PLACES = np.linspace(0.02, 2.2, 110)  # of the source, from the vertex, in units of the radius, for the plot
STEEP = 0.3  # of the largest sine that leaves the ball from everywhere: the ray of that plot
PERFECT = 1e-12  # of the radius


@result
class AplanaticPoints(Demonstration):
    """Rays from inside a sphere; mm, z from its centre, the vertex toward +z.

    radius; source, image: z of the point and of its image.
    ray_z, ray_y:     (3, N): source, surface, end of the picture.
    places:           (K,), of sources, z.        aberration: (K,), distance of the axis crossings of a steep ray and of
                      rays near the axis, mm.
    perfect:          (3,), the places without any.
    """

    radius: float
    source: float
    image: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    places: np.ndarray
    aberration: np.ndarray
    perfect: np.ndarray


@demonstration
def aplanatic_points(
    radius: Annotated[float, Option("radius of the sphere", "mm", above=0, most=1e6, slider=(1, 20))] = 10.0,
    index: Annotated[float, Option("refractive index, over that outside", above=1, most=10, slider=(1.2, 2.5))] = 1.5,
    angle: Annotated[float, Option("steepest ray inside", "deg", above=0, below=90, slider=(5, 55))] = 50.0,
) -> AplanaticPoints:
    """Aplanatic points of a sphere: imaged perfectly at every angle."""
    limit = math.degrees(math.atan(index))
    if angle >= limit:
        raise OptionError(
            f"aplanatic-points: a ray at {angle:g} deg leaves through the other half of the sphere; keep angle below "
            f"{limit:.4g} deg at this index"
        )
    ball = lens(
        [{"radius": -radius, "stop": True}],
        {"entrance_pupil_diameter": radius},
        [0.0],
        [0.5876],
        object_distance=radius * (1 + 1 / index),
        object_index=index,
    )
    inside = np.radians(angle) * np.linspace(-1, 1, RAYS)
    steep = np.array([0.0, math.asin(STEEP / index)])
    rays, others = jax.device_get(_from_inside(ball, inside, radius * PLACES, steep))
    # from the centre, which is a radius before the vertex
    source, image, crossings = -radius / index, -radius * index, rays.crossing + radius
    outside = rays.path.m[-1]
    points = rays.path.z[1] + radius, rays.path.y[1]
    end, slope = 1.5 * radius, outside / rays.path.n[-1]
    sides = RAYS // 2, RAYS - RAYS // 4, RAYS - 1
    rows = [
        Comparison(
            f"ray at {np.degrees(inside[i]):.4g} deg: comes from", "mm", crossings[i], image, PERFECT * radius * index
        )
        for i in sides
    ]
    rows.append(Comparison("sine of the steepest ray outside", "", outside[-1], math.sin(inside[-1]) / index))
    rows.append(
        Comparison("magnification, by the slopes near the axis", "", index / rays.slope_rate[RAYS // 2], index**2)
    )
    return AplanaticPoints(
        setting=f"a point {-source:.6g} mm from the centre of a sphere of radius {radius:g} mm, index {index:g}, "
        f"rays up to {angle:g} deg",
        rows=tuple(rows),
        radius=radius,
        source=source,
        image=image,
        ray_z=np.array([np.full(RAYS, source), points[0], np.full(RAYS, end)]),
        ray_y=np.array([np.zeros(RAYS), points[1], points[1] + slope * (end - points[0])]),
        places=radius * (1 - PLACES),
        aberration=others[:, 1] - others[:, 0],
        perfect=radius * np.array([1.0, 0.0, -1 / index]),
    )


@jax.jit
def _from_inside(ball: Lens, angles: jax.Array, distances: jax.Array, steep: jax.Array) -> tuple[Fan, jax.Array]:
    """The rays from the aplanatic point, and (K, 2) the axis crossings of two rays from other points of the axis."""

    def crossings(distance: jax.Array) -> jax.Array:
        return fan(ball.replace(object_distance=distance), steep).crossing

    return fan(ball, angles), jax.vmap(crossings)(distances)
