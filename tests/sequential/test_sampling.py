"""Patterns of points in the pupil, against integrals over the unit disk in closed form."""

import math

import numpy as np
import pytest

from lenstrace.errors import RayError
from lenstrace.sequential.sampling import PATTERNS, PupilPoints, pupil_points, radial_rule, rim_rule


def mean(points: PupilPoints, a: int, b: int) -> float:
    return float(points.weight @ (points.x**a * points.y**b) / points.weight.sum())


def moment(a: int, b: int) -> float:
    """The mean of x^a y^b over the unit disk."""
    if a % 2 or b % 2:
        return 0.0
    return 2 / (a + b + 2) * math.gamma((a + 1) / 2) * math.gamma((b + 1) / 2) / math.gamma((a + b) / 2 + 1) / math.pi


@pytest.mark.parametrize("rings", [1, 2, 3, 6])
def test_gaussian_integrates_every_polynomial_of_its_degree(rings: int) -> None:
    points = pupil_points("gaussian", rings)
    assert points.weight.mean() == pytest.approx(1, abs=1e-15)
    assert len(points.x) == 4 * rings**2
    degree = 4 * rings - 2
    for a in range(degree + 1):
        for b in range(degree + 1 - a):
            assert mean(points, a, b) == pytest.approx(moment(a, b), abs=1e-15), (a, b)
    # and no more: r^(4 r)
    assert (
        abs(float(points.weight @ np.hypot(points.x, points.y) ** (4 * rings)) / len(points.x) - 1 / (2 * rings + 1))
        > 1e-8
    )


@pytest.mark.parametrize("rings", [1, 2, 5, 40])
def test_radial_rules_integrate_powers_and_err_to_opposite_sides(rings: int) -> None:
    (r, share), (rim, rim_share) = radial_rule(rings), rim_rule(rings)
    assert (rim[0], rim[-1]) == (0, 1)
    for power in range(2 * rings):
        assert share @ r ** (2 * power) == pytest.approx(1 / (power + 1), abs=1e-14)
        assert rim_share @ rim ** (2 * power) == pytest.approx(1 / (power + 1), abs=1e-14)
    if rings < 10:
        one, two = (w @ a ** (4 * rings) - 1 / (2 * rings + 1) for w, a in ((share, r), (rim_share, rim)))
        assert two / one == pytest.approx(-(1 + 1 / rings), rel=1e-6)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_every_pattern_tends_to_the_disk(pattern: str) -> None:
    points = pupil_points(pattern, 40)
    assert np.hypot(points.x, points.y).max() <= 1 + 1e-15
    for a, b in ((1, 0), (0, 1), (2, 0), (0, 2), (4, 2)):
        assert mean(points, a, b) == pytest.approx(moment(a, b), abs=0.03)


@pytest.mark.parametrize("rings", [0, -1, 501, 2.5, True])
def test_rings_that_are_none(rings: object) -> None:
    with pytest.raises(RayError, match="rings must be at least 1"):
        pupil_points("gaussian", rings)  # type: ignore[arg-type]
