"""`lenstrace psf` and `lenstrace mtf`: keys and figures of their JSON, tables, plots, bad input."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from lenstrace.cli import mtf, psf
from lenstrace.errors import ImageError, RayError

# commands print them, as notes
pytestmark = pytest.mark.filterwarnings("ignore::lenstrace.AccuracyWarning")

DESIGNS = Path(__file__).parents[2] / "designs"
HUBBLE, EXPANDER = (str(DESIGNS / f"{name}.toml") for name in ("hubble", "afocal_expander"))


def run(*arguments: str) -> None:
    parser = argparse.ArgumentParser()
    commands = parser.add_subparsers()
    for command in (psf, mtf):
        command.add_parser(commands)
    parsed = parser.parse_args(arguments)
    parsed.run(parsed)


def test_psf(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "psf.png"
    run("psf", HUBBLE, "--samples", "32", "--plot", str(picture))
    text = capsys.readouterr().out
    assert "method fft: rays miss their nodes" in text
    assert "radius of 80%, um" in text
    assert picture.stat().st_size > 10000
    run("psf", HUBBLE, "--samples", "32", "--json")
    found = json.loads(capsys.readouterr().out)
    assert found["points"] == 64
    assert "density" not in found["psf"][0]
    assert_allclose(found["psf"][0]["strehl"], found["psf"][0]["densest_over_perfect"], rtol=1e-3)


def test_mtf(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "mtf.svg"
    options = ("--samples", "32", "--frequencies", "0", "20", "--geometric", "--through-focus", "0.5")
    run("mtf", HUBBLE, *options, "--plot", str(picture))
    text = capsys.readouterr().out
    assert "rays sagittal" in text
    assert "Through focus at 20 cycles/mm" in text
    assert picture.stat().st_size > 10000
    run("mtf", HUBBLE, *options, "--json")
    found = json.loads(capsys.readouterr().out)
    assert found["frequency"] == [0, 20]
    assert found["mtf"][0]["tangential"][0] == 1
    assert_allclose(found["through_focus"]["tangential"][0][10], found["mtf"][0]["tangential"][1], atol=1e-12)


def test_bad_input() -> None:
    for command in ("psf", "mtf"):
        with pytest.raises(ImageError, match="needs an image"):
            run(command, EXPANDER)
    with pytest.raises(RayError, match="must be a positive number"):
        run("mtf", HUBBLE, "--through-focus", "-1")
