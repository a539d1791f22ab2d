"""`lenstrace seidel`: keys and figures of its JSON, what it says of tilts and of an image at infinity."""

import argparse
import json
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from lenstrace.cli import seidel

ROOT = Path(__file__).parent.parent.parent
FIVE = ("spherical", "coma", "astigmatism", "petzval", "distortion")


def run(name: str, *options: str) -> None:
    """The command, on one of the designs."""
    parser = argparse.ArgumentParser()
    seidel.add_parser(parser.add_subparsers())
    arguments = parser.parse_args(["seidel", str(ROOT / "designs" / f"{name}.toml"), *options])
    arguments.run(arguments)


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    run("cemented_doublet", "--json")
    found = json.loads(capsys.readouterr().out)
    assert list(found) == [
        "name", "primary_um", "colour_um", "field", "surfaces", "total", "transverse", "longitudinal", "waves",
        "lagrange_invariant", "petzval_radius",
    ]  # fmt: skip
    expected = json.loads((ROOT / "tests" / "figures" / "seidel.json").read_text())["lenses"]["cemented_doublet"]
    symbols = ["S_I", "S_II", "S_III", "S_IV", "S_V"]
    assert_allclose([found["total"][symbol] for symbol in symbols], [expected[name] for name in FIVE], rtol=1e-11)
    assert_allclose(found["waves"]["W040"], expected["spherical"] / 8 / 0.5876e-3, rtol=1e-11)
    assert_allclose([found["field"], *found["colour_um"]], [2, 0.4861, 0.6563], rtol=1e-14)
    for surface in found["surfaces"]:
        parts = [surface[part]["S_I"] for part in ("spherical_part", "aspheric_part")]
        assert_allclose(sum(parts), surface["S_I"], rtol=1e-14)
    assert_allclose(sum(surface["C_II"] for surface in found["surfaces"]), found["total"]["C_II"], rtol=1e-9)


def test_text_and_plot(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "doublet.svg"
    run("fold_mirror", "--field", "1", "--plot", str(picture))
    printed = capsys.readouterr().out
    assert "full aperture, field 1 deg; colour from 0.4861 to 0.6563 um" in printed
    assert "Tilts and decentres do not count" in printed
    assert "0.007084442" in printed  # S_I of the unfolded doublet
    assert picture.exists()
    run("afocal_expander")
    assert "image is at infinity" in capsys.readouterr().out
