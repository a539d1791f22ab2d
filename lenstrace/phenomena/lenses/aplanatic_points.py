"""The aplanatic points of a sphere: one point inside is imaged by all rays into one point, and what is beside it too.

A ray leaves a point inside the sphere, the distance a from its centre, at the angle U to the axis, meets the surface at
the angle i and goes on at i', as if it came from the distance b behind the centre at the angle U':

    sin i = (a / R) sin U,      sin i' = n sin i,      U' = U + i - i',      b = R sin i' / sin U'.

With a = R / n, where n is the index inside against that outside, i' = U and b = n R for every U; sin U / sin U' = n is
the same for every ray, so that the image of what stands beside the point is sharp as well, and n^2 times as large; and
the optical path from the point to its image is 0.
Source: Born & Wolf, Principles of Optics, sections 4.2.3 and 4.5.1.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.errors import OptionError
from lenstrace.optics.rays import Ray, living
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration, positive_length
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

AGREEMENT = (
    1e-12  # of the distances that are added up along a ray; times n^2, for sin U' is n times less than its parts
)
RAYS, CURVE = 13, 40  # drawn; on each curve of the aberrations
HALF_WAY = 0.5  # of the way from the point that is moved to the aplanatic one: the third curve


@result
class AplanaticPoints(Demonstration):
    """Rays from the aplanatic point, and the aberrations of points beside it; lengths in mm, z from the centre.

    radius:          of the sphere.
    source, image:   z of the aplanatic point and of its image.
    ray_z, ray_y:    (2, N), of rays from the point to the surface.        slopes:  (N,), behind it.
    angles:          (C,), at which rays leave their point, degrees.
    sources:         (3,), of points between the one that is moved and the aplanatic one: z.
    aberrations, aberrations_theory:  (3, C), where their rays cross the axis, against those near the axis.
    """

    radius: float
    source: float
    image: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    slopes: np.ndarray
    angles: np.ndarray
    sources: np.ndarray
    aberrations: np.ndarray
    aberrations_theory: np.ndarray


class _Traced(NamedTuple):
    """Rays behind the sphere, and how they move with their source: by a millimetre up (y) or aside (x)."""

    path: Ray
    y: jax.Array
    y_slope: jax.Array
    x: jax.Array
    x_slope: jax.Array


@demonstration
def aplanatic_points(
    index: Annotated[float, Option("refractive index of the sphere", least=1, most=10, slider=(1.2, 2.5))] = 1.5168,
    radius: Annotated[float, positive_length("radius of the sphere", slider=(1, 20))] = 10.0,
    surroundings: Annotated[float, Option("refractive index around it", least=1, most=10, slider=(1, 1.4))] = 1.0,
    angles: Annotated[tuple[float, ...], Option("rays in the table, against the axis", "deg", above=0, below=90)] = (
        *(10.0, 30.0, 50.0),
    ),
    moved: Annotated[
        float, Option("distance of the moved point from the centre, in units of the aplanatic one", least=1e-3, most=1)
    ] = 0.8,
) -> AplanaticPoints:
    """The aplanatic points of a sphere: an image without spherical aberration or coma.

    OptionError where a ray leaves through the half of the sphere that the point is in.
    """
    n, t = index / surroundings, np.radians(angles)
    if math.tan(t.max()) >= n:
        raise OptionError(
            f"aplanatic-points: the ray at {max(angles):g} deg leaves through the half of the sphere that the point is "
            f"in; keep all rays below {math.degrees(math.atan(n)):.4g} deg"
        )
    sphere = lens(
        [{"radius": -radius, "index": surroundings, "stop": True}],
        {"object_na": index * math.sin(t.max())},
        [0.0],
        [0.5876],
        object_index=index,
        object_distance=radius * (1 + 1 / n),
    )
    shares = np.array([moved, moved + HALF_WAY * (1 - moved), 1.0])
    curve, drawn = np.linspace(0, t.max(), CURVE + 1)[1:], np.linspace(-1, 1, RAYS) * t.max()
    starts = np.concatenate([t, drawn, np.tile(curve, 3)])
    distances = radius / n * np.append(np.ones(len(t) + RAYS), np.repeat(shares, CURVE))
    every = jax.device_get(_through(sphere, distances, starts, radius))
    table, picture, rest = (
        jax.tree.map(lambda a, part=part: a[..., part], every)
        for part in (slice(len(t)), slice(len(t), len(t) + RAYS), slice(len(t) + RAYS, None))
    )

    image, share = n * radius, AGREEMENT * (1 + n * n)
    scale = share * (1 + n) * radius
    crossing = _crossing(table.path, radius)
    sines = np.sin(t) / table.path.m[-1]
    # from the image surface, which stands at the vertex, to the image
    back = -radius - image
    tall, wide = table.y + table.y_slope * back, table.x + table.x_slope * back
    away = np.hypot(table.path.z[1] - back, table.path.y[1])
    path = table.path.opl[1] - surroundings * away
    rows = []
    for i, angle in enumerate(angles):
        at = f"ray at {angle:.4g} deg"
        rows += [
            Comparison(f"{at}: its image from the centre", "mm", crossing[i], -image, scale),
            Comparison(f"{at}: sine condition, sin U / sin U'", "", sines[i], n, share * n),
            Comparison(f"{at}: magnification in the plane of the ray", "", tall[i], n * n, share * n * n),
            Comparison(f"{at}: magnification across it", "", wide[i], n * n, share * n * n),
            Comparison(f"{at}: optical path to the image", "mm", path[i], 0.0, index * scale),
        ]
    behind = _crossing(rest.path, radius).reshape(3, CURVE)
    theory = np.array([_behind(n, radius, share * radius / n, curve) for share in shares])
    rows.append(
        Comparison(
            f"point moved to {moved:g} of the distance: ray at {max(angles):.4g} deg",
            *("mm", behind[0, -1], theory[0, -1], scale),
        )
    )
    near = -np.array([image * share / (1 + (1 - n) * share / n) / n for share in shares])[:, None]
    return AplanaticPoints(
        setting=f"a sphere of radius {radius:g} mm and index {index:g} in a medium of index {surroundings:g}; a point "
        f"inside, {radius / n:.6g} mm from the centre; z from the centre",
        rows=tuple(rows),
        radius=radius,
        source=-radius / n,
        image=-image,
        ray_z=picture.path.z[:2] + radius,
        ray_y=picture.path.y[:2],
        slopes=picture.path.m[-1] / picture.path.n[-1],
        angles=np.degrees(curve),
        sources=-radius / n * shares,
        aberrations=behind - near,
        aberrations_theory=theory - near,
    )


@jax.jit
def _through(sphere: Lens, distances: jax.Array, angles: jax.Array, radius: jax.Array) -> _Traced:
    """Rays from points on the axis, whose distances from the centre are given, mm, at the angles."""

    def end(x: jax.Array, y: jax.Array) -> tuple[tuple[jax.Array, ...], Ray]:
        z = -radius - jnp.tile(distances, 2)
        start = living(x, y, z, 0 * x, jnp.sin(jnp.tile(angles, 2)), jnp.cos(jnp.tile(angles, 2)))
        path = trace(sphere, rays=start)
        return (path.y[-1], path.m[-1] / path.n[-1], path.x[-1], path.l[-1] / path.n[-1]), path

    up = jnp.repeat(jnp.array([1.0, 0.0]), len(angles))
    _, changes, path = jax.jvp(end, (0 * up, 0 * up), (1 - up, up), has_aux=True)
    y, y_slope, x, x_slope = (change.reshape(2, -1) for change in changes)
    return _Traced(jax.tree.map(lambda a: a[:, : len(angles)], path), y[0], y_slope[0], x[1], x_slope[1])


def _crossing(path: Any, radius: float) -> np.ndarray:
    """Where rays behind the surface cross the axis, mm from the centre; nan for a ray that has no course."""
    crossing = radius + path.z[1] - path.y[1] * path.n[1] / path.m[1]
    return np.where(path.failure[-1] == 0, crossing, np.nan)


def _behind(n: float, radius: float, distance: float, t: np.ndarray) -> np.ndarray:
    """-b, see the docstring of this file."""
    inside = np.arcsin(distance / radius * np.sin(t))
    outside = np.arcsin(n * distance / radius * np.sin(t))
    return -radius * np.sin(outside) / np.sin(t + inside - outside)
