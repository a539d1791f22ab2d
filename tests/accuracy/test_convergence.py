"""Ladders of pairs of rules: where they stop, and how honest their estimates are."""

import math

import numpy as np
import pytest

from lenstrace.accuracy.convergence import Answer, converge, estimate
from lenstrace.errors import AccuracyError
from lenstrace.sequential.sampling import radial_rule, rim_rule

LADDER = tuple(range(1, 30))


def pair(function: object, count: int) -> Answer[int]:
    """Of the integral of f(s) from 0 to 1, by Gauss and Lobatto; the mean is the answer."""
    gauss, lobatto = (float(w @ function(r**2)) for r, w in (radial_rule(count), rim_rule(count)))  # type: ignore[operator]
    return Answer(count, np.array([(gauss + lobatto) / 2]), np.array([abs(gauss - lobatto)]))


# integrands over 0 ... 1 and their integrals
FUNCTIONS = {
    "exponential": (np.exp, math.e - 1),
    "pole nearby": (lambda s: 1 / (1.1 - s), math.log(11.0)),
    "oscillating": (lambda s: np.cos(20 * s), math.sin(20.0) / 20),
    "root at the edge": (np.sqrt, 2 / 3),
    "kink": (lambda s: np.abs(s - 0.3), (0.3**2 + 0.7**2) / 2),
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-6])
def test_the_error_is_within_its_estimate(name: str, tolerance: float) -> None:
    function, truth = FUNCTIONS[name]
    found = converge(lambda count: pair(function, count), LADDER, tolerance, floor=1e-15)
    error = abs(found.value[0] - truth)
    # where a kink falls between the nodes is chance: then both rules may miss to one side
    assert error <= found.error[0] * (2 if name == "kink" else 1)
    assert found.reached == (found.error[0] <= tolerance * abs(found.value[0]))
    assert not found.reached or error <= tolerance * truth


def test_a_smooth_integrand_takes_the_first_step_that_does() -> None:
    found = converge(lambda count: pair(np.exp, count), LADDER, 4e-7)
    assert found.step == found.found == 4
    assert pair(np.exp, 3).difference[0] > 4e-7 * (math.e - 1)


def test_a_difference_that_vanishes_by_chance_is_not_believed() -> None:
    falling = [np.array([1e-2]), np.array([1e-3])]
    assert estimate(falling, np.array([1e-12]))[0] == pytest.approx(0.42 * 0.4 * 1e-4)
    assert estimate([np.array([2e-3]), np.array([1e-3])], np.array([1e-12]))[0] == pytest.approx(0.55e-3)
    assert estimate(falling[:1], np.array([1e-12]))[0] == pytest.approx(0.42 * 0.03 * 1e-2)
    assert estimate([], np.array([1e-12]))[0] == 1e-12


def test_the_last_step_is_given_where_none_does() -> None:
    found = converge(lambda count: pair(np.sqrt, count), LADDER[:3], 1e-12)
    assert not found.reached
    assert found.step == 3


def test_rounding_is_part_of_the_error() -> None:
    function, floor = FUNCTIONS["exponential"][0], 1e-6
    found = converge(lambda count: pair(function, count), LADDER, 1e-9, floor)
    assert not found.reached
    assert found.rounded
    assert found.step < LADDER[-1]
    assert found.error[0] >= floor
    found = converge(lambda count: pair(function, count), LADDER, 1e-5, floor)
    assert found.reached
    assert not found.rounded


@pytest.mark.parametrize("tolerance", [0, -1e-3, math.nan, math.inf, "1e-3", True])
def test_tolerances_that_are_none(tolerance: object) -> None:
    with pytest.raises(AccuracyError, match="tolerance must be a positive number"):
        converge(lambda count: pair(np.exp, count), LADDER, tolerance)  # type: ignore[arg-type]
