"""Pairs of shapes that exchange light, and rays cast from one to the other.

A ray goes from a point of shape 1 to a point of shape 2, which are made of numbers evenly spread over a unit cube. It
counts what it would contribute if nothing were in the way,

    (density of such rays)^-1 cos a_1 cos a_2 / (pi r^2 A_1),

so that the average over the cube is the view factor. Numbers are spent as the shapes need them: what their symmetry
makes alike is not drawn, and the upright rectangle is aimed at by angles, for pairs of points that are near each other,
where the shapes meet, would count without bound.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lenstrace.phenomena.lines.howell import coaxial_disks, parallel_rectangles, perpendicular_rectangles
from lenstrace.phenomena.lines.screened import screened_squares

SCREEN = 0.5  # side of the screen between two unit squares
POINTS = 73  # of the outline of a disk, and the first again
GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))  # radians; turns by it go evenly to all sides

Point = tuple[np.ndarray, np.ndarray, np.ndarray]


class Rays(NamedTuple):
    """Rays, (N,): both ends, and what each counts where nothing is in the way."""

    start: Point
    end: Point
    weight: np.ndarray


class Exchange(NamedTuple):
    """Two shapes.

    text:        in words.                  factor:  the view factor in closed form.
    dimensions:  numbers that a ray takes.  rays:    made of these, (N, D).
    smooth:      what a ray counts has no edges and no corners.
    outlines:    of the shapes, and of the screen where there is one, (M, 3) each.
    round:       it looks alike from all sides, and all rays are made to begin on one.
    screen:      low and high end of a square, in x as in y, and its z; or None.
    """

    text: str
    factor: float
    dimensions: int
    rays: Callable[[np.ndarray], Rays]
    smooth: bool
    outlines: tuple[np.ndarray, ...]
    round: bool = False
    screen: tuple[float, float, float] | None = None

    def arrive(self, rays: Rays) -> np.ndarray:
        """Which rays are not stopped on their way."""
        if self.screen is None:
            return np.ones(rays.weight.shape, bool)
        low, high, z = self.screen
        (x, y, z_0), (x_1, y_1, z_1) = rays.start, rays.end
        t = (z - z_0) / (z_1 - z_0)
        x, y = x + t * (x_1 - x), y + t * (y_1 - y)
        return (x < low) | (x > high) | (y < low) | (y > high)

    def shown(self, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """For a picture: both ends of rays, (N, 3) each, to all sides, and which of them arrive."""
        rays = self.rays(numbers)
        ends = np.stack([np.stack(rays.start, -1), np.stack(rays.end, -1)])
        if self.round:
            turn = np.exp(1j * GOLDEN_ANGLE * np.arange(len(numbers)))
            turned = (ends[..., 0] + 1j * ends[..., 1]) * turn
            ends = np.stack([turned.real, turned.imag, ends[..., 2]], -1)
        return ends[0], ends[1], self.arrive(rays)

    def contributions(self, numbers: np.ndarray) -> np.ndarray:
        """What the rays made of numbers, (N, D), count: their mean is the view factor."""
        rays = self.rays(numbers)
        return rays.weight * self.arrive(rays)


def parallel(height: float) -> Exchange:
    """A unit square and another so far above it."""
    return Exchange(
        text=f"unit squares that face each other at the distance {height:g}",
        factor=parallel_rectangles(1, 1, height),
        dimensions=4,
        rays=lambda numbers: _upward(numbers.T, height),
        smooth=True,
        outlines=(_square(0), _square(height)),
    )


def blocker(height: float) -> Exchange:
    """The same with a smaller square halfway between them."""
    low, high = (1 - SCREEN) / 2, (1 + SCREEN) / 2
    return parallel(height)._replace(
        text=f"unit squares that face each other at the distance {height:g}, a square of side {SCREEN:g} halfway",
        factor=screened_squares(height, SCREEN),
        smooth=False,
        outlines=(_square(0), _square(height), _square(height / 2, low, high)),
        screen=(low, high, height / 2),
    )


def perpendicular(height: float) -> Exchange:
    """A unit square and a rectangle so high that stands on one of its edges."""
    upright = np.array([[0, 0, 0], [0, 1, 0], [0, 1, height], [0, 0, height], [0, 0, 0]])
    return Exchange(
        text=f"a unit square and an upright rectangle on its edge, {height:g} high",
        factor=perpendicular_rectangles(1, height, 1),
        dimensions=4,
        rays=lambda numbers: _to_upright(numbers.T, height),
        smooth=False,
        outlines=(_square(0), upright),
    )


def disks(height: float) -> Exchange:
    """A disk of radius 1 and another so far above it."""
    turn = np.linspace(0, 2 * np.pi, POINTS)
    rim = np.stack([np.cos(turn), np.sin(turn), 0 * turn], -1)
    return Exchange(
        text=f"disks of radius 1 on one axis, that face each other at the distance {height:g}",
        factor=coaxial_disks(1, 1, height),
        dimensions=3,
        rays=lambda numbers: _between_disks(numbers.T, height),
        smooth=True,
        outlines=(rim, rim + np.array([0, 0, height])),
        round=True,
    )


EXCHANGES: dict[str, Callable[[float], Exchange]] = {
    each.__name__: each for each in (parallel, perpendicular, disks, blocker)
}


def _upward(numbers: np.ndarray, height: float) -> Rays:
    """Both points evenly over unit squares."""
    x, y, x_1, y_1 = numbers
    weight = height**2 / (math.pi * ((x_1 - x) ** 2 + (y_1 - y) ** 2 + height**2) ** 2)
    return Rays((x, y, np.zeros_like(x)), (x_1, y_1, np.full_like(x, height)), weight)


def _between_disks(numbers: np.ndarray, height: float) -> Rays:
    """Both points evenly over unit disks, the first at the azimuth 0 and the second at one from 0 to pi."""
    r, r_1, turn = np.sqrt(numbers[0]), np.sqrt(numbers[1]), np.pi * numbers[2]
    x, y = r_1 * np.cos(turn), r_1 * np.sin(turn)
    weight = height**2 / ((x - r) ** 2 + y**2 + height**2) ** 2
    return Rays((r, np.zeros_like(r), np.zeros_like(r)), (x, y, np.full_like(r, height)), weight)


def _to_upright(numbers: np.ndarray, height: float) -> Rays:
    """The first point evenly over a unit square, the second in the plane x = 0 evenly by two angles.

    alpha is the direction's elevation, seen along the edge, and beta its angle with the plane y = const:
    cos a_1 d(solid angle) = cos(beta) sin(alpha) cos(beta) d(alpha) d(beta).
    """
    x, y, across, along = numbers
    steepest = np.arctan2(height, x)
    alpha = steepest * across
    cosine = np.cos(alpha)
    low, high = np.arctan2(-y * cosine, x), np.arctan2((1 - y) * cosine, x)
    beta = low + (high - low) * along
    weight = np.cos(beta) ** 2 * np.sin(alpha) * steepest * (high - low) / math.pi
    away = x / cosine
    return Rays((x, y, np.zeros_like(x)), (np.zeros_like(x), y + away * np.tan(beta), away * np.sin(alpha)), weight)


def _square(z: float, low: float = 0.0, high: float = 1.0) -> np.ndarray:
    return np.array([[low, low, z], [high, low, z], [high, high, z], [low, high, z], [low, low, z]])
