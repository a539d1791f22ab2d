"""A path of straight pieces through a lens, whose corners can be displaced along the surfaces that bend light.

Its optical path is the sum of n |P' - P| over the pieces, counted negative where a piece runs against the light (to an
image in front of the last surface, say); from an object at infinity the first piece counts n d . P.
"""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree, static
from lenstrace.errors import OptionError
from lenstrace.optics.rays import Ray, split_failure
from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System
from lenstrace.sequential.vertices import vertices

# How far a ray in the y-z plane may be beside it, and a surface turned out of it.
IN_PLANE = 1e-9
# Pieces shorter than this part of the whole path have no direction.
SHORTEST = 1e-12


@pytree
class BrokenPath:
    """The path of a ray through the B surfaces that bend it; mm, in the axes of the first vertex.

    shapes, numbers:   the surfaces, stacked, and (B,), which they are.
    rotation, origin:  (B, 3, 3) and (B, 3), global from local and the vertices.
    corners:           (B, 3), local.
    tangents:          (B, 2, 3), local unit vectors: in the plane of incidence, y-z, and across it.
    index, sense:      (B + 1,), of the pieces; sense is -1 for one that runs against the light, else +1.
    directions:        (B + 1, 3), of the light along them.
    start, end:        (3,).
    near:              whether `start` is a point source; else light comes from infinity.
    """

    shapes: Asphere
    numbers: np.ndarray
    rotation: np.ndarray
    origin: np.ndarray
    corners: np.ndarray
    tangents: np.ndarray
    index: np.ndarray
    sense: np.ndarray
    directions: np.ndarray
    start: np.ndarray
    end: np.ndarray
    near: bool = static()

    @property
    def points(self) -> np.ndarray:
        """(B + 2, 3), start, corners and end."""
        inner = (self.rotation @ self.corners[:, :, None])[:, :, 0] + self.origin
        return np.concatenate([self.start[None], inner, self.end[None]])

    @property
    def lengths(self) -> np.ndarray:
        """(B + 1,), of the pieces, signed."""
        return self.sense * np.sqrt((np.diff(self.points, axis=0) ** 2).sum(1))


def corners(path: BrokenPath, displaced: jax.Array) -> jax.Array:
    """(B, 3), global; displaced: (B, 2), mm along the tangents of each corner, which stays on its surface."""
    shift = (displaced[:, :, None] * path.tangents).sum(1)
    x, y = shift[:, 0] + path.corners[:, 0], shift[:, 1] + path.corners[:, 1]
    local = jnp.stack([x, y, path.shapes.sag(x, y)], -1)
    return (path.rotation * local[:, None, :]).sum(-1) + path.origin


def optical_path(path: BrokenPath, displaced: jax.Array) -> jax.Array:
    """mm; displaced: see `corners`."""
    points = corners(path, displaced)
    lengths = path.sense[1:] * jnp.sqrt((jnp.diff(jnp.concatenate([points, path.end[None]]), axis=0) ** 2).sum(-1))
    first = points[0] - path.start
    length = path.sense[0] * jnp.sqrt((first**2).sum()) if path.near else (path.directions[0] * first).sum()
    return path.index[0] * length + (path.index[1:] * lengths).sum()


def path_of_ray(lens: Lens, field: float, pupil: float, end: float) -> BrokenPath:
    """The path of a traced ray in the y-z plane, at the primary wavelength.

    field, pupil:  y, in units of the largest field and of the pupil's radius.
    end:           where the path ends, in parts of its last piece, which runs to the image.
    OptionError where there is no such path.
    """
    lens = lens.astype("float64")
    system = lens.system.at(lens.system.primary)
    largest = max(abs(float(y)) for y in lens.fields.y)
    ray, rotation, origin = jax.device_get(_traced(lens, jnp.asarray([field * largest]), jnp.asarray(pupil)))
    if ray.failure[-1, 0]:
        surface, status = split_failure(int(ray.failure[-1, 0]))
        raise OptionError(f"fermat: the ray ends at surface {surface}: {status.text}; choose another field or pupil")
    bending = np.flatnonzero(system.bends)
    if not len(bending):
        raise OptionError("fermat: no surface of this lens bends light")
    if thin := [number for number, row in enumerate(lens, 1) if row.screen is not None]:
        raise OptionError(
            f"fermat: surface {thin[0]} carries a phase screen, whose path is no broken line; take a lens without"
        )
    local = np.stack([ray.x, ray.y, ray.z], -1)[1:, 0]
    behind = np.stack([ray.l, ray.m, ray.n], -1)[1:, 0]
    at = (rotation @ local[:, :, None])[:, :, 0] + origin
    directions = np.concatenate(
        [[[ray.l[0, 0], ray.m[0, 0], ray.n[0, 0]]], (rotation @ behind[:, :, None])[bending, :, 0]]
    )
    size = abs(at).max()
    turned = abs(rotation[bending][:, :, 0] - [1, 0, 0]).max()
    if turned > IN_PLANE or abs(at[:, 0]).max() > IN_PLANE * size:
        raise OptionError("fermat: the ray leaves the y-z plane; take a lens that is symmetric about it")
    start = np.array([ray.x[0, 0], ray.y[0, 0], ray.z[0, 0]])
    if lens.object_distance is not None:
        start = start - (lens.object_distance + start[2]) / directions[0, 2] * directions[0]
    last = at[bending[-1]]
    points = np.concatenate([start[None], at[bending], (last + end * (at[-1] - last))[None]])
    along = (np.diff(points, axis=0) * directions).sum(1)
    pieces = along if lens.object_distance is not None else along[1:]
    if abs(pieces).min() <= SHORTEST * size:
        raise OptionError("fermat: two surfaces touch where the ray meets them; choose another field or pupil")
    shapes = _shapes(system, bending)
    slopes = local[bending, 1] * profile(shapes, abs(local[bending, 1]))[0]
    tangents = np.stack([0 * slopes, np.ones_like(slopes), slopes], -1) / np.sqrt(1 + slopes**2)[:, None]
    across = np.array([1.0, 0.0, 0.0])
    return BrokenPath(
        shapes,
        bending + 1,
        rotation[bending],
        origin[bending],
        local[bending],
        np.stack([tangents, across + 0 * tangents], 1),
        np.asarray(system.index)[np.append(bending, bending[-1] + 1)],
        np.sign(along),
        directions,
        start,
        points[-1],
        near=lens.object_distance is not None,
    )


def profile(shapes: Asphere, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """f' / r and f'', 1/mm, of surfaces z = f(r) at the distances r from their axes, mm."""
    c, k, scale = (np.asarray(a) for a in (shapes.curvature, shapes.conic, shapes.norm_radius))
    root = np.sqrt(1 - (1 + k) * c * c * r * r)
    first, second = c / root, c / root**3
    for p, b in zip(shapes.powers, np.asarray(shapes.coefficients), strict=True):
        change = p * b * (r / scale) ** (p - 2) / scale
        first, second = first + change, second + (p - 1) * change
    return first, second


@compiled
def _traced(lens: Lens, field: jax.Array, pupil: jax.Array) -> tuple[Ray, jax.Array, jax.Array]:
    """The ray at every surface, and the frames of these."""
    ray = trace(lens, field=field, pupil=(0.0, pupil))
    return ray, *vertices(lens.system)


def _shapes(system: System, which: np.ndarray) -> Asphere:
    """Those of some surfaces, their numbers in arrays."""
    powers = max((kind.powers for kind in system.kinds), key=len)
    coefficients = np.asarray(system.coefficients)[which].T
    curvature, conic, radius = (np.asarray(a)[which] for a in (system.curvature, system.conic, system.norm_radius))
    numbers: list[Any] = [curvature, conic, coefficients, radius]
    return Asphere(*numbers, powers=powers)
