"""View factors against integrals of their own, rays against the kernel, and how errors fall."""

import itertools
from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose

from lenstrace import phenomena
from lenstrace.phenomena.lines.averages import by_gauss, by_random, by_sobol, gauss_rule, random_points, sobol_points
from lenstrace.phenomena.lines.exchange import EXCHANGES, blocker, perpendicular
from lenstrace.phenomena.lines.howell import (
    closed_box,
    coaxial_disks,
    parallel_rectangles,
    perpendicular_rectangles,
)
from lenstrace.phenomena.lines.screened import screened_squares

CASES = tuple(EXCHANGES)


def integral_parallel(a: float, b: float, h: float) -> mp.mpf:
    """Over the differences u, v of the points' coordinates, which occur (a - u)(b - v) often on either side."""

    def counted(u: mp.mpf, v: mp.mpf) -> mp.mpf:
        return 4 * (a - u) * (b - v) * h**2 / (mp.pi * (u * u + v * v + h * h) ** 2)

    return mp.quad(counted, [0, min(a, h), a], [0, min(b, h), b]) / (a * b)


def integral_perpendicular(w: float, h: float, l: float) -> mp.mpf:
    """Over the difference v along the edge; int int x z / (x^2 + z^2 + v^2)^2 dx dz is a logarithm."""

    def counted(v: mp.mpf) -> mp.mpf:
        return (l - v) * mp.log((w * w + v * v) * (h * h + v * v) / (v * v * (w * w + h * h + v * v)))

    return mp.quad(counted, [0, min(w, h, l) / 2, l]) / (2 * mp.pi * w * l)


def integral_disks(r: float, other: float, h: float) -> mp.mpf:
    """Over both radii; around the axis int h^2 / (A - B cos t)^2 dt = 2 pi h^2 A / (A^2 - B^2)^(3/2)."""

    def counted(p: mp.mpf, s: mp.mpf) -> mp.mpf:
        a, b = h * h + p * p + s * s, 2 * p * s
        return 4 * p * s * h * h * a / mp.sqrt(a * a - b * b) ** 3

    return mp.quad(counted, [0, r / 2, r], [0, other / 2, other]) / r**2


def integral_screened(h: float, s: float) -> float:
    """Over the points of one square: what each sees of the other less what the screen hides, both rectangles."""

    def corner(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """From a point to a rectangle x by y above it with a corner over the point (Howell's B-3)."""
        p, q = np.hypot(h, x), np.hypot(h, y)
        return (x / p * np.arctan(y / p) + y / q * np.arctan(x / q)) / (2 * np.pi)

    def seen(x: tuple[np.ndarray, np.ndarray], y: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        return corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0])

    places, weights = np.polynomial.legendre.leggauss(50)
    ends = np.unique([s, 1 - s, *np.linspace(0, 1, 9)])
    half = np.diff(ends)[:, None] / 2
    at = (ends[:-1, None] + half * (1 + places)).ravel()
    weight = (half * weights).ravel()
    x, y = at[:, None], at[None, :]
    # the shadow, twice as large as the screen, is where it is seen from x: about 1 - x
    x_shadow, y_shadow = ((np.clip(1 - c - s, 0, 1) - c, np.clip(1 - c + s, 0, 1) - c) for c in (x, y))
    visible = seen((0 - x, 1 - x), (0 - y, 1 - y)) - seen(x_shadow, y_shadow)
    return float(weight @ visible @ weight)


def test_known_values() -> None:
    assert parallel_rectangles(1, 1, 1) == pytest.approx(0.199824895698387, abs=1e-15)
    assert perpendicular_rectangles(1, 1, 1) == pytest.approx(0.200043776075403, abs=1e-15)
    assert coaxial_disks(1, 1, 1) == pytest.approx(0.381966011250105, abs=1e-15)
    assert screened_squares(1, 0.5) == pytest.approx(0.099506294599, abs=1e-12)


@pytest.mark.parametrize("lengths", [(1.0, 1.0, 1.0), (2.0, 0.3, 0.7), (0.1, 0.5, 3.0), (4.0, 3.0, 0.5)])
@pytest.mark.parametrize(
    ("closed", "integral"),
    [
        (parallel_rectangles, integral_parallel),
        (perpendicular_rectangles, integral_perpendicular),
        (coaxial_disks, integral_disks),
    ],
)
def test_closed_forms_against_integrals(
    closed: Callable[..., float], integral: Callable[..., mp.mpf], lengths: tuple[float, float, float]
) -> None:
    assert_allclose(closed(*lengths), float(integral(*lengths)), rtol=1e-12)


@pytest.mark.parametrize("distance", [0.1, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("screen", [0.1, 0.5, 0.8])
def test_the_screened_squares_against_an_integral(distance: float, screen: float) -> None:
    assert_allclose(screened_squares(distance, screen), integral_screened(distance, screen), rtol=1e-12)
    assert_allclose(screened_squares(distance, 0), parallel_rectangles(1, 1, distance), rtol=1e-15)


def printed_parallel(a: float, b: float, c: float) -> mp.mpf:
    """C-11 as it is printed, in many digits."""
    x, y = mp.mpf(a) / mp.mpf(c), mp.mpf(b) / mp.mpf(c)
    p, q = mp.sqrt(1 + y * y), mp.sqrt(1 + x * x)
    total = mp.log(mp.sqrt((1 + x * x) * (1 + y * y) / (1 + x * x + y * y))) + x * p * mp.atan(x / p)
    return 2 / (mp.pi * x * y) * (total + y * q * mp.atan(y / q) - x * mp.atan(x) - y * mp.atan(y))


def printed_perpendicular(width: float, height: float, length: float) -> mp.mpf:
    """C-14 as it is printed."""
    w, h = mp.mpf(width) / mp.mpf(length), mp.mpf(height) / mp.mpf(length)
    w2, h2 = w * w, h * h
    r = mp.sqrt(h2 + w2)
    product = (1 + w2) * (1 + h2) / (1 + w2 + h2)
    product *= (w2 * (1 + w2 + h2) / ((1 + w2) * (w2 + h2))) ** w2
    product *= (h2 * (1 + h2 + w2) / ((1 + h2) * (h2 + w2))) ** h2
    total = w * mp.atan(1 / w) + h * mp.atan(1 / h) - r * mp.atan(1 / r) + mp.log(product) / 4
    return total / (mp.pi * w)


def printed_disks(radius: float, other: float, distance: float) -> mp.mpf:
    """C-41 as it is printed."""
    r, s = mp.mpf(radius) / mp.mpf(distance), mp.mpf(other) / mp.mpf(distance)
    x = 1 + (1 + s * s) / (r * r)
    return (x - mp.sqrt(x * x - 4 * (s / r) ** 2)) / 2


@pytest.mark.parametrize(
    ("closed", "printed"),
    [
        (parallel_rectangles, printed_parallel),
        (perpendicular_rectangles, printed_perpendicular),
        (coaxial_disks, printed_disks),
    ],
)
def test_nothing_cancels_at_the_extremes(closed: Callable[..., float], printed: Callable[..., mp.mpf]) -> None:
    for lengths in itertools.product((1e-6, 3e-3, 1.0, 700.0, 1e6), repeat=3):
        with mp.workdps(90):
            expected = float(printed(*lengths))
        assert_allclose(closed(*lengths), expected, rtol=2e-14, err_msg=str(lengths))


@pytest.mark.parametrize("sides", [(1.0, 1.0, 1.0), (1.0, 2.0, 0.3), (1e-3, 1.0, 1e3), (1e-6, 1e6, 1.0)])
def test_a_closed_box_keeps_all_its_light(sides: tuple[float, float, float]) -> None:
    factors = closed_box(sides)
    assert_allclose(factors.sum(1), 1, atol=1e-10)
    assert_allclose(np.diag(factors), 0)
    x, y, z = sides
    areas = np.repeat([y * z, z * x, x * y], 2)
    assert_allclose(areas[:, None] * factors, (areas[:, None] * factors).T, rtol=1e-13)


@pytest.mark.parametrize("case", CASES)
def test_rays_go_from_shape_to_shape_and_count_what_they_do(case: str) -> None:
    """The weight is cos a_1 cos a_2 / (pi r^2) times the area of shape 2 that a number stands for, by differences."""
    height, step = 0.8, 1e-5
    pair = EXCHANGES[case](height)
    numbers = np.random.default_rng(1).uniform(0.05, 0.95, (300, pair.dimensions))
    (x, y, z), end, weight = pair.rays(numbers)
    assert_allclose(z, 0)
    moved = []
    for axis in (-2, -1) if case != "disks" else (-1,):
        ends = []
        for sign in (1, -1):
            there = numbers.copy()
            there[:, axis] += sign * step
            ends.append(np.stack(pair.rays(there).end))
        moved.append((ends[0] - ends[1]) / (2 * step))
    way = np.stack(end) - np.stack([x, y, z])
    square = (way**2).sum(0)
    upright = case == "perpendicular"
    cosines = way[2] * (-way[0] if upright else way[2]) / square
    if case == "disks":
        # the radius by its own number; half the turns stand for all
        radius = np.hypot(end[0], end[1])
        area = 2 * np.linalg.norm(moved[0], axis=0) / (2 * radius)
        assert_allclose(area, np.pi, rtol=1e-8)
        assert_allclose(radius**2, numbers[:, 1])
        assert_allclose(x**2, numbers[:, 0])
    else:
        area = np.linalg.norm(np.cross(*moved, axis=0), axis=0)
        assert_allclose(np.stack([x, y], 1), numbers[:, :2])
    if upright:
        assert_allclose(end[0], 0, atol=1e-15)
        assert (end[1] > 0).all()
        assert (end[1] < 1).all()
        assert (end[2] < height).all()
    else:
        assert_allclose(end[2], height)
    assert_allclose(weight, cosines * area / (np.pi * square), rtol=1e-6)


def test_rays_that_meet_the_screen_are_stopped() -> None:
    pair = blocker(2.0)
    numbers = np.array(
        [
            [0.5, 0.5, 0.5, 0.5],  # through the middle
            [0.0, 0.5, 1.0, 0.5],  # the same, aslant
            [0.2, 0.5, 0.2, 0.5],  # beside it
            [0.0, 0.0, 0.6, 0.6],  # just inside of its corner at 1/4
            [0.0, 0.0, 0.4, 0.6],
            [0.25, 0.5, 0.25, 0.5],  # on its edge, which is part of it
        ]
    )
    np.testing.assert_array_equal(pair.arrive(pair.rays(numbers)), [False, False, True, False, True, False])
    assert (pair.contributions(numbers) > 0).tolist() == [False, False, True, False, True, False]


def test_the_share_of_stopped_rays() -> None:
    """Halfway points of two even ones are triangular: within 1/4 of the middle with probability 3/4."""
    pair = blocker(1.0)
    stopped = ~pair.arrive(pair.rays(sobol_points(4, 2**14, (3,))))
    assert stopped.mean() == pytest.approx((3 / 4) ** 2, abs=2e-3)


def test_gauss_is_exact_for_polynomials() -> None:
    points, weights = gauss_rule(3, 4)
    assert weights.sum() == pytest.approx(1, abs=1e-14)
    assert weights @ (points[:, 0] ** 7 * points[:, 1] ** 5 * points[:, 2] ** 2) == pytest.approx(1 / 8 / 6 / 3)


@pytest.mark.parametrize("points", [random_points, sobol_points])
def test_more_points_begin_with_the_same(points: Callable[..., np.ndarray]) -> None:
    np.testing.assert_array_equal(points(3, 64, (1, 2)), points(3, 256, (1, 2))[:64])
    assert (points(3, 64, (1, 2)) != points(3, 64, (1, 3))).all()


@pytest.mark.parametrize("case", CASES)
def test_estimates_of_chance_are_honest(case: str) -> None:
    """Errors over their estimates spread by about 1: of 60, by 0.7 to 1.4 but once in ten thousand."""
    pair = EXCHANGES[case](1.0)
    for kind in (by_random, by_sobol):
        found = [kind(pair.contributions, pair.dimensions, 2**11, (seed,)) for seed in range(60)]
        ratios = np.array([(each.value - pair.factor) / each.error for each in found])
        assert 0.7 < np.sqrt((ratios**2).mean()) < 1.4


@pytest.mark.parametrize("case", CASES)
def test_estimates_of_the_rule_are_honest(case: str) -> None:
    for height in (0.25, 1.0, 4.0):
        pair = EXCHANGES[case](height)
        for nodes in range(5, 13):
            found = by_gauss(pair.contributions, pair.dimensions, nodes)
            assert abs(found.value - pair.factor) <= 2 * found.error, (height, nodes)
            assert found.points == nodes**pair.dimensions


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(
    "options", [{}, {"height": 0.25, "seed": 1}, {"height": 4.0, "seed": 2, "samples": 5000}, {"samples": 1024}]
)
def test_agrees_with_other_options(case: str, options: dict[str, Any]) -> None:
    found = phenomena.view_factor(case, **options)
    assert found.agrees, found


def test_sobol_is_steeper_and_a_shadow_spoils_the_rule() -> None:
    smooth, shadowed = phenomena.view_factor("parallel"), phenomena.view_factor("blocker")
    assert smooth.sobol_law.slope < -1.0 < shadowed.sobol_law.slope < -0.55
    assert smooth.gauss_errors[-1] < 1e-13
    assert shadowed.gauss_errors[-1] > shadowed.sobol_law.errors[-1]


def test_the_cheapest_is_accurate_enough_or_not_named() -> None:
    found = phenomena.view_factor(tolerance=1e-6, samples=4096)
    assert found.trade.chosen is not None
    assert found.trade.chosen.setting.family == "gaussian"
    assert found.trade.chosen.relative_error <= 1e-6
    none = phenomena.view_factor("blocker", tolerance=1e-9, samples=1024)
    assert none.trade.chosen is None
    assert not [row for row in none.rows if "cheapest" in row.quantity]


def test_the_picture_turns_the_rays_between_disks() -> None:
    pair = EXCHANGES["disks"](1.0)
    numbers = random_points(3, 50, (0,))
    starts, ends, _ = pair.shown(numbers)
    assert_allclose(np.linalg.norm(starts[:, :2], axis=1), np.sqrt(numbers[:, 0]))
    # each turned as a whole
    start, end, _ = pair.rays(numbers)
    assert_allclose(np.linalg.norm(ends - starts, axis=1), np.linalg.norm(np.stack(end) - np.stack(start), axis=0))
    assert (starts[:, 0] < 0).any()


def test_rays_to_the_upright_square_stay_bounded_at_the_edge() -> None:
    pair = perpendicular(1.0)
    numbers = np.array([[0.0, 0.0, 1.0, 1.0], [0.0, 0.5, 0.0, 0.5], [1e-300, 1.0, 1.0, 0.0]])
    assert np.isfinite(pair.contributions(numbers)).all()
    assert pair.contributions(random_points(4, 10_000, (1,))).max() < np.pi / 2
