"""A room of mirrors: every path of light in it is a straight line from an image of the source.

A mirror shows the room again, and its mirrors show that room again: space is filled with rooms, n = (n_x, n_y, n_z)
mirrors from the real one, and in each is an image of the source. Along an axis on which the room has the side L and the
source the coordinate s, it lies at

    n L + s  where n is even,   n L + L - s  where n is odd.

The straight line from there to the receiver crosses |n_x| + |n_y| + |n_z| = k walls: folded back into the room it is a
path of k reflections, and its length is the distance. There are 4 k^2 + 2 rooms of the order k (one of order 0), and
(2k + 1)(2k^2 + 2k + 3) / 3 up to it.
Source: J. B. Allen, D. A. Berkley, J. Acoust. Soc. Am. 65, 943 (1979).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from lenstrace.errors import OptionError
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.lines.mirror_box import bounced
from lenstrace.phenomena.options import MOST_LENGTH, Option, demonstration, positive_length

AXES = "xyz"
MOST = 40  # reflections; some 90,000 paths
NEAR = 1e-13  # of the diagonal of the room: where a path arrives
EXACT = 0.0  # difference of two counts that agree


@result
class MirrorRoom(Demonstration):
    """The shortest path of so many reflections, and where it seems to come from.

    sides, source, receiver:  (3,), mm.
    shortest:  (k + 1,), length of the shortest path of each number of reflections, mm.
    path:      (k + 2, 3), the last of these: source, reflections, receiver.
    room:      (3,), the room it comes from.
    straight:  (k + 2, 3), the same points on the straight line: image, walls, receiver.
    """

    sides: np.ndarray
    source: np.ndarray
    receiver: np.ndarray
    shortest: np.ndarray
    path: np.ndarray
    room: np.ndarray
    straight: np.ndarray


def _place(of: str) -> Option:
    return Option(f"x, y, z of the {of}", "mm", least=0, most=MOST_LENGTH)


@demonstration
def mirror_room(
    bounces: Annotated[int, Option("reflections of the path", least=0, most=MOST, slider=(0, 12))] = 3,
    sides: Annotated[tuple[float, ...], positive_length("sides of the room along x, y, z")] = (1.0, 1.0, 1.0),
    source: Annotated[tuple[float, ...], Option("x, y, z of the source", "mm", least=0, most=MOST_LENGTH)] = (
        0.2,
        0.3,
        0.4,
    ),
    receiver: Annotated[tuple[float, ...], Option("x, y, z of the receiver", "mm", least=0, most=MOST_LENGTH)] = (
        0.7,
        0.6,
        0.1,
    ),
) -> MirrorRoom:
    """A room of mirrors: the shortest path of exactly so many reflections.

    OptionError for a point that is not in the room; on its walls it may be.
    """
    room = _three("sides", sides)
    lamp, eye = _within("source", source, room), _within("receiver", receiver, room)
    orders = rooms_by_order(bounces)
    found = [_paths(room, lamp, eye, each) for each in orders]
    diagonal = float(np.linalg.norm(room))
    near = NEAR * diagonal
    astray = [np.linalg.norm(paths[-1] - eye, axis=1) for paths, _ in found]
    arriving = [int(np.count_nonzero(each <= near)) for each in astray]
    measured = [np.linalg.norm(np.diff(paths, axis=0), axis=2).sum(0) for paths, _ in found]
    straight = [np.linalg.norm(away, axis=1) for _, away in found]
    unequal = max(float(abs(a - b).max()) for a, b in zip(measured, straight, strict=True))

    shortest = int(straight[-1].argmin())
    path, away = found[-1][0][:, shortest], found[-1][1][shortest]
    gone = np.append(0, np.linalg.norm(np.diff(path, axis=0), axis=1).cumsum())
    to_go = 1 - gone[:, None] / (gone[-1] or 1)
    k = bounces
    return MirrorRoom(
        setting=f"a room of {_text(room, ' x ')} mm with mirrors for walls, "
        f"light from ({_text(lamp)}) to ({_text(eye)}) mm",
        rows=(
            Comparison(f"paths of {_times(k)}", "", arriving[-1], 4 * k * k + 2 if k else 1, EXACT),
            Comparison(
                f"paths of at most {_times(k)}", "", sum(arriving), (2 * k + 1) * (2 * k * k + 2 * k + 3) // 3, EXACT
            ),
            *(
                Comparison(f"shortest path of {_times(order)}", "mm", traced.min(), line.min(), near * (order + 1))
                for order, (traced, line) in enumerate(zip(measured, straight, strict=True))
            ),
            Comparison(f"longest path of {_times(k)}", "mm", measured[-1].max(), straight[-1].max(), near * (k + 1)),
            Comparison("greatest difference of a path from its line", "mm", unequal, 0, near * (k + 1)),
            Comparison("greatest distance of an end from the receiver", "mm", max(map(np.max, astray)), 0, near),
        ),
        sides=room,
        source=lamp,
        receiver=eye,
        shortest=np.array([each.min() for each in measured]),
        path=path,
        room=orders[-1][shortest],
        straight=eye + to_go * away,
    )


def rooms_by_order(most: int) -> list[np.ndarray]:
    """The rooms of each order 0 ... most, (P, 3) whole numbers: how many mirrors away along each axis.

    >>> [len(rooms) for rooms in rooms_by_order(4)]
    [1, 6, 18, 38, 66]
    """
    numbers = np.arange(-most, most + 1)
    rooms = np.stack(np.meshgrid(numbers, numbers, numbers, indexing="ij"), -1).reshape(-1, 3)
    order = abs(rooms).sum(1)
    return [rooms[order == each] for each in range(most + 1)]


def _paths(
    sides: np.ndarray, source: np.ndarray, receiver: np.ndarray, rooms: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Paths from the images in some rooms of one order, (k + 2, P, 3), and how far off these are, (P, 3) with signs."""
    odd = rooms % 2 == 1
    # of an odd room from the distances to the wall between, which are exact where they are small
    to_wall = np.where(rooms > 0, (sides - source) + (sides - receiver), source + receiver)
    far = np.where(odd, (abs(rooms) - 1) * sides + to_wall, abs(rooms * sides + (source - receiver)))
    # along an axis on which there is no way to go the sign alone says whether a wall is met: the one that an image is
    # behind; none on the way from the source itself, which heads away from the nearer one
    same = np.where(source == receiver, source - sides / 2, source - receiver)
    side = np.where(rooms == 0, same, rooms)
    leaving = np.copysign(far, np.where(odd, side, -side))
    return bounced(sides, source, leaving, int(abs(rooms[0]).sum())), np.copysign(far, side)


def _three(name: str, values: Sequence[float]) -> np.ndarray:
    if len(values) != 3:
        raise OptionError(f"mirror-room: {name} must be three numbers, along x, y and z, got {len(values)}")
    return np.array(values, float)


def _within(name: str, values: Sequence[float], sides: np.ndarray) -> np.ndarray:
    point = _three(name, values)
    for axis, place, side in zip(AXES, point, sides, strict=True):
        if place > side:
            raise OptionError(
                f"mirror-room: {name} must be in the room, from 0 to {side:g} mm along {axis}, got {place:g} mm"
            )
    return point


def _times(bounces: int) -> str:
    return f"{bounces} reflection{'' if bounces == 1 else 's'}"


def _text(numbers: np.ndarray, between: str = ", ") -> str:
    return between.join(f"{number:g}" for number in numbers)
