"""How the surfaces of a lens look in a section: how wide they are drawn, their profiles, the outlines of the glass."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.rays import Ray, RayStatus
from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.rows import Row
from lenstrace.sequential.vertices import vertices

# A surface is drawn wider than its rays by this share; two surfaces of an element that differ by less than
# `ALIKE` are drawn equally high.
MARGIN, ALIKE = 0.05, 0.2
HALF_POINTS = 41
HOLED = (ApertureKind.ANNULUS, ApertureKind.OBSCURATION)


class Placed(NamedTuple):
    """A surface where it stands, cut by the plane x = const.: meridian is the cut's direction in its x and y."""

    shape: Asphere
    rotation: np.ndarray
    origin: np.ndarray
    meridian: np.ndarray
    rim: float

    def sag(self, height: np.ndarray) -> np.ndarray:
        """Height above the vertex plane, mm, at signed distances from the axis; nan beyond the rim."""
        return np.asarray(_sag(self.shape, np.asarray(height)))

    def points(self, height: np.ndarray, z: np.ndarray | None = None) -> np.ndarray:
        """(N, 2) of points at signed heights on the surface, or at z of its frame."""
        x, y = self.meridian[:, None] * height
        local = np.stack([x, y, self.sag(height) if z is None else z])
        return (self.rotation @ local + self.origin[:, None])[:0:-1].T


@jax.jit
def _sag(shape: Asphere, height: jax.Array) -> jax.Array:
    return shape.sag(height, jnp.zeros_like(height))


def drawn_rows(lens: Lens) -> tuple[Row, ...]:
    """Rows 1 ... S and the image."""
    return (*lens.rows, lens.image)


def placed_surfaces(lens: Lens) -> list[Placed]:
    """Surfaces 1 ... S + 1."""
    system = lens.system
    rotations, origins = (np.asarray(a) for a in vertices(system))
    found = []
    for i, kind in enumerate(system.kinds):
        curvature, conic = float(system.curvature[i]), float(system.conic[i])
        across = np.array([-rotations[i, 0, 1], rotations[i, 0, 0]])
        length = np.hypot(*across)
        square = (1 + conic) * curvature**2
        found.append(
            Placed(
                Asphere(
                    system.curvature[i], system.conic[i], system.coefficients[i], system.norm_radius[i], kind.powers
                ),
                rotations[i],
                origins[i],
                across / length if length > 1e-9 else np.array([0.0, 1.0]),
                (1 - 8 * np.finfo(rotations.dtype).eps) / np.sqrt(square) if square > 0 else np.inf,
            )
        )
    return found


def ray_heights(path: Ray) -> np.ndarray:
    """(S + 1,), the largest distance from the vertex at which a ray meets each surface; nan where none does."""
    status, failed = path.status[-1], path.surface[-1]
    number = np.arange(1, path.x.shape[0])[:, None, None]
    met = (status == RayStatus.OK) | (failed > number) | ((failed == number) & (status == RayStatus.TIR))
    heights = np.where(met, np.hypot(path.x[1:], path.y[1:]), -1.0).max((1, 2))
    return np.where(heights < 0, np.nan, heights)


def semi_diameters(lens: Lens, placed: list[Placed], heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two of (S + 1,), mm: what is clear, as written or as the rays need; and what is drawn, which is alike for
    the surfaces of an element."""
    rims = np.array([surface.rim for surface in placed])
    known = heights[np.isfinite(heights)]
    heights = np.where(np.isfinite(heights), heights, known.max() if known.size else 1.0)
    written = [_written(row, surface.meridian) for row, surface in zip(drawn_rows(lens), placed, strict=True)]
    free = np.array([size is None for size in written])
    clear = np.minimum([heights[i] if size is None else size for i, size in enumerate(written)], rims)
    thin = [row.stop and not bends for row, bends in zip(lens.rows, lens.system.bends, strict=True)]
    sizes = np.minimum(np.where(free & ~np.array([*thin, False]), (1 + MARGIN) * clear, clear), rims)
    pairs = [(a, b) for a, b in filled_gaps(lens) if _coaxial(placed[a], placed[b])]
    for a, b in (*pairs, *reversed(pairs)):
        pair = [a, b]
        apart = float((placed[b].origin - placed[a].origin) @ placed[a].rotation[:, 2])
        if free[pair].all() and _is_ball(lens, a, b, apart):
            sizes[pair] = rims[a]
            continue
        if _crosses(placed[a], placed[b], apart, sizes[pair].min()):
            sizes[pair] = np.where(free[pair], clear[pair], sizes[pair])
        size = sizes[pair].max()
        if not _crosses(placed[a], placed[b], apart, size):
            sizes[pair] = np.where(free[pair] & (size <= (1 + ALIKE) * sizes[pair]), size, sizes[pair])
    return clear, sizes


def _crosses(first: Placed, second: Placed, apart: float, size: float) -> bool:
    """True where one of two coaxial surfaces ends, or goes through the other, below that height."""
    height = _half_heights(0.0, size)
    return not np.all((second.sag(height) + apart - first.sag(height)) * np.sign(apart) >= 0)


def _written(row: Row, meridian: np.ndarray) -> float | None:
    """The semi-diameter that a row says, mm."""
    if row.semi_diameter is not None:
        return row.semi_diameter
    numbers = [float(number) for number in row.aperture]
    match row.aperture_kind:
        case ApertureKind.CIRCLE:
            return numbers[0]
        case ApertureKind.ANNULUS:
            return numbers[1]
        case ApertureKind.RECTANGLE:
            return float(min(numbers / np.maximum(np.abs(meridian), 1e-9)))
        case _:
            return None


def hole_of(row: Row) -> float:
    """Radius of the hole in a mirror, mm."""
    return float(row.aperture[0]) if row.mirror and row.aperture_kind in HOLED else 0.0


def filled_gaps(lens: Lens) -> list[tuple[int, int]]:
    """Places, from 0, of the surfaces before and behind each medium that is not air; what bends nothing is skipped."""
    system = lens.system
    walls = [i for i, bends in enumerate(system.bends) if bends] + [system.surfaces]
    return [(a, b) for a, b in pairwise(walls) if system.index[system.primary, a + 1] != 1]


def _coaxial(a: Placed, b: Placed) -> bool:
    """True where b stands upright on the axis of a."""
    offset = a.rotation.T @ (b.origin - a.origin)
    return bool(np.allclose(a.rotation, b.rotation, atol=1e-9) and np.hypot(*offset[:2]) <= 1e-9 * abs(offset[2]))


def _is_ball(lens: Lens, a: int, b: int, apart: float) -> bool:
    """True for two spheres about one centre that make a whole ball."""
    first, second = drawn_rows(lens)[a], drawn_rows(lens)[b]
    if first.powers or second.powers or float(first.conic) != 0 or float(second.conic) != 0:
        return False
    curvatures = np.array([float(first.curvature), float(second.curvature)])
    return bool(np.allclose(curvatures * apart, [2, -2], rtol=1e-9, atol=0))


def _half_heights(hole: float, size: float) -> np.ndarray:
    """Heights from the hole or the vertex to the edge, closer where a steep surface bends fastest."""
    return hole + (size - hole) * np.sin(np.linspace(0, np.pi / 2, HALF_POINTS))


def profile_of(surface: Placed, hole: float, size: float) -> np.ndarray:
    """(N, 2) points of a surface from its lower edge to the upper one; a row of nan at a hole."""
    height = _half_heights(hole, size)
    upper, lower = surface.points(height), surface.points(-height[::-1])
    return np.concatenate([lower, np.full((1, 2), np.nan), upper] if hole else [lower, upper[1:]])


def outline_of(first: Placed, second: Placed, first_size: float, second_size: float) -> np.ndarray:
    """The closed outline of an element, (N, 2): up the first surface, over the edge, down the second and back."""
    flat = _coaxial(first, second)
    vertex, wide = first.origin[:0:-1], first.rotation[:0:-1, 2]
    tall = first.rotation[:0:-1, :2] @ first.meridian
    towards = 1.0 if (second.rotation[:0:-1, :2] @ second.meridian) @ tall >= 0 else -1.0
    first_heights, second_heights = _half_heights(0.0, first_size), towards * _half_heights(0.0, second_size)
    halves = []
    for side in (1.0, -1.0):
        frame = np.stack([side * tall, wide])
        there = (first.points(side * first_heights) - vertex) @ frame.T
        back = (second.points(side * second_heights) - vertex) @ frame.T
        halves.append(_joined(there, back, flat) @ frame + vertex)
    return np.concatenate([halves[0], halves[1][::-1]])


def _joined(first: np.ndarray, second: np.ndarray, flat: bool) -> np.ndarray:
    """From the vertex of one half profile outward and back on the other; points are (height, z).

    Where the profiles cross both end there. Else the lower one is led to the height of the other by a flat, or
    straight to its edge if the flat would cut the other or is not wanted.
    """
    straight = np.concatenate([first, second[::-1]])
    if np.any(np.diff(second[:, 0]) <= 0):
        return straight
    low, high = (
        choose(a, b) for choose, a, b in ((max, first[0, 0], second[0, 0]), (min, first[-1, 0], second[-1, 0]))
    )
    shared = np.union1d(first[:, 0], second[:, 0])
    shared = shared[(shared >= low) & (shared <= high)]
    if shared.size == 0:
        return straight
    gap = np.interp(shared, *second.T) - np.interp(shared, *first.T)
    sense = np.sign(gap[0] or gap[np.abs(gap).argmax()])
    crossed = np.flatnonzero(gap * sense < 0)
    if crossed.size:
        i = crossed[0]
        height = shared[i - 1] + (shared[i] - shared[i - 1]) * gap[i - 1] / (gap[i - 1] - gap[i])
        edge = np.array([[height, np.interp(height, *first.T)]])
        return np.concatenate([first[first[:, 0] < height], edge, second[second[:, 0] < height][::-1]])
    small, large = (first, second) if first[-1, 0] < second[-1, 0] else (second, first)
    if not flat or small[-1, 0] == large[-1, 0]:
        return straight
    corner = np.array([[large[-1, 0], small[-1, 1]]])
    beyond = large[large[:, 0] > small[-1, 0], 1]
    towards_large = sense if large is second else -sense
    if np.any((beyond - corner[0, 1]) * towards_large <= 0):
        return straight
    return np.concatenate([first, corner, second[::-1]])
