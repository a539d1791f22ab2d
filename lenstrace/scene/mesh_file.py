"""Meshes out of files, through trimesh (extra `mesh`)."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from lenstrace.errors import SceneError
from lenstrace.scene.mesh import Mesh

FORMATS = (".obj", ".ply", ".stl", ".gltf", ".glb")


def load_mesh(path: str | os.PathLike[str]) -> Mesh:
    """All triangles of a file, each geometry where the file puts it. SceneError: which file, and what is wrong with it.

    Units and axes are those of the file.
    """
    where = f"mesh {os.fspath(path)}"
    if not os.path.isfile(path):
        raise SceneError(f"{where}: there is no such file")
    ending = os.path.splitext(path)[1].lower()
    if ending not in FORMATS:
        raise SceneError(f"{where}: unknown format {ending!r}; one of {', '.join(FORMATS)}")
    try:
        import trimesh
    except ImportError:
        raise SceneError(f"{where}: needs trimesh; pip install 'lenstrace[mesh]'") from None
    try:
        loaded = trimesh.load(os.fspath(path), process=False)
        parts = _parts(loaded, trimesh.Trimesh)
    # a reader of foreign files raises whatever its format made it stumble over
    except Exception as error:
        raise SceneError(f"{where}: cannot be read as {ending[1:]}: {str(error) or type(error).__name__}") from None
    if not sum(len(faces) for _, faces in parts):
        raise SceneError(f"{where}: holds no triangles")
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
    try:
        return Mesh(
            np.concatenate([vertices for vertices, _ in parts]),
            np.concatenate([faces + start for (_, faces), start in zip(parts, starts, strict=False)]),
        )
    except SceneError as error:
        raise SceneError(f"{where}: {str(error).removeprefix('mesh: ')}") from None


def _parts(loaded: Any, kind: type) -> list[tuple[np.ndarray, np.ndarray]]:
    """Vertices and faces of each geometry of triangles, in the axes of the file."""
    if isinstance(loaded, kind):
        return [(np.asarray(loaded.vertices), np.asarray(loaded.faces))]  # type: ignore[attr-defined]
    parts = []
    for node in getattr(getattr(loaded, "graph", None), "nodes_geometry", ()):
        matrix, name = loaded.graph[node]
        geometry = loaded.geometry[name]
        if isinstance(geometry, kind):
            vertices = np.asarray(geometry.vertices) @ matrix[:3, :3].T + matrix[:3, 3]  # type: ignore[attr-defined]
            faces = np.asarray(geometry.faces)  # type: ignore[attr-defined]
            # a mirror image turns the sense of its faces
            parts.append((vertices, faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else faces))
    return parts
