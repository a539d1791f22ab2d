"""Where in the pupil rays are sent: patterns of points in the unit disk."""

from __future__ import annotations

import numpy as np

from lenstrace.errors import RayError

PATTERNS = ("hexapolar", "grid", "random", "sobol")
SEED = 20
# 751,501 rays for each field and wavelength; more do not fit into the memory of a small machine.
MOST_RINGS = 500


def pupil_points(pattern: str = "hexapolar", rings: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """x and y of the points of a pattern, each (N,), in units of the pupil's radius, all of equal weight.

    hexapolar:  the centre and 6 k points on ring k of radius k / rings, the first toward +x: 1 + 3 r (r + 1) in all.
    grid:       the points of a square grid of step 1 / rings that lie within the disk.
    random:     uniform over the disk, as many as hexapolar has; the same ones every time.
    sobol:      as random, from a scrambled Sobol sequence: more even.
    RayError for an unknown pattern or fewer than 1 ring.

    >>> [len(pupil_points(pattern, 6)[0]) for pattern in PATTERNS]
    [127, 113, 127, 127]
    """
    if not isinstance(rings, int | np.integer) or not 1 <= rings <= MOST_RINGS:
        raise RayError(f"rings must be at least 1 and at most {MOST_RINGS}, a whole number, got {rings!r}")
    match pattern:
        case "hexapolar":
            ring = np.repeat(np.arange(1, rings + 1), 6 * np.arange(1, rings + 1))
            place = np.arange(len(ring)) - 3 * ring * (ring - 1)
            radius, turn = np.append(0.0, ring / rings), np.append(0.0, place / (6 * ring))
        case "grid":
            steps = np.arange(-rings, rings + 1)
            i, j = (a.ravel() for a in np.meshgrid(steps, steps, indexing="ij"))
            inside = i * i + j * j <= rings * rings
            return i[inside] / rings, j[inside] / rings
        case "random":
            area, turn = np.random.default_rng(SEED).random((2, _count(rings)))
            radius = np.sqrt(area)
        case "sobol":
            from scipy.stats import qmc  # 0.4 s to import, needed by this pattern alone

            power = int(np.ceil(np.log2(_count(rings))))
            area, turn = qmc.Sobol(2, rng=np.random.default_rng(SEED)).random_base2(power)[: _count(rings)].T
            radius = np.sqrt(area)
        case _:
            raise RayError(f"unknown pupil pattern {pattern!r}; one of {', '.join(PATTERNS)}")
    return radius * np.cos(2 * np.pi * turn), radius * np.sin(2 * np.pi * turn)


def _count(rings: int) -> int:
    return 1 + 3 * rings * (rings + 1)
