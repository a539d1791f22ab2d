"""How far derivatives of one ray are from the judge's, in units of what they are known to.

An error of d result / d number is taken as a multiple of

    eps (size of what is rounded on the way) + change of the derivatives of that result where all numbers move by eps,

over a group of like numbers (all curvatures, all gaps, ...), each result by itself. The first are the `sizes` of
`ConditionedRow`: components of a point or of a direction are known to the same size, as they are in `errors`.
Lengths count in units of the largest that the ray has met.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lenstrace.analysis.extremes.errors import course_of
from lenstrace.analysis.extremes.launch import JudgedLaunch
from lenstrace.analysis.extremes.moves import moved
from lenstrace.sequential.reference_conditions import ConditionedRow
from lenstrace.sequential.reference_layout import Layout, layout_of
from lenstrace.sequential.reference_surface import ReferenceSurface

CHAIN = 2.0**-52  # what the judge's chain of derivatives, of numbers of about 1, is rounded to
# Beyond so much a surface the numbers are moved again, at most so often: their changes may cancel by chance.
PLAIN, SAMPLES = 8.0, 3
NOTHING = 1e-14  # derivatives below this are its rounding of 0
LENGTHS = np.array([True] * 3 + [False] * 3 + [True])


def gradient_error(
    surfaces: Sequence[ReferenceSurface],
    start: np.ndarray,
    row: ConditionedRow,
    computed: np.ndarray,
    eps: float,
    launch: JudgedLaunch | None = None,
    by_launch: np.ndarray | None = None,
) -> float | None:
    """Worst error of derivatives (7, I) of a ray at its last surface, by all numbers of ray and lens; None where
    numbers moved by an eps lose the ray, for then it has no derivative to be judged by.

    launch, by_launch: of a launched ray the judge's launch, and its derivatives (7, 4) by field and pupil.
    """
    assert row.sizes is not None
    layout, length = layout_of(surfaces), row.length or 1.0
    weights, groups = _weights(surfaces, layout, length), _groups(layout)
    across = _across(computed, start)
    ray = slice(layout.point.start, layout.direction.stop)
    change, worst = np.zeros_like(row.slopes), np.inf
    for seed in range(SAMPLES):
        signs = np.random.default_rng(seed).choice([-1.0, 1.0], layout.size)
        there = course_of(*moved(surfaces, start, eps * signs))
        if len(there) != len(surfaces) + 1 or not np.isfinite(there[-1].slopes).all():
            return None
        change = np.maximum(change, np.abs(there[-1].slopes - row.slopes))
        worst = _worst(row.slopes, row.sizes, change, across, weights, groups, length, eps)
        if launch is not None and by_launch is not None:
            true, sizes = row.slopes[:, ray] @ launch.slopes, row.sizes[:, ray] @ np.abs(launch.slopes)
            nearby = [np.abs(there[-1].slopes[:, ray] @ slopes - true) for slopes in launch.nearby]
            units = np.array([launch.field_size(length)] * 2 + [1.0] * 2)
            # the smaller: on the side on which the launch goes on as it is
            changed = np.minimum(*nearby)
            worst = max(worst, _worst(true, sizes, changed, by_launch, units, np.array([0, 0, 1, 1]), length, eps))
        if worst <= PLAIN * len(surfaces):
            break
    return worst


def _worst(
    true: np.ndarray,
    sizes: np.ndarray,
    change: np.ndarray,
    found: np.ndarray,
    weights: np.ndarray,
    groups: np.ndarray,
    length: float,
    eps: float,
) -> float:
    """Of derivatives (7, N) by N numbers. weights: (N,), of units that make the derivatives pure numbers."""
    scale = np.where(LENGTHS, length, 1.0)[:, None]
    true, sizes, change, found = (slopes * weights / scale for slopes in (true, sizes, change, found))
    true, found = (np.where(np.abs(slopes) < NOTHING, 0, slopes) for slopes in (true, found))
    worst = 0.0
    for group in range(max(groups) + 1):
        these = groups == group
        error, changed, size = (np.abs(slopes[:, these]).max(1) for slopes in (found - true, change, sizes))
        # where all are 0 their own size says nothing: then that of a number of about 1
        worst = max(worst, float((error / (eps * np.where(size, size, 1) + changed + CHAIN)).max()))
    return worst


def _weights(surfaces: Sequence[ReferenceSurface], layout: Layout, length: float) -> np.ndarray:
    """(I,): the unit of each number, of lengths the given one; 0 for the gap before the first surface, of which there
    is none."""
    weights = np.ones(layout.size)
    weights[layout.point] = length
    for own in layout.blocks(weights):
        own[layout.curvature] = 1 / length
        own[layout.coefficients] = [length ** (1 - p) for p in max((s.powers for s in surfaces), key=len)]
        own[layout.gap] = own[layout.decenter] = length
    layout.blocks(weights)[0, layout.gap] = 0
    return weights


def _groups(layout: Layout) -> np.ndarray:
    """(I,): a number of its group for each; a term of an asphere is a group of its own."""
    groups = np.zeros(layout.size, int)
    groups[layout.direction], groups[layout.indices] = 1, 2
    for own in layout.blocks(groups):
        own[:] = 3 + np.arange(layout.width)
        for place in (layout.decenter, layout.tilt):
            own[place] = own[place].min()
    return np.unique(groups, return_inverse=True)[1]


def _across(slopes: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Derivatives by the direction, of changes that leave it a unit vector."""
    along = start[3:] / np.linalg.norm(start[3:])
    across = slopes.copy()
    across[:, Layout.direction] -= np.outer(slopes[:, Layout.direction] @ along, along)
    return across
