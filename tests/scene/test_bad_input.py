"""What is no scene, no camera or no question is refused in one clear line before anything is rendered."""

from __future__ import annotations

import math
import re
import textwrap
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lenstrace
from lenstrace import LensTraceError
from lenstrace.io import scene as scene_file
from lenstrace.scene import (
    BlinnPhong,
    Diffuse,
    Disk,
    Object,
    Pinhole,
    PointLight,
    Rectangle,
    Scene,
    Sphere,
    ThinLens,
    Torus,
    View,
    implicit,
)

VIEW = View((0, 0, 5), (0, 0, 0))
GREY = Diffuse(0.5)
# the example of a file in its documentation
EXAMPLE = textwrap.dedent(re.search(r'    name = "A ball.*?(?=\n\n)', scene_file.__doc__ or "", re.DOTALL)[0])  # type: ignore[index]


def drawn(*objects: Object, camera: Any = None, **more: Any) -> Any:
    scene = Scene(list(objects) or [Object(Sphere(1), GREY)], [PointLight((2, 2, 2), 1.0)])
    return lenstrace.render(scene, camera or Pinhole(VIEW, 40), **({"size": (4, 4), "samples": 1} | more))


@pytest.mark.parametrize(
    ("camera", "message"),
    [
        (Pinhole(View((0, 0, 5), (0, 0, 5)), 40), "view target must be another point than position"),
        (Pinhole(View((0, 0, 5), (0, 0, 0), (0, 0, 1)), 40), "up must not point along the axis"),
        (Pinhole(VIEW, 200), "field_of_view must be between 0 and 180 degrees, got 200"),
        (ThinLens(VIEW, 0.05, 2.0, 0.05, 0.03), "focus must be farther than the focal length, 0.05, got 0.05"),
    ],
)
def test_cameras_that_see_nothing(camera: Any, message: str) -> None:
    with pytest.raises(LensTraceError, match=message):
        drawn(camera=camera)


@pytest.mark.parametrize(
    ("item", "message"),
    [
        (Object(Rectangle(math.inf, math.inf), GREY, emission=1.0), "emission needs a shape with an end"),
        (Object(Disk(0.5, 1.0), GREY), "object 1: shape: Disk: hole must be less than the radius, 0.5, got 1"),
        (Object(Torus(0.2, 0.5), GREY), "Torus: minor must be less than the major radius, 0.2, got 0.5"),
        (Object(Sphere(1), BlinnPhong(1.0, 1.0)), "diffuse and specular must be at most 1 together, got 2"),
        (Object(implicit("x^2 + y^2 + z^2 - 0.25", 1.0, bending=0.5), GREY), "bending 0.5 is too small: near"),
    ],
)
def test_objects_that_cannot_be(item: Object, message: str) -> None:
    with pytest.raises(LensTraceError, match=message):
        drawn(item)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"size": 256}, "size must be two numbers, width and height in pixels, got 256"),
        ({"size": (16.5, 16)}, "size must be a whole number, at least 1, got 16.5"),
        ({"samples": 1.5}, "samples must be a whole number, at least 1, got 1.5"),
        ({"depth": 0}, "depth must be a whole number, at least 1, got 0"),
        ({"noise": "little"}, "noise must be a number, got 'little'"),
    ],
)
def test_questions_that_cannot_be_asked(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(LensTraceError, match=message):
        drawn(**asked)


def test_a_flat_formula_and_any_whole_number_are_fine() -> None:
    item = Object(implicit("x + y / 3 + z - 0.25", 1.0), GREY)
    pictures = [drawn(item, key=key, method="cast").radiance for key in (3, np.int64(3))]
    np.testing.assert_array_equal(*pictures)


def test_the_example_of_a_file_is_one(tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    path.write_text(EXAMPLE)
    assert scene_file.load_scene(path).settings.samples == 64


@pytest.mark.parametrize(
    ("line", "other", "message"),
    [
        ("samples = 64", 'samples = "many"', "render: samples must be a whole number, at least 1, got 'many'"),
        ("samples = 64", "size = 256", "render: size must be two numbers"),
        ("samples = 64", 'exposure = "bright"', "render: exposure must be a number, got 'bright'"),
        ('method = "path"', "method = 5", "render: method must be text in quotes, got 5"),
        ('name = "A ball on a floor"', "name = 5", "name must be text in quotes, got 5"),
        ("[[lights]]", "[environment]\nmap = 5\n[[lights]]", "environment: map must be text in quotes, got 5"),
    ],
)
def test_a_file_says_which_line(line: str, other: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    path.write_text(EXAMPLE.replace(line, other))
    with pytest.raises(LensTraceError, match=f"ball.toml: {message}"):
        scene_file.load_scene(path)
