"""The problems that the issue of optimization is measured by."""

from __future__ import annotations

import math

import numpy as np
import pytest

import lenstrace
from lenstrace import Lens, Problem
from lenstrace.design import Curvature, FocalLength, SpotRMS, Thickness


def perturbed(lens: Lens, gaps: list[int]) -> Problem:
    """The published lens with its radii times 0.97, 1.03, 0.97, ..., all of which may vary, and some gaps; nine spots
    and the focal length of before are wanted."""
    largest = max(map(abs, lens.fields.y))
    lens = lens.replace(fields=lenstrace.Fields((0.0,) * 3, (0.0, 0.7 * largest, largest), "angle"))
    focal_length = float(lenstrace.first_order(lens).focal_length[lens.wavelengths.primary])
    curved = [n for n, row in enumerate(lens, 1) if math.isfinite(row.radius)]
    factors = dict(zip(curved, np.resize([0.97, 1.03], len(curved)), strict=True))
    start = lens
    for n, factor in factors.items():
        start = start.replace(surface=n, radius=lens[n].radius * factor)
    vary = [Curvature(curved), Thickness(gaps, bounds=(0.1, None)), Thickness("last")]
    return Problem(start, vary=vary, want=[SpotRMS(), FocalLength(focal_length)])


@pytest.fixture(scope="session")
def problem_a(designs: dict[str, Lens]) -> Problem:
    """The Cooke triplet, nine variables."""
    return perturbed(designs["cooke_triplet"], [2, 4])


@pytest.fixture(scope="session")
def problem_b(designs: dict[str, Lens]) -> Problem:
    """The double Gauss, thirteen variables."""
    return perturbed(designs["double_gauss"], [2, 5, 6, 9])
