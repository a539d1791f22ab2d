"""The tracer against the judge, of lenses and rays that hypothesis makes up, near extremes and far from them.

By itself a short search, the same every time. LENSTRACE_EXTREMES=500 in the environment makes it 500 lenses of each
kind in each precision, other ones every time:

    LENSTRACE_EXTREMES=500 python -m pytest -n 2 tests/sequential/test_extreme_search.py
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import lenstrace
from lenstrace import Lens
from lenstrace.analysis.extremes.errors import backward_error, course_of, judged_fate
from lenstrace.analysis.extremes.lenses import made
from lenstrace.sequential.reference_surface import surfaces_of_system

MOST = 16.0  # C for each surface crossed
ASKED = int(os.environ.get("LENSTRACE_EXTREMES", "0"))
SEARCH = settings(
    max_examples=ASKED or 12,
    phases=(Phase.explicit, Phase.generate),  # to make a failing example smaller takes minutes
    report_multiple_bugs=False,
    derandomize=not ASKED,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)

NEARLY_FLAT = st.sampled_from([0.0, 1e-9, -1e-9, 1e-30])
CURVATURES = st.floats(1e-4, 0.2) | st.floats(-0.2, -1e-4) | NEARLY_FLAT
CONICS = st.sampled_from([0.0, -1.0, -1 + 1e-9, -3.0, 5.0]) | st.floats(-4.0, 2.0)
RATIOS = st.sampled_from([1.5, 1 + 1e-9, 1 + 1e-14]) | st.floats(1.2, 2.2)
# of the smallest radius; up to the rim of a hemisphere
LOW = st.floats(0.0, 0.4)
HEIGHTS = st.floats(0.0, 1.0) | st.floats(1.0, 15.0).map(lambda digits: 1 - 10**-digits)
ANGLES = st.floats(-20.0, 20.0) | st.floats(-89.0, 89.0) | st.floats(-12.0, 0.0).map(lambda digits: 10**digits)
MILD_ANGLES = st.floats(-10.0, 10.0)
DISTANCES = st.sampled_from([0.0, 5.0, 100.0, 1e4, 1e9])
TILTS = st.floats(0.01, 15.0)
SHIFTS = st.floats(1e-6, 0.1)
TERMS = st.floats(-0.2, 0.2)  # sag of an asphere's term at the smallest radius, in its units
RAYS, WILD = 4, 1  # in all, and those that are not aimed so that they arrive
ARRIVING = 0.75  # so many do, at least


@st.composite
def lenses(draw: st.DrawFn, kind: str = "conics") -> tuple[Lens, np.ndarray]:
    """Four conics, two glasses, and rays (N, 6); tilted: curvatures are moderate and three surfaces stand askew;
    aspheric: the first and the third have terms up to r^16."""
    rows: list[dict[str, Any]] = [
        {
            "curvature": draw(CURVATURES if kind == "conics" else st.floats(0.001, 0.1)),
            "conic": draw(CONICS),
        }
        for _ in range(4)
    ]
    # rays that stay near the axis meet every surface
    radius = min(20.0, *(1 / max(abs(row["curvature"]) * max(1.0, 1 + row["conic"]) ** 0.5, 0.01) for row in rows))
    for row in rows:
        row["thickness"] = radius * draw(st.floats(0.01, 0.5))
    rows[0]["index"], rows[2]["index"] = draw(RATIOS), draw(RATIOS)
    if kind == "tilted":
        for number in (0, 2, 3):
            rows[number] |= {"tilt": [draw(TILTS) for _ in range(3)], "decenter": [radius * draw(SHIFTS), 0.1 * radius]}
        rows[2]["break"] = True
    if kind == "aspheric":
        for number in (0, 2):
            rows[number]["asphere"] = {power: radius * draw(TERMS) / radius**power for power in (4, 5, 16)}
    rays = []
    for number in range(RAYS):
        wild = number < WILD
        h, around = radius * draw(HEIGHTS if wild else LOW), draw(st.floats(0.0, 6.28))
        distance = draw(DISTANCES)
        angle = draw(ANGLES if wild else MILD_ANGLES)
        across, along = np.sin(np.radians([draw(MILD_ANGLES), angle]))
        direction = np.array([across, np.sqrt(1 - across**2) * along, np.sqrt((1 - across**2) * (1 - along**2))])
        point = np.array([h * np.cos(around), h * np.sin(around), 0.0]) - distance * direction
        rays.append([*point, *(direction / np.linalg.norm(direction))])
    return made(rows), np.array(rays)


def check(lens: Lens, rays: np.ndarray, precision: str) -> list[bool]:
    """The tracer errs no more than MOST eps a surface in the backward sense; statuses are the judge's, a failure to
    converge among them. Returns which rays arrive."""
    lens, eps = lens.astype(precision), float(np.finfo(precision).eps)
    x, y, z, l, m, n = rays.T
    path = lenstrace.trace(lens, lenstrace.ray((x, y, z), (l, m, n)))
    values = np.stack([np.asarray(a) for a in (path.x, path.y, path.z, path.l, path.m, path.n, path.opl)], -1)
    assert np.isfinite(values).all()
    surfaces = surfaces_of_system(lens.system.at(0))
    failures = np.asarray(path.failure)[-1]
    for i, ray in enumerate(rays.astype(precision).astype(float)):
        rows = course_of(surfaces, ray)
        agrees, last = judged_fate(surfaces, ray, rows, int(failures[i]), eps)
        assert agrees
        for surface in range(1, last + 1):
            assert backward_error(rows[surface], values[surface, i], eps) <= MOST * surface
    return list(failures == 0)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("kind", ["conics", "tilted", "aspheric"])
def test_lenses_that_are_searched(kind: str, precision: str) -> None:
    arrived: list[bool] = []

    @SEARCH
    @given(case=lenses(kind))
    def search(case: tuple[Lens, np.ndarray]) -> None:
        arrived.extend(check(*case, precision))

    search()
    assert np.mean(arrived) > ARRIVING
