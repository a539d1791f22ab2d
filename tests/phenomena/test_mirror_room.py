"""The room of mirrors against images in exact fractions, the law of reflection, and degenerate rooms."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from lenstrace import OptionError, phenomena
from lenstrace.phenomena.demonstration import Demonstration
from lenstrace.phenomena.lines.mirror_box import bounced
from lenstrace.phenomena.lines.mirror_room import rooms_by_order

Point = tuple[Fraction, ...]
CORNERS = {"source": (0.0, 0.0, 0.0), "receiver": (1.0, 1.0, 1.0)}


def measured(found: Demonstration, quantity: str) -> float:
    return next(row.measured for row in found.rows if row.quantity == quantity)


def images(source: Point, sides: Point, most: int) -> list[list[Point]]:
    """Of each order, by mirroring in the walls: those of one order are the new ones that six mirrors make of the last.

    A room is told by where it shows an odd point, for images in two rooms may coincide. Both are mirrored.
    """
    odd = tuple(side * Fraction(1, 7 + axis) for axis, side in enumerate(sides))
    orders: list[dict[Point, Point]] = [{odd: source}]
    seen = {odd}
    for _ in range(most):
        new: dict[Point, Point] = {}
        for mark, point in orders[-1].items():
            # the walls of the rooms, not of the real one alone: the mirrors that are seen in mirrors
            for axis, side in enumerate(sides):
                low = mark[axis] // side * side
                for wall in (low, low + side):
                    moved = tuple(2 * wall - each if place == axis else each for place, each in enumerate(mark))
                    if moved not in seen:
                        seen.add(moved)
                        new[moved] = tuple(
                            2 * wall - each if place == axis else each for place, each in enumerate(point)
                        )
        orders.append(new)
    return [list(each.values()) for each in orders]


def squares(source: Point, receiver: Point, sides: Point, most: int) -> list[list[Fraction]]:
    return [
        [sum(((a - b) ** 2 for a, b in zip(image, receiver, strict=True)), Fraction(0)) for image in order]
        for order in images(source, sides, most)
    ]


def test_shortest_and_longest_in_the_unit_cube() -> None:
    found = phenomena.mirror_room(bounces=4)
    np.testing.assert_allclose(found.shortest**2, [0.43, 0.59, 1.15, 1.87, 3.31], rtol=1e-15)
    longest = measured(phenomena.mirror_room(bounces=3), "longest path of 3 reflections")
    assert longest == pytest.approx(3.5482389998420345, rel=1e-15)


@pytest.mark.parametrize(
    ("sides", "source", "receiver"),
    [
        (("1", "1", "1"), ("1/5", "3/10", "2/5"), ("7/10", "3/5", "1/10")),
        (("3", "1/2", "5/4"), ("1/3", "1/7", "1"), ("14/5", "1/4", "1/8")),
        (("1", "2", "1"), ("0", "2", "1/2"), ("1", "0", "1/2")),
        (("1", "1", "1"), ("0", "0", "0"), ("0", "0", "0")),
    ],
)
def test_every_order_as_mirroring_in_fractions_has_it(
    sides: tuple[str, ...], source: tuple[str, ...], receiver: tuple[str, ...]
) -> None:
    exact = [tuple(map(Fraction, each)) for each in (source, receiver, sides)]
    orders = squares(*exact, 5)
    floats = [tuple(map(float, each)) for each in exact]
    for bounces, order in enumerate(orders):
        found = phenomena.mirror_room(bounces, floats[2], floats[0], floats[1])
        assert found.agrees, found
        assert len(order) == found.rows[0].measured
        assert found.shortest[-1] == pytest.approx(float(min(order)) ** 0.5, rel=1e-14, abs=1e-14)
        times = f"{bounces} reflection{'' if bounces == 1 else 's'}"
        assert measured(found, f"longest path of {times}") == pytest.approx(float(max(order)) ** 0.5, rel=1e-14)


def test_every_path_obeys_the_law_of_reflection() -> None:
    sides, source = np.array([1.0, 0.7, 1.9]), np.array([0.2, 0.3, 0.4])
    leaving = np.random.default_rng(2).normal(size=(500, 3)) * 5
    points = bounced(sides, source, leaving, 12)
    assert ((points[:-1] >= 0) & (points[:-1] <= sides)).all()
    on_walls = (points[1:-1] == 0) | (points[1:-1] == sides)
    assert (on_walls.sum(-1) == 1).all()
    ways = np.diff(points[:-1], axis=0)
    ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    turned = np.where(on_walls[:-1], -ways[:-1], ways[:-1])
    # of a way that is short its direction is known less well
    np.testing.assert_allclose(ways[1:], turned, atol=1e-9)


def test_the_same_straight_line_in_the_rooms_of_the_mirrors() -> None:
    found = phenomena.mirror_room(bounces=9, sides=(2.0, 1.0, 3.0))
    along = found.receiver - found.straight[0]
    assert np.linalg.norm(np.cross(found.straight - found.receiver, along)) < 1e-13
    # folded back, a coordinate goes to and fro with the period of two rooms
    folded = found.sides - abs(found.straight % (2 * found.sides) - found.sides)
    np.testing.assert_allclose(folded, found.path, atol=1e-13)


def test_a_path_through_corners_meets_three_walls_at_once() -> None:
    """Along the diagonal of a cube: its corners are the only places where it turns."""
    points = bounced(np.ones(3), np.zeros(3), np.full((1, 3), 3.0), 6)[:, 0]
    np.testing.assert_array_equal(points[:, 0], [0, 1, 1, 1, 0, 0, 0, 1])
    np.testing.assert_array_equal(points, points[:, :1] * np.ones(3))
    found = phenomena.mirror_room(bounces=6, **CORNERS)
    assert found.agrees, found
    edge = bounced(np.ones(3), np.array([0.5, 0.5, 0.25]), np.array([[1.0, 1.0, 0.0]]), 2)[:, 0]
    np.testing.assert_array_equal(edge, [[0.5, 0.5, 0.25], [1, 1, 0.25], [1, 1, 0.25], [0.5, 0.5, 0.25]])


@pytest.mark.parametrize(
    "options",
    [
        {"bounces": 30},
        {"bounces": 40, "source": (1 / 3, 0.1, 0.7), "receiver": (1.0, 1.0, 0.0)},
        {"bounces": 30, "sides": (1e-3, 1.0, 1e6), "source": (1e-3, 0.3, 5.0), "receiver": (0.0, 0.3, 7e5)},
        {"bounces": 0, "source": (0.5, 0.5, 0.5), "receiver": (0.5, 0.5, 0.5)},
        {"bounces": 8, "source": (0.5, 0.5, 0.5), "receiver": (0.5, 0.5, 0.5)},
        {"bounces": 7, "source": (1.0, 0.0, 0.5), "receiver": (1.0, 0.0, 0.5)},
        {"bounces": 7, **CORNERS},
        {"bounces": 5, "source": (5e-324, 1.0, 0.5), "receiver": (0.0, 1 - 2**-53, 0.5)},
    ],
)
def test_agrees_at_the_extremes(options: dict[str, Any]) -> None:
    found = phenomena.mirror_room(**options)
    assert found.agrees, found
    assert np.isfinite(found.straight).all()


def test_points_on_walls_corners_and_each_other() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        sides = rng.choice([1.0, 2.0, rng.uniform(0.05, 20)], 3)
        ends = sides * rng.choice([0.0, 0.25, 0.5, 1.0, rng.random()], (2, 3))
        source, receiver = ends if rng.random() < 0.7 else ends[:1].repeat(2, 0)
        found = phenomena.mirror_room(int(rng.integers(0, 8)), tuple(sides), tuple(source), tuple(receiver))
        assert found.agrees, found


def test_numbers_of_rooms() -> None:
    counts = [len(rooms) for rooms in rooms_by_order(30)]
    assert counts == [1, *(4 * k * k + 2 for k in range(1, 31))]
    assert sum(counts) == 61 * (2 * 900 + 60 + 3) // 3


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"source": (0.5, 1.2, 0.5)}, "source must be in the room, from 0 to 1 mm along y, got 1.2 mm"),
        ({"sides": (1.0, 1.0, 0.05)}, "source must be in the room, from 0 to 0.05 mm along z, got 0.4 mm"),
        ({"receiver": (2.0, 0.5, 0.5)}, "receiver must be in the room, from 0 to 1 mm along x"),
        ({"receiver": (0.5, 0.5)}, "receiver must be three numbers, along x, y and z, got 2"),
        ({"sides": (1.0, 1.0, 1.0, 1.0)}, "sides must be three numbers, along x, y and z, got 4"),
        ({"source": (0.5, -0.1, 0.5)}, "source must be at least 0 mm"),
    ],
)
def test_what_is_no_room_is_refused(options: dict[str, Any], words: str) -> None:
    with pytest.raises(OptionError, match=f"^mirror-room: {words}"):
        phenomena.mirror_room(**options)
