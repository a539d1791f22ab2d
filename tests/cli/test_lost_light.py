"""Commands where no ray arrives, or none of some fields; and the limits of what may be asked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from lenstrace.__main__ import main

TRIPLET = str(Path(__file__).parents[2] / "designs" / "cooke_triplet.toml")
# A stop in front, a lens 20 mm behind: the light of 17 degrees passes the lens 6 mm above its vertex.
SINGLET = """
[aperture]
entrance_pupil_diameter = 2.0
[fields]
kind = "angle"
y = [0.0, 17.0]
[wavelengths]
um = [0.55]
[lens]
surfaces = [
  {{ thickness = 20.0, stop = true }},
  {{ radius = 50.0, thickness = 3.0, index = 1.5, aperture = {{ {aperture} }} }},
  {{ radius = -50.0, thickness = 48.0 }},
]
"""
COARSE = {"psf": ["--samples", "16"], "mtf": ["--samples", "16"], "wavefront": ["--samples", "9", "--terms", "4"]}


def designed(folder: Path, aperture: str) -> str:
    path = folder / "singlet.toml"
    path.write_text(SINGLET.format(aperture=aperture))
    return str(path)


@pytest.mark.parametrize("command", ["spots", "focus", "fans", "wavefront", "mtf", "psf", "sheet"])
def test_no_light_at_all(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    option = "-o" if command == "sheet" else "--plot"
    design = designed(tmp_path, "obscuration = 100.0")
    assert main([command, design, *COARSE.get(command, []), option, str(tmp_path / "a.png")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "rays are lost" in err or "rays of all fields are lost" in err


@pytest.mark.parametrize("command", ["mtf", "psf"])
def test_the_chief_ray_alone_is_no_light(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, designed(tmp_path, "circle = 1e-6"), *COARSE[command]]) == 2
    assert "rays of all fields are lost" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["fans", "wavefront", "mtf", "psf"])
def test_fields_without_light_are_left_out(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "a.svg"
    design = designed(tmp_path, "circle = 3.0")
    assert main([command, design, *COARSE.get(command, []), "--plot", str(picture)]) == 0
    out = capsys.readouterr().out
    rows = [line.split() for line in out.splitlines() if line.split()[:1] == ["17"]]
    assert rows
    assert all("-" in row for row in rows)
    assert "nan" not in out
    assert "nan" not in picture.read_text()


def test_semi_diameters_stop_rays_where_asked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "small.toml"
    path.write_text(SINGLET.replace("aperture = {{ {aperture} }}", "semi_diameter = 3.0").format())
    for command in ("fans", "wavefront", "mtf", "psf"):
        assert main([command, str(path), *COARSE.get(command, []), "--clip"]) == 0
        rows = [line.split() for line in capsys.readouterr().out.splitlines() if line.split()[:1] == ["17"]]
        assert all("-" in row for row in rows)
    assert main(["focus", str(path), "--clip"]) == 2
    assert "all 127 rays are lost" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["field", "--points", "1000000"], "at most 10001, got 1000000"),
        (["fans", "--points", "1000001"], "at most 10001, got 1000001"),
        (["focus", "--steps", "100000"], "from 2 to 1001, got 100000"),
        (["focus", "--steps", "100000", "--range", "1"], "from 2 to 1001, got 100000"),
    ],
)
def test_sizes_have_limits(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([arguments[0], TRIPLET, *arguments[1:]]) == 2
    assert words in capsys.readouterr().err
