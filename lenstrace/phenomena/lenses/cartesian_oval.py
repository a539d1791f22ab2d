"""Descartes's ovals: the surface that images one point perfectly into another one, and the two conics among them.

All paths from the one point to the other are alike: with the distances s before the surface and s' behind it,

    sqrt(r^2 + (s + z)^2) + n sqrt(r^2 + (s' - z)^2) = s + n s',

which `oval_series` solves for z as a series in r^2; what is cut off sends a ray past the image by s' (1 - 1/n) times
its slope. One of the points at infinity makes it a conic:

    a beam into a point in the glass:   R = s' (n - 1) / n,   k = -1 / n^2,   an ellipsoid,
    a beam in the glass into a point:   R = -s (n - 1),       k = -n^2,       a hyperboloid.

A sphere of the same curvature (n - 1) / R = 1 / s + n / s' sends the ray of the angle U across the axis at

    R + R sin i' / sin(i - i' - U),     sin i = (1 + s / R) sin U,     sin i' = sin i / n.

Source: R. Descartes, La dioptrique (1637), discourse 8, and La geometrie (1637), book 2; Born & Wolf, section 4.2.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import jax
import numpy as np

from lenstrace.analysis.rays import ray, trace
from lenstrace.errors import OptionError
from lenstrace.optics.rays import Ray
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

WHERE = "cartesian-oval"
TERMS = 15  # of the series, from r^2 to r^30
CONVERGING = 0.5  # of a term: the next one is at most that, so that the sum of all that follow is at most the term
CUT = 1e-8  # of s': the largest miss that what is cut off of the series may make
ROUNDING = 1e-13  # of the lengths that are added up
RAYS = 41  # an odd number has one on the axis
SURFACES = ("the oval, point to point", "the ellipsoid, beam to point", "the hyperboloid, beam to point")


@result
class CartesianOval(Demonstration):
    """Rays through the oval, and what is left of the images; lengths in mm, z from the vertex.

    source, image:    distances of the two points.
    profile:          (M, 2) of (z, y), of the oval.
    ray_z, ray_y:     (3, N), from the source to the surface and to the image.
    apertures:        (A,), sine of a ray at the source; of a beam, its height by the distance of the focus.
    misses:           (3, A), height of the rays at the image: of the oval and of the two conics.
    sphere, sphere_theory:  (A,), of a sphere of the same curvature; nan where it is not met.
    """

    source: float
    image: float
    profile: np.ndarray
    ray_z: np.ndarray
    ray_y: np.ndarray
    apertures: np.ndarray
    misses: np.ndarray
    sphere: np.ndarray
    sphere_theory: np.ndarray


class _Surface(NamedTuple):
    """A single surface, its rays, and the optical path that all of them should have."""

    lens: Lens
    rays: Ray
    path: float


@demonstration
def cartesian_oval(
    index: Annotated[float, Option("refractive index of the glass", least=1.1, most=5, slider=(1.3, 2.5))] = 1.5,
    source: Annotated[float, Option("distance of the point before the surface", "mm", least=0.1, most=1e5)] = 100.0,
    image: Annotated[float, Option("distance of its image in the glass", "mm", least=0.1, most=1e5)] = 150.0,
    aperture: Annotated[float, Option("sine of the steepest ray", least=1e-3, below=1, slider=(0.02, 0.16))] = 0.15,
) -> CartesianOval:
    """Cartesian ovals: the surfaces that image a point perfectly.

    OptionError where the series of the oval, or a conic or sphere compared with it, does not reach as far as the ray.
    """
    sines = aperture * np.linspace(-1, 1, RAYS)
    radius = (index - 1) / (1 / source + index / image)
    series = oval_series(source, image, index, TERMS + 2)
    if aperture >= math.sqrt((index - 1) / (index + 1)) or (1 + source / radius) * aperture / 2 >= 1:
        raise OptionError(f"{WHERE}: the ellipsoid or the sphere that it is compared with ends before; lower aperture")

    powers = {2 * k: series[k] for k in range(2, TERMS + 1)}
    point, beam_in, beam_out = _diverging(source, sines), _parallel(image * sines), _parallel(source * sines)
    surfaces = [
        # the r^2 term is that of the radius, the parabola has no other
        _Surface(_single(radius, -1.0, 1.0, index, image, powers), point, source + index * image),
        _Surface(_single(image * (1 - 1 / index), -1 / index**2, 1.0, index, image), beam_in, index * image),
        _Surface(_single(-source * (index - 1), -(index**2), index, 1.0, source), beam_out, source),
        _Surface(_single(radius, 0.0, 1.0, index, image), point, math.nan),
    ]
    paths = [jax.device_get(_traced(each.lens, each.rays)) for each in surfaces]
    height = abs(paths[0].y[1]).max()
    reaches = abs(series[-1]) * height**2 <= CONVERGING * abs(series[-2]) and not paths[0].failure.any()
    slope = 2 * (TERMS + 1) * abs(series[TERMS + 1]) * height ** (2 * TERMS + 1) if reaches else math.inf
    cut = image * (1 - 1 / index) * slope
    if cut > CUT * image:
        raise OptionError(f"{WHERE}: {TERMS} terms of the series do not give the oval that far out; lower aperture")
    misses = np.array([np.where(path.failure[-1] == 0, path.y[-1], np.nan) for path in paths])
    rows = []
    for name, each, path, miss in zip(SURFACES, surfaces, paths, misses, strict=False):
        within = ROUNDING * (source + image) + (2 * cut if each is surfaces[0] else 0.0)
        rows += [
            Comparison(f"{name}: largest miss of {RAYS} rays", "mm", abs(miss).max(), 0.0, within),
            Comparison(f"{name}: path of the steepest ray", "mm", path.opl[-1, -1], each.path, index * within),
        ]
    theory = _sphere(radius, source, image, index, sines)
    half = 3 * RAYS // 4
    rows.append(
        Comparison(
            f"a sphere instead of the oval: miss of the ray of sine {sines[half]:.4g}",
            *("mm", misses[3, half], theory[half], ROUNDING * (source + image)),
        )
    )
    oval = paths[0]
    return CartesianOval(
        setting=f"from a point {source:g} mm before glass of index {index:g} to one {image:g} mm inside; the oval to r^"
        f"{2 * TERMS}, what is cut off misses by {cut:.1e} mm; and the two conics of the same distances",
        rows=tuple(rows),
        source=source,
        image=image,
        profile=np.column_stack([oval.z[1], oval.y[1]]),
        ray_z=np.array([0 * sines - source, oval.z[1], 0 * sines + image]),
        ray_y=np.array([0 * sines, oval.y[1], oval.y[-1]]),
        apertures=sines,
        misses=misses[:3],
        sphere=misses[3],
        sphere_theory=theory,
    )


def oval_series(source: float, image: float, index: float, terms: int) -> np.ndarray:
    """(terms + 1,), z of the oval as a series in r^2, mm^(1 - 2 k); each round of the iteration gives one term more."""
    z = np.zeros(terms + 1)
    for _ in range(terms):
        length = _distance(source, z) + index * _distance(image, -z)
        length[0] = 0
        z -= length / (1 - index)
    return z


def _distance(far: float, z: np.ndarray) -> np.ndarray:
    """sqrt(r^2 + (far + z)^2) as a series in r^2."""
    square = np.convolve(z, z)[: len(z)] + 2 * far * z
    square[1] += 1
    root = np.zeros(len(z))
    root[0] = far
    for k in range(1, len(z)):
        root[k] = (square[k] - root[1:k] @ root[k - 1 : 0 : -1]) / (2 * far)
    return root


def _single(
    radius: float, conic: float, before: float, behind: float, image: float, powers: dict[int, float] | None = None
) -> Lens:
    return lens(
        [
            {
                **{"radius": radius, "conic": conic, "thickness": image, "index": behind, "stop": True},
                **({"asphere": powers} if powers else {}),
            }
        ],
        {"entrance_pupil_diameter": image},
        [0.0],
        [0.5876],
        object_index=before,
    )


def _diverging(source: float, sines: np.ndarray) -> Ray:
    return ray((0 * sines, 0 * sines, 0 * sines - source), (0 * sines, sines, np.sqrt(1 - sines * sines)))


def _parallel(heights: np.ndarray) -> Ray:
    return ray((0 * heights, heights, 0 * heights), (0 * heights, 0 * heights, 0 * heights + 1))


@jax.jit
def _traced(made: Lens, rays: Ray) -> Ray:
    return trace(made, rays=rays)


def _sphere(radius: float, source: float, image: float, index: float, sines: np.ndarray) -> np.ndarray:
    """Height at the image, see the docstring of this file; nan where the sphere is not met."""
    with np.errstate(invalid="ignore"):
        before = np.arcsin((1 + source / radius) * sines)
        behind = np.arcsin(np.sin(before) / index)
        steep = before - behind - np.arcsin(sines)
        crossing = radius + radius * np.sin(behind) / np.where(sines == 0, 1, np.sin(steep))
        return np.where(sines == 0, 0.0, (crossing - image) * np.tan(steep))
