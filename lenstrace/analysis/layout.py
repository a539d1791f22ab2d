"""The drawing of a lens in the y-z plane: profiles, glass, mirrors, stop and rays, as points ready to be drawn."""

from __future__ import annotations

from dataclasses import dataclass

import jax
import numpy as np

from lenstrace.analysis.outlines import (
    HOLED,
    Placed,
    drawn_rows,
    filled_gaps,
    hole_of,
    outline_of,
    placed_surfaces,
    profile_of,
    ray_heights,
    semi_diameters,
)
from lenstrace.analysis.rays import trace
from lenstrace.errors import RayError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.rays import Ray, RayStatus
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import pupil_points
from lenstrace.sequential.system import Placement

# Rings of the pupil pattern that finds how wide a surface is, and steps of the fan between two drawn rays.
RINGS, FAN_STEPS = 8, 100
# Parts of the drawing's diagonal: light in front of the lens, bars of the stop, hatching, smallest image.
LEAD, BAR, HATCH, SMALLEST = 0.08, 0.05, 0.012, 0.01
# An object farther away than this many diagonals is not drawn.
FAR_OBJECT = 2.0


@dataclass(frozen=True, eq=False)
class SurfaceDrawing:
    """A surface 1 ... S + 1. Points are (z, y) in mm, in the axes of the first vertex, here and below.

    profile:   (N, 2), from the lower edge to the upper one; a row of nan where a mirror has its hole.
    hatching:  (M, 2, 2), strokes on the back of a mirror, none on other surfaces.
    bars:      (B, 2, 2), what blocks light at a stop, a diaphragm or an obscuration.
    """

    number: int
    semi_diameter: float
    profile: np.ndarray
    hatching: np.ndarray
    bars: np.ndarray
    bends: bool
    is_mirror: bool
    is_stop: bool
    is_image: bool


@dataclass(frozen=True, eq=False)
class MediumDrawing:
    """What fills the space between two surfaces. outline: (N, 2), closed; index: at the primary wavelength."""

    first: int
    last: int
    index: float
    outline: np.ndarray


@dataclass(frozen=True, eq=False)
class RayBundle:
    """Rays of one field, (x, y) in the unit of the layout; each ray is (N, 2). A ray that fails ends there."""

    field: tuple[float, float]
    rays: tuple[np.ndarray, ...]


@dataclass(frozen=True, eq=False)
class Layout:
    """A lens, ready to be drawn. field_kind and field_unit: see `Fields`. axis: (N, 2), the optical axis."""

    name: str
    field_kind: str
    field_unit: str
    surfaces: tuple[SurfaceDrawing, ...]
    media: tuple[MediumDrawing, ...]
    bundles: tuple[RayBundle, ...]
    axis: np.ndarray


def layout(lens: Lens, *, rays_per_field: int = 5) -> Layout:
    """All that a drawing of the lens in the y-z plane needs; rays have the primary wavelength.

    rays_per_field:  rays through evenly spaced points of the pupil from bottom to top; the chief ray is added
                     to an even number. Where an obscuration takes the chief ray, the points are those beside it.

    A surface is as wide as its semi_diameter, else its aperture, else the rays of all fields that reach it.
    RayError for fewer than 1 ray; the errors of `trace` where rays cannot be launched.
    """
    if rays_per_field < 1:
        raise RayError(f"rays_per_field must be at least 1, got {rays_per_field}")
    fan = np.linspace(-1.0, 1.0, FAN_STEPS * max(rays_per_field - 1, 1) + 1)
    pattern_x, pattern_y, _ = pupil_points("hexapolar", RINGS)
    pupil = np.append(pattern_x, 0 * fan), np.append(pattern_y, fan)
    x, y = (np.array(jax.device_get(values), float) for values in (lens.fields.x, lens.fields.y))
    path = jax.device_get(trace(lens, field=(x[:, None], y[:, None]), pupil=pupil))

    placed = placed_surfaces(lens)
    clear, sizes = semi_diameters(lens, placed, ray_heights(path))
    profiles = [profile_of(*of_one) for of_one in zip(placed, map(hole_of, drawn_rows(lens)), sizes, strict=True)]
    seen = [*(bends or row.stop for bends, row in zip(lens.system.bends, lens.rows, strict=True)), True]
    corners = np.concatenate([profile for profile, drawn in zip(profiles, seen, strict=True) if drawn])
    diagonal = float(np.hypot(*np.ptp(corners[np.isfinite(corners[:, 0])], axis=0)))
    sizes[-1] = max(sizes[-1], SMALLEST * diagonal)
    profiles[-1] = profile_of(placed[-1], 0.0, sizes[-1])
    surfaces = tuple(
        _surface(lens, i, placed[i], clear[i], sizes[i], profiles[i], diagonal) for i in range(len(placed))
    )
    bundles = tuple(
        RayBundle((float(x[f]), float(y[f])), _bundle(lens, path, f, chosen, surfaces, placed, diagonal))
        for f, chosen in enumerate(_chosen(lens, path, rays_per_field, len(pattern_x)))
    )
    return Layout(
        lens.name,
        lens.fields.kind,
        lens.fields.unit,
        surfaces,
        _media(lens, placed, sizes),
        bundles,
        _axis(lens, placed, bundles, diagonal),
    )


def _media(lens: Lens, placed: list[Placed], sizes: np.ndarray) -> tuple[MediumDrawing, ...]:
    system = lens.system
    index = system.index[system.primary]
    return tuple(
        MediumDrawing(a + 1, b + 1, float(index[a + 1]), outline_of(placed[a], placed[b], sizes[a], sizes[b]))
        for a, b in filled_gaps(lens)
    )


def _surface(
    lens: Lens,
    place: int,
    surface: Placed,
    clear: float,
    size: float,
    profile: np.ndarray,
    diagonal: float,
) -> SurfaceDrawing:
    row, is_image = drawn_rows(lens)[place], place == len(lens.rows)
    bends = not is_image and lens.system.bends[place]
    hatching = np.zeros((0, 2, 2))
    if row.mirror:
        hole = hole_of(row)
        height = np.linspace(hole, size, max(3, int((size - hole) / (HATCH * diagonal))))
        height = np.concatenate([-height[::-1], height])
        stroke = HATCH * diagonal
        behind = surface.sag(height) + lens.system.sides[place] * stroke
        hatching = np.stack([surface.points(height), surface.points(height - stroke, behind)], 1)
    bars = []
    screen = not bends and row.aperture_kind in HOLED
    if row.stop or (not bends and row.aperture and row.aperture_kind is not ApertureKind.OBSCURATION):
        bars += [(clear, clear + BAR * diagonal), (-clear, -clear - BAR * diagonal)]
    if screen:
        bars.append((-float(row.aperture[0]), float(row.aperture[0])))
    edge = surface.sag(np.full(2, clear))
    drawn = np.array([surface.points(np.array(ends), edge) for ends in bars]).reshape(-1, 2, 2)
    return SurfaceDrawing(place + 1, float(size), profile, hatching, drawn, bends, row.mirror, row.stop, is_image)


def _chosen(lens: Lens, path: Ray, count: int, first: int) -> list[np.ndarray]:
    """For each field the places, among all traced rays, of those to be drawn; the fan begins at `first`."""
    shadow = np.zeros(path.failure.shape[1:], bool)
    for i, row in enumerate(lens.rows, 1):
        if row.aperture_kind in HOLED:
            inside = np.hypot(path.x[i], path.y[i]) < float(row.aperture[0])
            shadow |= inside & (path.status[-1] == RayStatus.CLIPPED) & (path.surface[-1] == i)
    shadow = shadow[:, first:]
    last = shadow.shape[1] - 1
    middle = last // 2
    plain = np.array([middle]) if count == 1 else np.union1d(np.arange(0, last + 1, FAN_STEPS), middle)
    chosen = []
    for row in shadow:
        clear = np.flatnonzero(~row)
        below, above = clear[clear < middle], clear[clear > middle]
        if row[middle] and below.size and above.size:
            steps = (count + 1) // 2
            halves = np.linspace(0, below[-1], steps), np.linspace(last, above[0], steps)
            chosen.append(first + np.union1d(*(np.rint(half).astype(int) for half in halves)))
        else:
            chosen.append(first + plain)
    return chosen


def _bundle(
    lens: Lens,
    path: Ray,
    field: int,
    chosen: np.ndarray,
    surfaces: tuple[SurfaceDrawing, ...],
    placed: list[Placed],
    diagonal: float,
) -> tuple[np.ndarray, ...]:
    """The rays of a field from in front of the lens to the image, or to where they fail."""
    local = np.stack([path.x, path.y, path.z], -1)[:, field, chosen]
    direction = np.stack([path.l, path.m, path.n], -1)[:, field, chosen]
    rotation = np.stack([np.eye(3), *(surface.rotation for surface in placed)])
    origin = np.stack([np.zeros(3), *(surface.origin for surface in placed)])
    points = np.einsum("kij,knj->kni", rotation, local) + origin[:, None]
    direction = np.einsum("kij,knj->kni", rotation, direction)
    failed, status = path.surface[-1, field, chosen], path.status[-1, field, chosen]
    bending = [i for i, bends in enumerate(lens.system.bends, 1) if bends]

    launched = (status == RayStatus.OK) | (failed > 0)
    if not launched.any():
        return ()
    chief = direction[0, launched].mean(0) * [0.0, 1.0, 1.0]
    chief = chief / max(float(np.linalg.norm(chief)), 1e-9)
    solid = np.concatenate(
        [surface.profile for surface in surfaces if surface.bends]
        + [surface.bars.reshape(-1, 2) for surface in surfaces]
    )
    front = np.nanmin(solid @ chief[:0:-1]) - LEAD * diagonal
    near = lens.object_distance is not None and float(lens.object_distance) <= FAR_OBJECT * diagonal

    rays = []
    for j in np.flatnonzero(launched):
        if near:
            back = (-float(lens.object_distance or 0.0) - points[0, j, 2]) / direction[0, j, 2]
        else:
            back = (front - points[0, j] @ chief) / (direction[0, j] @ chief)
        line = [points[0, j] + back * direction[0, j]]
        end = len(surfaces) if status[j] == RayStatus.OK else int(failed[j])
        line += [points[i, j] for i in bending if i < end]
        if status[j] in (RayStatus.MISSED, RayStatus.NOT_CONVERGED):
            line.append(_missed(line[-1], direction[end - 1, j], placed[end - 1], diagonal))
        else:
            line.append(points[end, j])
        rays.append(np.array(line)[:, :0:-1])
    return tuple(rays)


def _missed(point: np.ndarray, direction: np.ndarray, surface: Placed, diagonal: float) -> np.ndarray:
    """Where a ray that missed a surface is left: in its vertex plane, or a bit further on if that is far away."""
    normal = surface.rotation[:, 2]
    along = float((surface.origin - point) @ normal) / (float(direction @ normal) or 1e-9)
    return point + (along if 0 < along <= FAR_OBJECT * diagonal else LEAD * diagonal) * direction


def _axis(lens: Lens, placed: list[Placed], bundles: tuple[RayBundle, ...], diagonal: float) -> np.ndarray:
    """The optical axis: through the vertices, those of surfaces that are moved alone left out."""
    kinds = lens.system.kinds
    vertex = [
        surface.origin[:0:-1]
        for surface, kind in zip(placed, kinds, strict=True)
        if kind.placement is not Placement.POSED
    ]
    starts = [ray[0, 0] for bundle in bundles for ray in bundle.rays]
    lead = LEAD * diagonal
    begin = min([-lead, *starts])
    line = np.array([(begin, 0.0), *vertex])
    if np.any(line[:, 1] != 0):
        end = placed[-1].rotation[:0:-1, 2] * lead * lens.system.orientation[-1]
        return np.concatenate([line, line[-1:] + end / 2])
    return np.array([(line[:, 0].min(), 0.0), (line[:, 0].max() + lead / 2, 0.0)])
