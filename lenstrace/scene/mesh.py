"""Meshes of triangles: what a person puts into a scene."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from lenstrace.errors import SceneError
from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.scene.frame import Three, frame_at


@dataclasses.dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that share corners.

    vertices:  (V, 3), lengths in the mesh's own axes.
    faces:     (F, 3), numbers of the corners of each triangle, counterclockwise seen from outside. Those without an
               area are left out, since no ray meets them; `dropped` says how many were.
    """

    vertices: np.ndarray
    faces: np.ndarray
    dropped: int = dataclasses.field(init=False, default=0)

    def __post_init__(self) -> None:
        vertices, faces = np.asarray(self.vertices), np.asarray(self.faces)
        for name, array in (("vertices", vertices), ("faces", faces)):
            if array.ndim != 2 or array.shape[1] != 3:
                raise SceneError(f"mesh: {name} must be an array (count, 3), got {array.shape}")
        vertices = vertices.astype(float)
        if len(faces) == 0:
            raise SceneError("mesh: has no triangles; give at least one")
        if not np.issubdtype(faces.dtype, np.integer):
            raise SceneError(f"mesh: faces must be whole numbers, got {faces.dtype}")
        if not np.isfinite(vertices).all():
            row = int(np.flatnonzero(~np.isfinite(vertices).all(1))[0])
            raise SceneError(f"mesh: vertex {row} is not finite, got {vertices[row].tolist()}")
        wrong = (faces < 0) | (faces >= len(vertices))
        if wrong.any():
            row = int(np.flatnonzero(wrong.any(1))[0])
            last = len(vertices) - 1
            raise SceneError(
                f"mesh: face {row} names a vertex that is not there: {faces[row].tolist()}, of 0 to {last}"
            )
        kept = _doubled_areas(vertices, faces) > 0
        if not kept.any():
            raise SceneError(f"mesh: none of its {len(faces)} triangles has an area")
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces[kept].astype(np.int64))
        object.__setattr__(self, "dropped", int(len(faces) - kept.sum()))

    def __len__(self) -> int:
        """Triangles."""
        return len(self.faces)

    @property
    def is_watertight(self) -> bool:
        """Whether it bounds a solid: each edge is shared by exactly two faces, which pass it in opposite senses.

        Vertices at one place are one vertex, as in files that do not say which corners are shared.
        """
        return self._open_edges.size == 0

    @property
    def volume(self) -> float:
        """Of the solid that a watertight mesh bounds; negative where its faces look inward."""
        a, b, c = np.moveaxis((self.vertices - self.vertices.mean(0))[self.faces], 1, 0)
        return float(np.einsum("ki,ki->", a, np.cross(b, c)) / 6)

    def winding(self, point: np.ndarray) -> float:
        """How often the mesh goes around a point (3,): 1 inside a solid, 0 outside, -1 in a room whose faces look in.

        The sum of the solid angles of the triangles over 4 pi.
        Source: A. van Oosterom, J. Strackee, IEEE Trans. Biomedical Engineering 30, 125 (1983), Eq. (8).
        """
        corners = (self.vertices - point)[self.faces]
        a, b, c = np.moveaxis(corners, 1, 0)
        p, q, r = np.linalg.norm(corners, axis=-1).T
        across = np.einsum("ki,ki->k", a, np.cross(b, c))
        around = p * q * r + sum(
            np.einsum("ki,ki->k", first, second) * length for first, second, length in ((a, b, r), (b, c, p), (c, a, q))
        )
        return float(np.sum(np.arctan2(across, around)) / (2 * np.pi))

    def require_solid(self, why: str) -> None:
        """SceneError unless the mesh bounds a solid and looks outward. why: as "a dielectric"."""
        if self._open_edges.size:
            count, (x, y, z) = len(self._open_edges), self._open_edges.mean(1)[0]
            raise SceneError(
                f"mesh: not watertight, but {why} needs a closed surface: {count} edges do not lie between exactly two "
                f"faces of one sense, the first near ({x:.6g}, {y:.6g}, {z:.6g}); close the holes in the program that "
                "made it"
            )
        if self.volume < 0:
            raise SceneError(f"mesh: its faces look inward, but {why} needs them outward; take mesh.reversed()")

    def reversed(self) -> Mesh:
        """The same triangles seen from the other side."""
        return Mesh(self.vertices, self.faces[:, ::-1])

    def scaled(self, factor: float) -> Mesh:
        """Larger by a factor, which is not 0."""
        return Mesh(self.vertices * abs(factor), self.faces)

    def triangles(self, position: Three, rotation: Three, dtype: np.dtype) -> Triangle:
        """Stacked triangles in the axes of the scene, in a precision; those that it leaves without an area are gone."""
        frame = frame_at(position, rotation, None)
        axes = np.array([frame.x, frame.y, frame.z], float)
        vertices = (self.vertices @ axes + np.array(position, float)).astype(dtype)
        faces = self.faces[_doubled_areas(vertices, self.faces) > 0]
        if len(faces) == 0:
            raise SceneError(
                f"mesh: too small for its place in {np.dtype(dtype)}: none of its triangles has an area there"
            )
        a, b, c = (tuple(vertices[faces[:, i]].T) for i in range(3))
        return Triangle(a, b, c)  # type: ignore[arg-type]

    @functools.cached_property
    def _open_edges(self) -> np.ndarray:
        """Ends (N, 2, 3) of the edges that are not shared by exactly two faces in opposite senses."""
        # + 0: minus zero is zero
        _, name = np.unique(self.vertices + 0.0, axis=0, return_inverse=True)
        faces = name.ravel()[self.faces]
        ends = np.concatenate([faces[:, [i, (i + 1) % 3]] for i in range(3)])
        corners = np.concatenate([self.faces[:, [i, (i + 1) % 3]] for i in range(3)])
        forward = ends[:, 0] < ends[:, 1]
        low, high = ends.min(1), ends.max(1)
        _, first, edge = np.unique(low * (high.max() + 1) + high, return_index=True, return_inverse=True)
        ahead = np.bincount(edge, forward, len(first))
        back = np.bincount(edge, ~forward, len(first))
        return self.vertices[corners[first[(ahead != 1) | (back != 1)]]]


def _doubled_areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Squares of twice the areas, in the precision of the vertices; scaled, so that a small mesh has areas too."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    first, second = b - a, c - a
    size = np.maximum(np.abs(first).max(1), np.abs(second).max(1))[:, None]
    size = np.where(size > 0, size, 1)
    across = np.cross(first / size, second / size)
    return np.einsum("ki,ki->k", across, across)
