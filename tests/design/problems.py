"""Known problems: the lenses of other programs' comparisons out of shape, and flat plates."""

from __future__ import annotations

import math

import numpy as np

import lenstrace
from lenstrace import Lens, Problem
from lenstrace.design import Curvature, EdgeThickness, FocalLength, SpotRMS, Thickness

GAPS = {"cooke_triplet": [2, 4], "double_gauss": [2, 5, 6, 9]}


def perturbed(lens: Lens, gaps: list[int]) -> Problem:
    """The published lens with its radii times 0.97, 1.03, 0.97, ..., all of which may vary, and some gaps of at least
    0.1 mm; nine spots and the focal length of before are wanted."""
    largest = max(map(abs, lens.fields.y))
    lens = lens.replace(fields=lenstrace.Fields((0.0,) * 3, (0.0, 0.7 * largest, largest), "angle"))
    focal_length = float(lenstrace.first_order(lens).focal_length[lens.wavelengths.primary])
    curved = [n for n, row in enumerate(lens, 1) if math.isfinite(row.radius)]
    start = lens
    for n, factor in zip(curved, np.resize([0.97, 1.03], len(curved)), strict=True):
        start = start.replace(surface=n, radius=lens[n].radius * factor)
    vary = [Curvature(curved), Thickness(gaps, bounds=(0.1, None)), Thickness("last")]
    return Problem(start, vary=vary, want=[SpotRMS(), FocalLength(focal_length)])


def plates(lens: Lens, rings: int) -> Problem:
    """Flat plates of the glasses of a triplet, 50 mm f/5, all of whose curvatures and gaps may vary: glass of 1 to
    8 mm, air and edges of at least 0.5 mm."""
    flat = lens.replace(curvature=[0.0] * 6, thickness=[3.0, 5.0, 2.0, 5.0, 3.0, 42.0])
    vary = [
        Curvature([1, 2, 3, 4, 5, 6]),
        Thickness([1, 3, 5], bounds=(1.0, 8.0)),
        Thickness([2, 4], bounds=(0.5, 15.0)),
        Thickness("last", bounds=(20.0, 60.0)),
    ]
    edges = EdgeThickness(min=0.51, surfaces=[1, 2, 3, 4, 5], weight=3.0)
    return Problem(flat, vary=vary, want=[SpotRMS(rings=rings), FocalLength(50.0, weight=0.1), edges])
