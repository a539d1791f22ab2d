"""Points in polygons against shapely, exact fractions and the published examples of what rounding does."""

from fractions import Fraction

import numpy as np
import pytest
import shapely

from lenstrace import OptionError, phenomena
from lenstrace.phenomena.lines.orientation import orientation
from lenstrace.phenomena.lines.polygon import Place, inside, winding_number

SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2)]


def exact_side(a: tuple[float, float], b: tuple[float, float], p: tuple[float, float]) -> int:
    """The sign of the determinant in fractions."""
    (a_x, a_y), (b_x, b_y), (x, y) = (map(Fraction, point) for point in (a, b, p))
    value = (a_x - x) * (b_y - y) - (a_y - y) * (b_x - x)
    return (value > 0) - (value < 0)


@pytest.mark.parametrize(
    ("near", "line"),
    [
        ((0.5, 0.5), ((12.0, 12.0), (24.0, 24.0))),
        ((0.50000000000002531, 0.5000000000000171), ((17.300000000000001,) * 2, (24.00000000000005,) * 2)),
        ((0.5, 0.5), ((8.8000000000000007, 8.8000000000000007), (12.1, 12.1))),
    ],
)
def test_sides_near_the_lines_of_kettner_and_others(near: tuple[float, float], line: tuple) -> None:
    """The three examples of Fig. 2 there: a plain float64 determinant fails at many of the points."""
    j, i = np.indices((48, 48)) * 5
    x, y = near[0] + i * 2.0**-53, near[1] + j * 2.0**-53
    a, b = (tuple(np.full(x.shape, c) for c in corner) for corner in line)
    right = [exact_side(*line, p) for p in zip(x.ravel().tolist(), y.ravel().tolist(), strict=True)]
    np.testing.assert_array_equal(orientation(a, b, (x, y)).ravel(), right)
    plain = np.sign((a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x))
    assert (plain.ravel() != right).sum() > 50


def test_sides_of_numbers_that_overflow_and_underflow() -> None:
    huge, tiny = 1.7e308, 5e-324
    for a, b, p in [
        ((-huge, -huge), (huge, huge), (0.5, 0.25)),
        ((0.0, 0.0), (tiny, 3 * tiny), (2 * tiny, 6 * tiny)),
        ((0.0, 0.0), (tiny, 3 * tiny), (2 * tiny, 5 * tiny)),
        ((0.0, 0.0), (1e-200, 1e-200), (1e-200, 2e-200)),
    ]:
        found = orientation(*((np.array([x]), np.array([y])) for x, y in (a, b, p)))
        assert found.tolist() == [exact_side(a, b, p)]


def test_a_million_points_as_shapely_has_them() -> None:
    rng = np.random.default_rng(1)
    angle, radius = np.sort(rng.uniform(0, 2 * np.pi, 20)), rng.uniform(0.3, 1, 20)
    polygon = np.stack([radius * np.cos(angle), radius * np.sin(angle)], -1)
    x, y = rng.uniform(-1, 1, (2, 1_000_000))
    np.testing.assert_array_equal(
        inside(polygon, x, y) == Place.INSIDE, shapely.contains_xy(shapely.Polygon(polygon), x, y)
    )


def test_boundaries_as_shapely_has_them() -> None:
    """Whole numbers: many points are on edges and corners, and level with them."""
    polygon = [(0, 0), (8, 0), (8, 4), (6, 4), (6, 2), (4, 4), (2, 2), (2, 6), (8, 6), (8, 8), (0, 8)]
    y, x = np.indices((11, 11)) - 1
    shape = shapely.Polygon(polygon)
    found = inside(polygon, x, y)
    np.testing.assert_array_equal(found == Place.INSIDE, shapely.contains_xy(shape, x, y))
    np.testing.assert_array_equal(found != Place.OUTSIDE, shapely.intersects_xy(shape, x, y))
    np.testing.assert_array_equal(inside(polygon[::-1], x, y), found)


def test_a_pentagram_by_both_rules() -> None:
    turns = 0.8 * np.pi * np.arange(5)
    star = np.stack([np.cos(turns), np.sin(turns)], -1)
    assert winding_number(star, 0, 0).number == 2
    assert winding_number(star[::-1], 0, 0).number == -2
    assert inside(star, 0, 0) == Place.OUTSIDE
    assert inside(star, 0, 0, "winding") == Place.INSIDE
    assert inside(star, 0.8, 0) == inside(star, 0.8, 0, "winding") == Place.INSIDE


def test_shapes_and_repeated_corners() -> None:
    assert inside(SQUARE, 1, [[1, 3], [0, 2]]).tolist() == [[1, -1], [0, 0]]
    np.testing.assert_array_equal(inside([*SQUARE, SQUARE[0], SQUARE[0]], [0, 1, 2, 3], 1), [0, 1, 0, -1])
    np.testing.assert_array_equal(inside([(0, 0), (1, 1), (2, 2)], [1, 1], [1, 0]), [0, -1])
    assert inside(SQUARE, [], []).shape == (0,)


@pytest.mark.parametrize(
    ("polygon", "x", "rule", "words"),
    [
        ([(0, 0), (1, 1)], 0.0, "even-odd", "needs 3 corners or more"),
        ([0, 1, 2], 0.0, "even-odd", "each x and y"),
        ([(0, 0), (1, 1), (np.nan, 0)], 0.0, "even-odd", "corners of a polygon must be finite"),
        ([(0, 0), (1, 1), ("a", 0)], 0.0, "even-odd", "corners of a polygon must be numbers"),
        (SQUARE, np.inf, "even-odd", "points must be finite"),
        (SQUARE, 0.0, "odd", "rule must be one of even-odd, winding"),
    ],
)
def test_what_is_no_polygon_is_refused(polygon: list, x: float, rule: str, words: str) -> None:
    with pytest.raises(OptionError, match=words):
        inside(polygon, x, 0.0, rule)


@pytest.mark.parametrize(
    "options", [{"corners": 3, "step": 1, "points": 1}, {"corners": 15, "step": 7}, {"corners": 6}]
)
def test_other_stars(options: dict[str, int]) -> None:
    found = phenomena.point_in_polygon(**{"grid": 2, "points": 500, **options})
    assert found.agrees, found


def test_rounding_makes_the_line_ragged() -> None:
    assert phenomena.point_in_polygon(points=1).wrong > 10_000


def test_a_star_that_is_none_is_refused() -> None:
    with pytest.raises(OptionError, match="a star of 4 corners needs a step below 2, got 2"):
        phenomena.point_in_polygon(corners=4, step=2)
