"""Where in the pupil rays are sent, and with what weight: patterns of points in the unit disk."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from lenstrace.errors import RayError

PATTERNS = ("hexapolar", "grid", "random", "sobol", "gaussian")
SEED = 20
KEPT = 16  # patterns
# 751,501 rays for each field and wavelength; more do not fit into the memory of a small machine.
MOST_RINGS = 500
# Spokes for each ring of the gaussian pattern: then it integrates every polynomial in x and y of degree 4 r - 2.
SPOKES = 4
# x of a point on the y axis, where cosines leave rounding.
ON_AXIS = 1e-12


class PupilPoints(NamedTuple):
    """N points of the pupil: x, y in units of its radius, and weight, of mean 1; each (N,)."""

    x: np.ndarray
    y: np.ndarray
    weight: np.ndarray


def pupil_points(pattern: str = "hexapolar", rings: int = 6) -> PupilPoints:
    """The points of a pattern.

    hexapolar:  the centre and 6 k points on ring k of radius k / rings, the first toward +x: 1 + 3 r (r + 1) in all.
    grid:       the points of a square grid of step 1 / rings that lie within the disk.
    random:     uniform over the disk, as many as hexapolar has; the same ones every time.
    sobol:      as random, from a scrambled Sobol sequence: more even.
    gaussian:   Gauss's quadrature in the square of the radius on 4 r evenly spaced spokes: 4 r^2 points. Of a smooth
                function the error falls exponentially with r. Source: Forbes, JOSA A 5, 1943 (1988).
    All weights are 1 but those of the last one. RayError for an unknown pattern or fewer than 1 ring.

    >>> [len(pupil_points(pattern, 6).x) for pattern in PATTERNS]
    [127, 113, 127, 127, 144]
    """
    if isinstance(rings, bool) or not isinstance(rings, int | np.integer) or not 1 <= rings <= MOST_RINGS:
        raise RayError(f"rings must be at least 1 and at most {MOST_RINGS}, a whole number, got {rings!r}")
    if pattern not in PATTERNS:
        raise RayError(f"unknown pupil pattern {pattern!r}; one of {', '.join(PATTERNS)}")
    return _points(pattern, int(rings))


@functools.lru_cache(maxsize=KEPT)
def _points(pattern: str, rings: int) -> PupilPoints:
    """As `pupil_points`; kept, and not to be written to: many points take longer to make than to trace."""
    points = _made(pattern, rings)
    for array in points:
        array.flags.writeable = False
    return points


def _made(pattern: str, rings: int) -> PupilPoints:
    match pattern:
        case "grid":
            steps = np.arange(-rings, rings + 1)
            i, j = (a.ravel() for a in np.meshgrid(steps, steps, indexing="ij"))
            inside = i * i + j * j <= rings * rings
            return PupilPoints(i[inside] / rings, j[inside] / rings, np.ones(inside.sum()))
        case "random" | "sobol":
            return chance_points(pattern, _count(rings))
        case "gaussian":
            radius, weight = radial_rule(rings)
            turn = spoke_turns(SPOKES * rings)
            weight = np.repeat(weight * rings, len(turn))
            return PupilPoints(*_polar(np.repeat(radius, len(turn)), np.tile(turn, rings)), weight)
        case _:  # hexapolar
            ring = np.repeat(np.arange(1, rings + 1), 6 * np.arange(1, rings + 1))
            place = np.arange(len(ring)) - 3 * ring * (ring - 1)
            radius, turn = np.append(0.0, ring / rings), np.append(0.0, place / (6 * ring))
            return PupilPoints(*_polar(radius, turn), np.ones(len(radius)))


def half_points(points: PupilPoints) -> PupilPoints | None:
    """The points with x >= 0, those off the line x = 0 with twice the weight; None where the others are no mirror image
    of them."""
    weights = {(round(x, 9) + 0.0, round(y, 9) + 0.0): w for x, y, w in zip(*points, strict=True)}
    if any(weights.get((0.0 - x, y)) != w for (x, y), w in weights.items()):
        return None
    x, y, weight = (a[points.x > -ON_AXIS] for a in points)
    off = x > ON_AXIS
    return PupilPoints(np.where(off, x, 0.0), y, np.where(off, 2 * weight, weight))


def chance_points(pattern: str, count: int) -> PupilPoints:
    """So many points of the random or the sobol pattern; a power of two suits the latter."""
    if pattern == "random":
        area, turn = np.random.default_rng(SEED).random((2, count))
    else:
        from scipy.stats import qmc  # 0.4 s to import, needed by this pattern alone

        power = int(np.ceil(np.log2(count)))
        area, turn = qmc.Sobol(2, rng=np.random.default_rng(SEED)).random_base2(power)[:count].T
    return PupilPoints(*_polar(np.sqrt(area), turn), np.ones(count))


def radial_rule(rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Radii and weights, (rings,), of sum 1, of Gauss's quadrature over the unit disk of what depends on r alone: nodes
    of Legendre's polynomial in r^2."""
    node, weight = np.polynomial.legendre.leggauss(rings)
    return np.sqrt((1 + node) / 2), weight / 2


def rim_rule(rings: int) -> tuple[np.ndarray, np.ndarray]:
    """As `radial_rule`, by Lobatto's quadrature: radii and weights, (rings + 1,); the first radius is 0, the last 1.
    It is as exact, and errs to the other side."""
    legendre = np.polynomial.Legendre.basis(rings)
    node = np.concatenate([[-1.0], np.sort(legendre.deriv().roots().real), [1.0]])
    return np.sqrt((1 + node) / 2), 1 / (rings * (rings + 1) * legendre(node) ** 2)


def spoke_turns(spokes: int) -> np.ndarray:
    """Angles of evenly spaced spokes in turns from +x, none on the y axis and half of them on either side of it."""
    return 0.25 + (np.arange(spokes) + 0.5) / spokes


def _polar(radius: np.ndarray, turn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return radius * np.cos(2 * np.pi * turn), radius * np.sin(2 * np.pi * turn)


def _count(rings: int) -> int:
    return 1 + 3 * rings * (rings + 1)
