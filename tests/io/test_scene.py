"""Scene files: what they say, and what is wrong with them in one line."""

from pathlib import Path

import numpy as np
import pytest

from lenstrace.errors import LensTraceError
from lenstrace.io.scene import load_scene
from lenstrace.scene import Checker, Dielectric, LensCamera, Pinhole, Sphere

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


KINDS = {
    "conic": ('{ kind = "conic", radius = 2.0, conic = -1.0, semi_diameter = 0.8 }', "ConicCap"),
    "asphere": (
        '{ kind = "asphere", radius = 2.0, semi_diameter = 0.8, terms = { 4 = 0.01, 6 = -0.001 } }',
        "AsphereCap",
    ),
    "implicit": (
        '{ kind = "implicit", function = "x^2 + y^2 + z^2 - r^2", reach = 1.0, constants = { r = 0.9 } }',
        "Implicit",
    ),
    "formula": ('{ kind = "mesh", formula = "torus knot", steps = [30, 8], constants = { tube = 0.3 } }', "Mesh"),
    "corners": ('{ kind = "mesh", vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] }', "Mesh"),
    "file": ('{ kind = "mesh", file = "one.obj", scale = 2.0, reversed = true }', "Mesh"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_shapes_in_the_words_of_a_person(write, tmp_path, kind):
    (tmp_path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    text, name = KINDS[kind]
    shape = load_scene(write(BALL.replace('{ kind = "sphere", radius = 0.5 }', text))).scene.objects[0].shape
    assert type(shape).__name__ == name
    if kind == "file":
        assert shape.vertices.max() == 2
        assert shape.faces.tolist() == [[2, 1, 0]]
    if kind == "formula":
        assert len(shape) == 480


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{ kind = "mesh" }', "shape, mesh: mesh: give one of file = .a.ply., formula = .torus knot., or vertices"),
        ('{ kind = "mesh", file = "none.ply" }', "shape, mesh: mesh .*none.ply: there is no such file"),
        ('{ kind = "mesh", formula = "knot" }', "mesh: unknown surface 'knot'; one of rippled sphere"),
        ('{ kind = "mesh", formula = "torus knot", steps = 3 }', "steps must be two whole numbers"),
        ('{ kind = "mesh", formula = "torus knot", scale = -1 }', "shape, mesh: scale must be positive, got -1"),
        (
            '{ kind = "mesh", vertices = [[0, 0]], faces = [[0, 0, 0]] }',
            "mesh: vertices must be an array .count, 3., got|must be lists of three",
        ),
        ('{ kind = "mesh", vertices = [[0, 0, 0], [1]], faces = [[0, 1, 2]] }', "must be lists of three numbers each"),
        ('{ kind = "implicit", function = "x +", reach = 1.0 }', "formula 'x .': cannot be read"),
        ('{ kind = "implicit", function = "1 / x", reach = 1.0 }', "shape, implicit: .*steepness"),
        ('{ kind = "conic", radius = 0.0, semi_diameter = 1.0 }', "shape, conic: radius must not be 0"),
        ('{ kind = "conic", radius = "2", semi_diameter = 1.0 }', "shape, conic: radius must be a number, got '2'"),
        ('{ kind = "implicit", function = "x", reach = "1" }', "shape, implicit: reach must be a number, got '1'"),
        (
            '{ kind = "asphere", radius = 2.0, semi_diameter = 0.8, terms = { x = 1.0 } }',
            "a power must be a whole number",
        ),
    ],
)
def test_mistakes_in_shapes_are_named(write, text, words):
    with pytest.raises(LensTraceError, match=words) as raised:
        load_scene(write(BALL.replace('{ kind = "sphere", radius = 0.5 }', text)))
    assert "scene.toml: objects 1: " in str(raised.value)


LENS = """kind = "lens"
file = "lens.toml"
focus = 5.0
f_number = 8
unit_mm = 1000
film = 24.0"""


def test_a_lens_for_a_camera(write, tmp_path):
    gauss = Path(__file__).parents[2] / "designs" / "double_gauss.toml"
    (tmp_path / "lens.toml").write_text(gauss.read_text())
    through = BALL.replace('kind = "pinhole"', LENS).replace("field_of_view = 40\n", "")
    camera = load_scene(write(through)).camera
    assert isinstance(camera, LensCamera)
    assert camera.disperses
    assert np.asarray(camera.view.position).tolist() == [0, 1, 5]
    for old, new, words in (
        ('"lens.toml"', '"no.toml"', "camera, lens: file: .*no.toml: cannot be read"),
        ("focus = 5.0", "focus = 0.1", "camera, lens: focus: 0.1 from the film is nearer than this lens can image"),
        (
            "focus = 5.0",
            'focus = "near"',
            "camera, lens: focus must be a distance from the film, inf, or 'as designed'",
        ),
        ("film = 24.0", "film = -1", "camera, lens: film must be positive, got -1"),
        ("film = 24.0", "colour = 1", "camera, lens: colour must be true or false, got 1"),
        ("film = 24.0", 'film = "wide"', "camera, lens: film must be a number, got 'wide'"),
        ("film = 24.0", "absorption = { x = 1.0 }", "camera, lens: absorption must be a table of surfaces"),
    ):
        with pytest.raises(LensTraceError, match=words):
            load_scene(write(through.replace(old, new)))
