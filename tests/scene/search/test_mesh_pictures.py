"""Pictures of meshes: the same whatever way the nearest triangle is found, and what a mesh must be for a material."""

from __future__ import annotations

import numpy as np
import pytest

from lenstrace.errors import SceneError
from lenstrace.optics.shapes.rectangle import Rectangle
from lenstrace.scene import task
from lenstrace.scene.build import world_of
from lenstrace.scene.cameras.simple import Pinhole
from lenstrace.scene.cameras.view import View
from lenstrace.scene.materials.dielectric import Dielectric
from lenstrace.scene.materials.diffuse import Diffuse
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.mesh_formula import formula_mesh
from lenstrace.scene.objects import Object, Scene
from lenstrace.scene.render import render
from lenstrace.scene.search.kind import Way

GREY = Diffuse((0.6, 0.6, 0.6))
CAMERA = Pinhole(View((0.0, 1.0, 5.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)), 40.0)


def test_the_same_picture_either_way(monkeypatch: pytest.MonkeyPatch) -> None:
    glow = formula_mesh("torus knot", 60, 8, {"tube": 0.2}).scaled(0.2)
    scene = Scene(
        [
            Object(formula_mesh("rippled sphere", 40, 20), Dielectric(1.5, 1.0)),
            Object(Rectangle(3.0, 3.0), GREY, (0, -1.2, 0), (-90, 0, 0)),
            Object(glow, GREY, (1.6, 0, 0), emission=(4.0, 3.0, 2.0)),
        ],
        environment=(0.2, 0.3, 0.4),
    )
    pictures = []
    for way in (Way.AUTO, Way.HIERARCHY):
        monkeypatch.setattr(task, "world_of", lambda scene, dtype, way=way: world_of(scene, dtype, way))
        pictures.append(render(scene, CAMERA, size=(48, 48), samples=4, depth=8).radiance)
    # single precision may find the neighbour at an edge, after which a path of the glass goes elsewhere
    apart = np.abs(pictures[0] - pictures[1]).max(-1) > 1e-3
    assert apart.mean() < 5e-3
    assert np.isfinite(pictures).all()
    assert pictures[0].max() > 1


def test_a_white_furnace() -> None:
    """Closed, emission 0.5, albedo 0.5: after n terms 1 - 1/2^n; a leak would be dark."""
    shell = formula_mesh("rippled sphere", 40, 20).reversed()
    scene = Scene([Object(shell, Diffuse((0.5, 0.5, 0.5)), emission=(0.5, 0.5, 0.5))])
    camera = Pinhole(View((0.1, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)), 80.0)
    picture = render(scene, camera, size=(64, 64), samples=16, depth=4, method="path")
    assert picture.radiance.mean() == pytest.approx(0.9375, abs=4 * float(picture.radiance.std()) / 64)


def test_a_glass_must_be_closed() -> None:
    mesh = formula_mesh("rippled sphere", 12, 6)
    open_one = Mesh(mesh.vertices, mesh.faces[:-1])
    with pytest.raises(SceneError, match=r"object 1 \(bowl\): mesh: not watertight, but a Dielectric needs"):
        world_of(Scene([Object(open_one, Dielectric(1.5, 1.0), name="bowl")]))
    with pytest.raises(SceneError, match="object 1: mesh: its faces look inward"):
        world_of(Scene([Object(mesh.reversed(), Dielectric(1.5, 1.0))]))
    with pytest.raises(SceneError, match="object 1: motion: a mesh cannot move"):
        world_of(Scene([Object(mesh, GREY, motion=(1.0, 0.0, 0.0))]))
    world_of(Scene([Object(open_one, GREY)]))
