"""Scene files: what they say, and what is wrong with them in one line."""

from pathlib import Path

import numpy as np
import pytest

from lenstrace.errors import LensTraceError
from lenstrace.io.scene import load_scene
from lenstrace.scene import Checker, Dielectric, Pinhole, Sphere

SCENES = sorted((Path(__file__).parents[2] / "designs" / "scenes").glob("*.toml"))

BALL = """
name = "A ball"
[camera]
kind = "pinhole"
position = [0, 1, 5]
target = [0, 0.5, 0]
field_of_view = 40
[render]
method = "whitted"
size = [30, 20]
[materials]
board = { kind = "diffuse", albedo = { kind = "checker", even = 0.9, odd = [0.1, 0.1, 0.2] } }
[[objects]]
shape = { kind = "sphere", radius = 0.5 }
material = { kind = "dielectric", index = 1.5 }
position = [0, 0.5, 0]
[[objects]]
shape = { kind = "plane" }
material = "board"
rotation = [-90, 0, 0]
[[lights]]
kind = "point_light"
position = [2, 4, 3]
intensity = 30
"""


@pytest.fixture
def write(tmp_path):
    def writes(text):
        path = tmp_path / "scene.toml"
        path.write_text(text)
        return path

    return writes


def test_a_file_is_what_it_says(write):
    setup = load_scene(write(BALL))
    ball, floor = setup.scene.objects
    assert setup.scene.name == "A ball"
    assert isinstance(ball.shape, Sphere)
    assert ball.shape.radius == 0.5
    assert isinstance(ball.material, Dielectric)
    assert isinstance(floor.material.albedo, Checker)
    assert floor.rotation == (-90, 0, 0)
    assert isinstance(setup.camera, Pinhole)
    assert setup.camera.view.up == (0, 1, 0)
    assert setup.settings.size == (30, 20)
    assert setup.settings.method == "whitted"


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_every_scene_is_read_and_says_where_it_comes_from(path):
    setup = load_scene(path)
    assert setup.scene.name
    assert 'source = "' in path.read_text()


def test_a_map_is_looked_for_beside_the_file(write, tmp_path):
    np.save(tmp_path / "sky.npy", np.ones((4, 8, 3)))
    setup = load_scene(write(BALL + '[environment]\nmap = "sky.npy"\n'))
    assert np.shape(setup.scene.environment) == (4, 8, 3)
    with pytest.raises(LensTraceError, match=r"scene.toml: environment: map .*moon.npy cannot be read"):
        load_scene(write(BALL + '[environment]\nmap = "moon.npy"\n'))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('kind = "sphere"', 'kind = "spere"', "objects 1: shape: unknown kind 'spere'; did you mean 'sphere'"),
        ("radius = 0.5", "radus = 0.5", "unknown key 'radus'; did you mean 'radius'"),
        (", radius = 0.5", "", "objects 1: shape, sphere: radius is missing"),
        ('material = "board"', 'material = "bord"', "objects 2: material 'bord' is not in .materials.; did you mean"),
        ('material = "board"\n', "", "objects 2: material is missing"),
        ("position = [0, 0.5, 0]", "place = [0, 0.5, 0]", "objects 1: unknown key 'place'"),
        ('kind = "pinhole"', 'kind = "pinhol"', "camera: unknown kind 'pinhol'; did you mean 'pinhole'"),
        ("target = [0, 0.5, 0]\n", "", "camera, pinhole: target is missing"),
        ("[camera]\n", "[camra]\n", "unknown key 'camra'; did you mean 'camera'"),
        ("[[lights]]", "[[light]]", "unknown key 'light'; did you mean 'lights'"),
        ('method = "whitted"', 'methods = "whitted"', "render: unknown key 'methods'"),
        ('kind = "checker"', 'kind = "check"', "materials: board, diffuse: albedo: unknown kind 'check'"),
        ("[[objects]]", "[[objects]", "not valid TOML"),
        ('name = "A ball"', 'objects = "A ball"', "not valid TOML|list of tables"),
    ],
)
def test_mistakes_are_named(write, old, new, words):
    with pytest.raises(LensTraceError, match=words) as raised:
        load_scene(write(BALL.replace(old, new, 1)))
    assert "scene.toml" in str(raised.value)
    assert "\n" not in str(raised.value)
