"""Descartes's ovals: single surfaces that image one point perfectly, because all paths to the image are equal.

From air into an index n, r from the axis, z along it:

    a point s in front, its image s' behind:  sqrt(r^2 + (s + z)^2) + n sqrt(r^2 + (s' - z)^2) = s + n s',
    a beam along the axis, its focus f' behind:  the ellipsoid of radius f' (n - 1) / n and conic k = -1 / n^2.

The first is a curve of the fourth order, traced here as an asphere: the conic through vertex and rim, and a power
series fitted to the rest. The second is a conic, and its focus is its far focus.
Source: Descartes, La Geometrie (1637), book II; Born & Wolf, Principles of Optics (7th ed.), section 4.2.1.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

import jax
import numpy as np

from lenstrace.analysis.rays import ray, trace
from lenstrace.errors import OptionError
from lenstrace.optics.rays import Ray
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.prescription import lens

RAYS = 20  # drawn; none of them on the axis
TERMS = 14  # of the series: r^4 ... r^30
PLACES = 200  # where it is fitted
STEPS = 60  # of Newton's method for the oval, from its vertex plane
FIT = 1e-12  # of s': a series that comes no nearer is refused
REACH = 0.8  # of the radius at the vertex: how far the series usually reaches
HIGH = 0.9  # of its half axis: how far out the ellipsoid is lit
PERFECT = 1e-11  # of s + s': what the fit and rounding may leave


@result
class CartesianOval(Demonstration):
    """An oval, an ellipsoid, and the sphere of the oval's radius; mm, z from the vertex.

    ray_z, ray_y:     (3, N): object, surface, image, of the oval.
    profile_z, profile_y:  (P,), of its surface.
    heights:          (3, N), of the rays on the oval, the ellipsoid and the sphere.
    misses:           (3, N), by which they miss the image; nan where they do not arrive.
    """

    ray_z: np.ndarray
    ray_y: np.ndarray
    profile_z: np.ndarray
    profile_y: np.ndarray
    heights: np.ndarray
    misses: np.ndarray


@demonstration
def cartesian_oval(
    object_distance: Annotated[float, Option("from the object to the surface", "mm", above=0, most=1e6)] = 100.0,
    image_distance: Annotated[float, Option("from the surface to the image", "mm", above=0, most=1e6)] = 150.0,
    index: Annotated[float, Option("refractive index behind the surface", above=1, most=5, slider=(1.3, 2.5))] = 1.5,
    height: Annotated[float, Option("outermost ray on the surface", "mm", above=0, most=1e6)] = 30.0,
) -> CartesianOval:
    """Cartesian ovals: one surface, one point, a perfect image.

    OptionError where the oval is not as high as that, or its series does not converge.
    """
    s, image, share = object_distance, image_distance, np.linspace(-1, 1, RAYS)
    surface = _fitted(s, image, index, height)
    y = height * share
    z = _oval(s, image, index, y)
    length = np.hypot(y, s + z)
    from_object = ray((0 * y, 0 * y, 0 * y - s), (0 * y, y / length, (s + z) / length))
    oval = _traced(surface, index, image, from_object)
    sphere = _traced({"curvature": surface["curvature"]}, index, image, from_object)
    # the ellipsoid is no higher than its smaller half axis
    half_axis = image * math.sqrt((index - 1) / (index + 1))
    of_beam = min(height, HIGH * half_axis) * share
    conic = {"radius": image * (index - 1) / index, "conic": -1 / index**2}
    ellipsoid = _traced(conic, index, image, ray((0 * y, of_beam, 0 * y), (0 * y, 0 * y, 1 + 0 * y)))
    path = oval.opl[-1]
    within = PERFECT * (s + image)
    rows = []
    for at in (RAYS // 2 + RAYS // 4, RAYS - 1):
        rows += [
            Comparison(f"ray at {y[at]:.4g} mm on the oval: misses the image by", "mm", oval.y[-1, at], 0.0, within),
            Comparison(f"ray at {y[at]:.4g} mm on the oval: path", "mm", path[at], s + index * image, within),
            Comparison(
                f"ray at {of_beam[at]:.4g} mm on the ellipsoid: misses by", "mm", ellipsoid.y[-1, at], 0.0, within
            ),
            Comparison(
                f"ray at {of_beam[at]:.4g} mm on the ellipsoid: path", "mm", ellipsoid.opl[-1, at], index * image
            ),
        ]
    rim = 1.05 * height * np.linspace(-1, 1, PLACES + 1)
    return CartesianOval(
        setting=f"a point {s:g} mm in front of an index of {index:g}, its image {image:g} mm behind it, up to "
        f"{height:g} mm from the axis; and a beam along the axis with the same focus",
        rows=tuple(rows),
        ray_z=np.array([0 * y - s, oval.z[1], 0 * y + image]),
        ray_y=np.array([0 * y, oval.y[1], oval.y[-1]]),
        profile_z=_oval(s, image, index, rim),
        profile_y=rim,
        heights=np.array([y, of_beam, y]),
        misses=np.abs([np.where(found.ok[-1], found.y[-1], np.nan) for found in (oval, ellipsoid, sphere)]),
    )


def _traced(surface: dict[str, Any], index: float, image: float, rays: Ray) -> Any:
    """A `Ray` of numpy arrays: at the launch, on the surface, and in the plane of the image."""
    one = lens(
        [{**surface, "index": index, "thickness": image, "stop": True}],
        {"entrance_pupil_diameter": 1.0},
        [0.0],
        [0.5876],
    )
    return jax.device_get(trace(one, rays=rays))


def _fitted(s: float, image: float, index: float, height: float) -> dict[str, Any]:
    """The oval as an asphere up to a height: curvature, conic and terms; OptionError where there is none."""
    c = (index / image + 1 / s) / (index - 1)
    r = height * np.cos((np.arange(PLACES) + 0.5) * np.pi / (2 * PLACES))
    z, rim = _oval(s, image, index, r), float(_oval(s, image, index, np.array([height]))[0])
    # the conic c r^2 + (1 + k) c z^2 = 2 z through the rim
    one_k = (2 * rim - c * height**2) / (c * rim**2)
    conic = c * r**2 / (1 + np.sqrt(np.maximum(1 - one_k * (c * r) ** 2, 0)))
    powers = 2 * np.arange(2, TERMS + 2)
    columns = (r[:, None] / height) ** powers
    numbers = np.linalg.lstsq(columns, z - conic, rcond=None)[0]
    if not np.abs(columns @ numbers - (z - conic)).max() <= FIT * image:
        raise OptionError(
            f"cartesian-oval: the oval cannot be followed to a height of {height:g} mm; keep height below about "
            f"{REACH / c:.3g} mm, or move object or image away"
        )
    terms = {int(power): float(a / height**power) for power, a in zip(powers, numbers, strict=True)}
    return {"curvature": c, "conic": one_k - 1, "asphere": terms}


def _oval(s: float, image: float, index: float, r: np.ndarray) -> np.ndarray:
    """z of the oval at heights r; nan where it is not reached."""
    z = np.zeros_like(r)
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            front, back = np.hypot(r, s + z), np.hypot(r, image - z)
            # front - s and back - image, written so that nothing cancels
            excess = (r * r + z * (z + 2 * s)) / (front + s) + index * (r * r + z * (z - 2 * image)) / (back + image)
            z = z - excess / ((s + z) / front - index * (image - z) / back)
    return z
