"""How much of the light of one shape falls on another: rays at random, evenly spread, and by a rule; what each costs.

The view factor from 1 to 2 is the part of the light that leaves shape 1, as much to all sides as a matt surface sends,
that falls on shape 2:

    F = 1 / A_1  int int  V cos a_1 cos a_2 / (pi r^2)  dA_2 dA_1,

r the distance of two points, a the angles of the line between them with the normals, V = 0 where it is blocked and else
1. It is the mean of what N rays count. The error of random rays falls as N^(-1/2), whatever is counted; that of
scrambled Sobol points as N^(-3/2) (ln N)^((D - 1)/2) where it is smooth in the D numbers that a ray takes, less steeply
where it has edges or corners, but more steeply than of random ones. Gauss's rule is best of all where the integrand is
smooth, and worst where a shadow crosses it. In a closed room the factors from each wall add up to 1, and A_1 F_12 =
A_2 F_21.
Sources: J. R. Howell, see `howell`; A. B. Owen, Ann. Statist. 25, 1541 (1997).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Annotated, NamedTuple

import numpy as np

from lenstrace.accuracy.trade import Setting, Trade, trade
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.lines.averages import (
    ROUNDING,
    Average,
    Points,
    averages_of_sets,
    by_gauss,
    by_random,
    by_sobol,
    gauss_value,
    random_points,
    slope,
    sobol_points,
)
from lenstrace.phenomena.lines.exchange import EXCHANGES, Exchange
from lenstrace.phenomena.lines.howell import closed_box
from lenstrace.phenomena.options import Option, demonstration

DOUBLINGS = 7  # of the number of rays, over which the slopes are measured
SETS = 32  # of rays of each number, whose errors make one of those of the picture
ROUNDS = 5  # of timed calls
OWN = 1000  # the place of the seed of the averages among those of the sets
SHOWN = 32  # rays of the picture
# Differences that agree, in estimates of the error: of chance one in a million is greater. Two rules may err alike.
CHANCE, CHANCE_OF_SPREAD, RULE = 5.0, 8.0, 2.0
# Of slopes: their scatter; the distance of few points from the law of many; the range of what edges and corners leave.
SCATTER, FEW, EDGES = 0.2, 0.7, 0.5
CLOSED = 1e-10  # of a sum of view factors, from 1


class Law(NamedTuple):
    """Root mean square errors against numbers of rays: both (M,), and the slope of their logarithms."""

    counts: np.ndarray
    errors: np.ndarray
    slope: float


@result
class ViewFactor(Demonstration):
    """Two shapes, their view factor by three kinds of rays, and what accuracy costs with each.

    outlines:        (M, 3) each, of the shapes and of what is between them.
    starts, ends:    (R, 3), some rays.        arrives: (R,), which of them are not blocked.
    factor:          in closed form.
    random, sobol, gauss:  the view factor by each, with an estimate of its error.
    random_law, sobol_law: how the error falls.
    gauss_counts, gauss_errors:  (G,), rays and errors of Gauss's rule.
    trade:           error and time of them all; of random kinds the set of median error among 32, a typical one.
    """

    outlines: tuple[np.ndarray, ...]
    starts: np.ndarray
    ends: np.ndarray
    arrives: np.ndarray
    factor: float
    random: Average
    sobol: Average
    gauss: Average
    random_law: Law
    sobol_law: Law
    gauss_counts: np.ndarray
    gauss_errors: np.ndarray
    trade: Trade


@demonstration
def view_factor(
    case: Annotated[str, Option("the shapes", choices=tuple(EXCHANGES))] = "parallel",
    height: Annotated[
        float, Option("their distance, or how high the upright one is; squares have the side 1", least=0.25, most=4)
    ] = 1.0,
    samples: Annotated[
        int, Option("rays, rounded down to a power of two", least=2**10, most=2**18, slider=(2**10, 2**16))
    ] = 2**15,
    tolerance: Annotated[
        float, Option("relative error allowed where the cheapest is asked for", above=0, most=1, slider=(1e-4, 1e-2))
    ] = 1e-3,
    seed: Annotated[int, Option("of what is random", least=0, most=10**6, slider=(0, 100))] = 0,
) -> ViewFactor:
    """The view factor of two shapes by three kinds of rays, and what they cost."""
    pair = EXCHANGES[case](height)
    f, truth, dimensions = pair.contributions, pair.factor, pair.dimensions
    power = int(math.log2(samples))
    sizes = 2 ** np.arange(power - DOUBLINGS, power + 1)
    most = int(sizes[-1])
    nodes = int(most ** (1 / dimensions))
    averages = (
        by_random(f, dimensions, most, (seed, OWN)),
        by_sobol(f, dimensions, most, (seed, OWN)),
        by_gauss(f, dimensions, nodes),
    )
    kinds: dict[str, Points] = {"random": random_points, "sobol": sobol_points}
    errors = {
        name: averages_of_sets(f, points, dimensions, sizes, SETS, seed) - truth for name, points in kinds.items()
    }
    laws = {name: _law(sizes, each) for name, each in errors.items()}
    settings = [*_random_settings(pair, kinds, sizes, errors, seed), *_gauss_settings(pair, nodes)]
    found = trade(lambda how: how(), settings, truth, tolerance=tolerance, floor=ROUNDING * truth, rounds=ROUNDS)
    by_rule = [each for each in found.outcomes if each.setting.family == "gaussian"]
    starts, ends, arrives = pair.shown(sobol_points(dimensions, SHOWN, (seed, OWN)))
    return ViewFactor(
        setting=f"{pair.text}; rays from one to the other",
        rows=(
            *_value_rows(averages, truth),
            *_slope_rows(laws, pair),
            *_cheapest_row(found),
            *_box_rows(case, height),
        ),
        outlines=pair.outlines,
        starts=starts,
        ends=ends,
        arrives=arrives,
        factor=truth,
        random=averages[0],
        sobol=averages[1],
        gauss=averages[2],
        random_law=laws["random"],
        sobol_law=laws["sobol"],
        gauss_counts=np.array([each.setting.rays for each in by_rule]),
        gauss_errors=np.array([each.error for each in by_rule]),
        trade=found,
    )


def _law(sizes: np.ndarray, errors: np.ndarray) -> Law:
    """errors: (SETS, M)."""
    rms = np.sqrt((errors**2).mean(0))
    return Law(sizes, rms, slope(sizes, rms))


def _random_settings(
    pair: Exchange, kinds: dict[str, Points], sizes: np.ndarray, errors: dict[str, np.ndarray], seed: int
) -> Iterator[Setting]:
    """Each number of rays in the set of median error: what luck there is in one set is not credited to its kind."""
    for name, points in kinds.items():
        typical = abs(errors[name]).argsort(0)[SETS // 2]
        for count, place in zip(sizes.tolist(), typical.tolist(), strict=True):
            yield Setting(f"{name}, {count} rays", name, count, _mean(pair, points, count, (seed, place)))


def _mean(pair: Exchange, points: Points, count: int, seed: tuple[int, ...]) -> Callable[[], float]:
    return lambda: float(pair.contributions(points(pair.dimensions, count, seed)).mean())


def _gauss_settings(pair: Exchange, most: int) -> Iterator[Setting]:
    for nodes in range(1, most + 1):
        count = nodes**pair.dimensions
        yield Setting(f"gaussian, {count} rays", "gaussian", count, _by_rule(pair, nodes))


def _by_rule(pair: Exchange, nodes: int) -> Callable[[], float]:
    return lambda: gauss_value(pair.contributions, pair.dimensions, nodes)


def _value_rows(averages: tuple[Average, ...], truth: float) -> Iterator[Comparison]:
    for name, each, within in zip(
        ("random rays", "rays at Sobol points", "rays by Gauss's rule"),
        averages,
        (CHANCE, CHANCE_OF_SPREAD, RULE),
        strict=True,
    ):
        yield Comparison(f"{each.points} {name} (+- {each.error:.1e})", "", each.value, truth, within * each.error)


def _slope_rows(laws: dict[str, Law], pair: Exchange) -> Iterator[Comparison]:
    yield Comparison("slope of the error, random", "", laws["random"].slope, -0.5, SCATTER)
    law = laws["sobol"]
    if pair.smooth:
        middle = float(np.log(law.counts).mean())
        expected = -1.5 + (pair.dimensions - 1) / (2 * middle)
        yield Comparison("slope of the error, Sobol: smooth", "", law.slope, expected, FEW)
    else:
        yield Comparison("slope of the error, Sobol: from -1/2 to -3/2", "", law.slope, -1.0, EDGES)


def _cheapest_row(found: Trade) -> Iterator[Comparison]:
    """None where no setting is accurate enough."""
    if found.chosen is not None and found.tolerance is not None:
        name = f"relative error of the cheapest: {found.chosen.setting.name}"
        yield Comparison(name, "", found.chosen.relative_error, 0, max(found.tolerance, ROUNDING))


def _box_rows(case: str, height: float) -> Iterator[Comparison]:
    """Of the box that the shapes are two walls of."""
    if case not in ("parallel", "perpendicular"):
        return
    factors = closed_box((1.0, 1.0, height))
    wall, floor = 0, 4
    for name, number in (("floor", floor), ("wall", wall)):
        yield Comparison(f"sum of the factors from the {name} of a box", "", factors[number].sum(), 1, CLOSED)
    there, back = factors[floor, wall], height * factors[wall, floor]
    yield Comparison("area x factor, wall to floor and floor to wall", "", back, there, CLOSED)
