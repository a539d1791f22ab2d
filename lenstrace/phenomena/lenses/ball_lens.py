"""The ball lens: its focus, and how its rays miss it.

A ray parallel to the axis at the height h meets a ball of radius R and relative index n at the angle i, sin i = h / R,
goes on inside at r, sin r = sin i / n, leaves at i again, turned by 2 (i - r), and crosses the axis

    R sin i / sin 2(i - r)      behind the centre;  near the axis  f' = n R / (2 (n - 1)),  BFL = f' - R.

With n > 2 the focus lies inside the ball: what comes out diverges from it.
Source: geometry, as in Hecht, Optics, section 5.2; Born & Wolf, Principles of Optics, section 4.4.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import jax
import numpy as np

from lenstrace.errors import OptionError
from lenstrace.phenomena.axis import beam
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.lenses.drawing import course
from lenstrace.phenomena.options import Option, demonstration, positive_index, positive_length
from lenstrace.sequential.prescription import lens

NO_POWER = 1e-6  # of the index against its surroundings, from 1: a ball that has less has its focus at 5e5 radii
ROUNDING = 1e-13  # of the radius: of a height on the surface; and of a slope
STEEPEST = 0.999  # of the radius: the highest ray that is taken
DRAWN, CURVE = 15, 61  # rays in the picture, and on the curve of the crossings
FAR = 8.0  # radii: how far rays are followed behind the ball


@result
class BallLens(Demonstration):
    """Rays through the ball; lengths in mm, z from the centre.

    radius, focus:   of the ball; z of F'.
    rays:            (2, 4, N), z and y of their course; see `course`.
    heights, crossings, crossings_theory:  (C,), of rays, and where they cross the axis.
    """

    radius: float
    focus: float
    rays: np.ndarray
    heights: np.ndarray
    crossings: np.ndarray
    crossings_theory: np.ndarray


class _Theory(NamedTuple):
    """Of several rays: where they cross the axis, mm from the centre, and by how much they are turned, radians."""

    crossing: np.ndarray
    turned: np.ndarray


@demonstration
def ball_lens(
    index: Annotated[float, positive_index("refractive index of the ball", (1.2, 2.4))] = 1.5168,
    radius: Annotated[float, positive_length("radius of the ball", slider=(1, 20))] = 5.0,
    surroundings: Annotated[float, positive_index("refractive index around it", (1, 1.7))] = 1.0,
    heights: Annotated[
        tuple[float, ...], Option("rays in the table: height in radii of the ball", above=0, most=STEEPEST)
    ] = (0.2, 0.5, 0.8),
    aperture: Annotated[float, Option("highest ray of the picture, in radii", above=0, most=STEEPEST)] = 0.9,
) -> BallLens:
    """A ball lens: where its focus is, and its spherical aberration.

    OptionError for a ball without power, and where a ray is reflected totally or leaves through the front half.
    """
    n = index / surroundings
    if abs(n - 1) < NO_POWER:
        raise OptionError("ball-lens: a ball of the index of its surroundings has no power; give it another index")
    _check(n, max(*heights, aperture))
    table = radius * np.array(heights)
    curve = radius * aperture * np.linspace(0, 1, CURVE)
    drawn = radius * aperture * np.linspace(-1, 1, DRAWN)
    ball = lens(
        [
            {"radius": radius, "thickness": 2 * radius, "index": index, "stop": True},
            {"radius": -radius, "index": surroundings},
        ],
        {"entrance_pupil_diameter": 2 * radius * aperture},
        [0.0],
        [0.5876],
        object_index=surroundings,
    )
    found = jax.device_get(jax.jit(beam)(ball, np.concatenate([table, curve, drawn])))
    out = jax.tree.map(lambda a: a[-2], found.path)
    # of a ray, from the rear face, since one that is turned by more than 90 degrees has no course to a plane behind it
    crossings = radius + np.where(out.m == 0, found.crossing, out.z - out.y * out.n / np.where(out.m == 0, 1, out.m))
    turned = -np.arctan2(out.m, out.n)
    measured = np.split(crossings, [len(table), len(table) + CURVE])
    theory, on_curve = _theory(n, radius, table), _theory(n, radius, curve)

    f = n * radius / (2 * (n - 1))
    # a crossing is a height by a slope, both of which are rounded
    within = ROUNDING * (abs(f) + f * f / radius)
    rows = [
        Comparison("focal length", "mm", measured[1][0], f, within),
        Comparison("back focal length", "mm", measured[1][0] - radius, f - radius, within + ROUNDING * radius),
    ]
    degrees = np.degrees([turned[: len(heights)], theory.turned])
    for i, height in enumerate(heights):
        at = f"ray at {height:g} R"
        within = ROUNDING * (radius + theory.crossing[i] ** 2 / radius)
        rows += [
            Comparison(f"{at}: crosses the axis", "mm", measured[0][i], theory.crossing[i], within),
            Comparison(f"{at}: is turned", "deg", degrees[0, i], degrees[1, i], math.degrees(ROUNDING)),
        ]
    path = jax.tree.map(lambda a: a[:, -DRAWN:], found.path)
    rays = course(ball, path, FAR * radius)
    rays[0] -= radius
    return BallLens(
        setting=f"a ball of radius {radius:g} mm and index {index:g} in a medium of index {surroundings:g}, its focus "
        f"{_where(f, radius)}; z from its centre",
        rows=tuple(rows),
        radius=radius,
        focus=f,
        rays=rays,
        heights=curve,
        crossings=measured[1],
        crossings_theory=on_curve.crossing,
    )


def _theory(n: float, radius: float, height: np.ndarray) -> _Theory:
    """See the docstring of this file; sin(i - r) and cos(i - r) written so that nothing cancels."""
    sine = height / radius
    cosine, root = np.sqrt((1 - sine) * (1 + sine)), np.sqrt((n - sine) * (n + sine))  # cos i, n cos r
    along = (cosine * root + sine * sine) / n
    # sin(i - r) / sin i
    across = (n - 1) * (n + 1) / (n * (root + cosine))
    return _Theory(radius / (2 * across * along), 2 * np.arctan2(sine * across, along))


def _check(n: float, height: float) -> None:
    """OptionError for the highest ray, in radii, where it does not leave through the rear half."""
    if height >= n:
        raise OptionError(f"ball-lens: the ray at {height:g} R is reflected totally; keep all rays below {n:.4g} R")
    if 2 * math.asin(height / n) - math.asin(height) >= math.pi / 2:
        raise OptionError(f"ball-lens: the ray at {height:g} R leaves through the front half; take lower rays")


def _where(focus: float, radius: float) -> str:
    if focus < 0:
        return "in front of it, where rays seem to come from"
    return "inside" if focus < radius else "behind it"
