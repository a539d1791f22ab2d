"""Meshes out of files of each format, and files that hold none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lenstrace.errors import SceneError
from lenstrace.scene.mesh_file import load_mesh

trimesh = pytest.importorskip("trimesh")
pytestmark = pytest.mark.filterwarnings("ignore")


def _corners(mesh) -> np.ndarray:  # type: ignore[no-untyped-def]
    """Corners of all triangles, in an order that does not depend on how they are numbered."""
    corners = np.round(mesh.vertices[mesh.faces].reshape(-1, 9), 5) + 0.0
    turned = np.stack([np.roll(corners, 3 * i, -1) for i in range(3)])
    least = np.lexsort(turned.transpose(2, 0, 1)[::-1], axis=0)[0]
    corners = np.take_along_axis(turned, least[None, :, None], 0)[0]
    return corners[np.lexsort(corners.T[::-1])]


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "gltf", "glb"])
def test_each_format(tmp_path: Path, ending: str) -> None:
    ball = trimesh.creation.icosphere(subdivisions=1, radius=2.0)
    path = tmp_path / ("ball." + ending)
    if ending == "gltf":
        for name, data in trimesh.exchange.gltf.export_gltf(trimesh.Scene(ball)).items():
            (tmp_path / name).write_bytes(data)
        path = tmp_path / "model.gltf"
    else:
        ball.export(path)
    mesh = load_mesh(path)
    assert len(mesh) == 80
    assert mesh.volume == pytest.approx(ball.volume, rel=1e-5)
    mesh.require_solid("a dielectric")
    assert np.allclose(_corners(mesh), _corners(ball), atol=2e-5)


def test_geometries_stand_where_the_file_puts_them(tmp_path: Path) -> None:
    box = trimesh.creation.box()
    scene = trimesh.Scene()
    scene.add_geometry(box, transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    mirrored = np.diag([-2.0, 1, 1, 1])
    scene.add_geometry(box, transform=mirrored)
    path = tmp_path / "two.glb"
    scene.export(path)
    mesh = load_mesh(path)
    assert len(mesh) == 24
    assert mesh.volume == pytest.approx(3, rel=1e-6)
    assert np.allclose([mesh.vertices.min(0), mesh.vertices.max(0)], [[-1, -0.5, -0.5], [5.5, 0.5, 0.5]])
    mesh.require_solid("a dielectric")


def test_polygons_are_cut_into_triangles(tmp_path: Path) -> None:
    path = tmp_path / "square.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    assert len(load_mesh(path)) == 2


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("lost.obj", None, r"lost\.obj: there is no such file"),
        ("mesh.blend", "", r"unknown format '\.blend'; one of \.obj, \.ply, \.stl, \.gltf, \.glb"),
        ("mesh", "", "unknown format ''"),
        ("points.obj", "v 0 0 0\nv 1 0 0\n", "points.obj: (holds no triangles|cannot be read)"),
        ("empty.obj", "", "empty.obj: (holds no triangles|cannot be read)"),
        ("broken.ply", "ply\nformat ascii 1.0\nelement vertex", "broken.ply: cannot be read as ply"),
        ("broken.gltf", "{", "broken.gltf: cannot be read as gltf"),
        ("broken.glb", "glTF", "broken.glb: cannot be read as glb"),
        ("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "line.obj: none of its 1 triangles has an area"),
        ("far.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 9\n", "far.obj: (cannot be read|face 0 names|holds no)"),
    ],
)
def test_refused(tmp_path: Path, name: str, text: str | None, message: str) -> None:
    path = tmp_path / name
    if text is not None:
        path.write_text(text)
    with pytest.raises(SceneError, match=message):
        load_mesh(path)
