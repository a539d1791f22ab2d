"""Meshes: what is one, what is a solid, and those made by formulas."""

from __future__ import annotations

import numpy as np
import pytest

from lenstrace.errors import SceneError
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.mesh_formula import SURFACES, Parametric, formula_mesh

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
SIDES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
FACES = np.array([face for a, b, c, d in SIDES for face in ((a, b, c), (a, c, d))])


def test_a_cube() -> None:
    mesh = Mesh(CORNERS, FACES)
    assert len(mesh) == 12
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(1, rel=1e-14)
    mesh.require_solid("a dielectric")
    assert mesh.scaled(3).volume == pytest.approx(27, rel=1e-14)
    # corners that are not shared by number are shared by place
    apart = Mesh(mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(36).reshape(12, 3))
    assert apart.is_watertight


def test_an_open_cube_is_no_solid() -> None:
    mesh = Mesh(CORNERS, FACES[:-1])
    assert not mesh.is_watertight
    with pytest.raises(SceneError, match=r"not watertight, but a dielectric needs .* 3 edges .* near \(1, "):
        mesh.require_solid("a dielectric")


def test_a_face_turned_round_or_twice_is_no_solid() -> None:
    turned = FACES.copy()
    turned[4] = turned[4, ::-1]
    assert not Mesh(CORNERS, turned).is_watertight
    assert not Mesh(CORNERS, np.concatenate([FACES, FACES[:1]])).is_watertight


def test_a_cube_that_looks_inward() -> None:
    mesh = Mesh(CORNERS, FACES).reversed()
    assert mesh.is_watertight
    with pytest.raises(SceneError, match=r"look inward.*mesh\.reversed"):
        mesh.require_solid("a dielectric")
    mesh.reversed().require_solid("a dielectric")


def test_faces_without_area_are_left_out() -> None:
    faces = np.concatenate([FACES, [[0, 0, 1], [2, 5, 2]]])
    mesh = Mesh(CORNERS, faces)
    assert (len(mesh), mesh.dropped, mesh.is_watertight) == (12, 2, True)
    line = np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2.0]])
    with pytest.raises(SceneError, match="none of its 1 triangles has an area"):
        Mesh(line, np.array([[0, 1, 2]]))


def test_small_meshes_have_areas() -> None:
    mesh = Mesh(CORNERS * 1e-170, FACES)
    assert mesh.dropped == 0
    kept = Mesh(CORNERS * 1e-25, FACES).triangles((0, 0, 0), (0, 0, 0), np.dtype(np.float32))
    assert len(kept.a[0]) == 12
    with pytest.raises(SceneError, match="too small for its place in float32"):
        Mesh(CORNERS * 1e-9, FACES).triangles((1, 1, 1), (0, 0, 0), np.dtype(np.float32))


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (CORNERS[:, :2], FACES, r"vertices must be an array \(count, 3\), got \(8, 2\)"),
        (CORNERS, FACES[:, :2], r"faces must be an array"),
        (CORNERS, FACES[:0], "no triangles"),
        (CORNERS, FACES * 1.0, "faces must be whole numbers, got float64"),
        (CORNERS, FACES + 1, r"face 1 names a vertex that is not there|face \d+ names a vertex .* of 0 to 7"),
        (CORNERS, FACES - 1, r"face 0 names a vertex that is not there: \[-1, 1, 2\]"),
        (np.where(CORNERS == 1, np.nan, CORNERS), FACES, "vertex 1 is not finite"),
    ],
)
def test_refused(vertices: np.ndarray, faces: np.ndarray, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        Mesh(vertices, faces)


@pytest.mark.parametrize("name", SURFACES)
def test_shipped_formulas_are_solids(name: str) -> None:
    mesh = formula_mesh(name, 60, 30)
    mesh.require_solid("a dielectric")
    assert len(formula_mesh(name, 264, 136)) >= 70_000


def test_volumes_of_formulas() -> None:
    # the sphere
    round_one = formula_mesh("superquadric", 200, 200, {"north": 1, "east": 1})
    assert round_one.volume == pytest.approx(4 / 3 * np.pi, rel=1e-3)
    assert formula_mesh("rippled sphere", 200, 200, {"height": 0}).volume == pytest.approx(4 / 3 * np.pi, rel=1e-3)
    # Pappus for tubes about any curve: area times length of the curve
    a = np.linspace(0, 2 * np.pi, 20001)
    length = np.trapezoid(np.sqrt(9 + 4 * (2 + np.cos(3 * a)) ** 2), a)
    assert formula_mesh("torus knot", 600, 60, {"tube": 0.2}).volume == pytest.approx(np.pi * 0.04 * length, rel=3e-3)


def test_a_sheet() -> None:
    sheet = Parametric("u", "v", "height * u * v", constants={"height": 2}).mesh(3, 2)
    assert len(sheet) == 12
    assert len(sheet.vertices) == 12
    assert not sheet.is_watertight
    # counterclockwise seen from above
    a, b, c = np.moveaxis(sheet.vertices[sheet.faces], 1, 0)
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_formulas_refused() -> None:
    with pytest.raises(SceneError, match="unknown surface 'klein'; one of rippled sphere"):
        formula_mesh("klein", 10, 10)
    with pytest.raises(SceneError, match="superquadric has no constant 'south'; it has north, east"):
        formula_mesh("superquadric", 10, 10, {"south": 1})
    with pytest.raises(SceneError, match="steps_u must be at least 3, got 2"):
        formula_mesh("superquadric", 2, 10)
    with pytest.raises(SceneError, match="not finite at u = 0, v = 0"):
        Parametric("1 / u", "v", "u").mesh(4, 4)
    with pytest.raises(SceneError, match="unknown name 'w'"):
        Parametric("w", "v", "u").mesh(4, 4)
