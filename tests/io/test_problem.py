"""The section [optimize]: read, refused where it is wrong, and kept by what is written."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

import lenstrace
from lenstrace import DesignError, PrescriptionError
from lenstrace.design import Curvature, FocalLength, Pickup, RayHeight, SpotRMS, Thickness
from lenstrace.io.problem import WANTS, load_problem, save_problem

LENS = """
[aperture]
entrance_pupil_diameter = 10.0
[fields]
y = [0.0, 5.0]
[wavelengths]
um = [0.5876]
[lens]
surfaces = [ { radius = 60.0, thickness = 4.0, index = 1.5, stop = true }, { radius = -60.0, thickness = 58.0 } ]
"""
SECTION = """
[optimize]
vary = [ { kind = "curvature", surfaces = 1 }, { kind = "thickness", surfaces = "last", bounds = [40.0, 70.0] } ]
want = [
  { kind = "spot_rms", rings = 3, polychromatic = true, field_weights = [1, 2] },
  { kind = "focal_length", target = 60.0, weight = 2.0 },
  { kind = "ray_height", target = 5.0, field = 5.0, pupil = [0.0, 0.5], axis = "y" },
]
tie = [ { kind = "pickup", what = "curvature", surface = 2, of = 1, scale = -1.0 } ]
"""
VARY = "[optimize]\nvary = [{ %s }]\n"
WANT = "[optimize]\nvary = [{ kind = 'curvature' }]\nwant = [{ %s }]\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "lens.toml"
    path.write_text(LENS + SECTION)
    return path


def test_what_is_read(file: Path) -> None:
    problem = load_problem(file)
    assert problem.vary == [Curvature(1), Thickness("last", bounds=[40.0, 70.0])]  # type: ignore[arg-type]
    spot, length, height = problem.want
    assert isinstance(spot, SpotRMS)
    assert (spot.rings, spot.polychromatic, spot.field_weights) == (3, True, [1, 2])
    assert isinstance(length, FocalLength)
    assert (length.target, length.weight) == (60.0, 2.0)
    assert isinstance(height, RayHeight)
    assert (height.pupil, height.axis) == ((0.0, 0.5), "y")
    (tie,) = problem.tie
    assert isinstance(tie, Pickup)
    assert (tie.what, tie.surface, tie.of, tie.scale) == ("curvature", 2, 1, -1.0)
    assert lenstrace.load(file)[1].radius == 60.0  # other commands read it too


def test_what_is_written_can_be_optimized_again(file: Path, tmp_path: Path) -> None:
    problem = load_problem(file)
    better = tmp_path / "better.toml"
    save_problem(problem.lens.replace(surface=1, radius=61.0), file, better)
    again = load_problem(better)
    assert again.lens[1].radius == 61.0
    assert again.vary == problem.vary
    assert [dataclasses.asdict(want) for want in again.want] == [dataclasses.asdict(want) for want in problem.want]


def test_every_want_has_a_kind_of_its_own() -> None:
    assert len(WANTS) == len({kind.__name__ for kind in WANTS}) == 20


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("", "the file has no section [optimize]"),
        ("[optimize]\nwants = []", "optimize: unknown key 'wants'; did you mean 'want'?"),
        ("[optimize]\nvary = 3", "optimize: vary must be a list of tables"),
        (VARY % "surfaces = 1", "optimize: vary 1: kind must be one of curvature"),
        (VARY % 'kind = "curvatur"', "kind must be one of curvature, thickness"),
        (VARY % 'kind = "curvature", surface = 1', "vary 1, curvature: unknown key 'surface'; did you mean"),
        (VARY % 'kind = "thickness"', "vary 1, thickness: surfaces is missing"),
        (VARY % 'kind = "curvature", surfaces = 1.5', "surfaces must be a surface, or several, got 1.5"),
        (VARY % 'kind = "curvature", bounds = "wide"', "bounds must be a number, or a list of them"),
        (VARY % "" + "want = [{ kind = 'spot_rms' }]", "optimize: vary 1: kind must be one of"),
        (WANT % 'kind = "spot_rms", weight = "big"', "weight must be a number"),
        (WANT % 'kind = "spot_rms", rings = 2.5', "rings must be a whole number"),
        (WANT % 'kind = "spot_rms", about = 3', "about must be a word, got 3"),
        (WANT % 'kind = "distortion", f_theta = 1', "f_theta must be true or false"),
        (WANT % 'kind = "spot_rms", points = 1', "unknown key 'points'"),
    ],
)
def test_what_is_refused(tmp_path: Path, section: str, said: str) -> None:
    path = tmp_path / "lens.toml"
    path.write_text(LENS + section)
    with pytest.raises(DesignError) as caught:
        load_problem(path)
    assert said in str(caught.value)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_other_units_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "lens.toml"
    path.write_text('units = "cm"\n' + LENS + SECTION)
    with pytest.raises(DesignError, match="optimize: its lengths are in mm"):
        load_problem(path)
    with pytest.raises(PrescriptionError, match="cannot be read"):
        load_problem(tmp_path / "nothing.toml")
