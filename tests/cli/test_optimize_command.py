"""`lenstrace optimize` and `lenstrace sensitivity`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import lenstrace
from lenstrace.__main__ import main
from lenstrace.design import search

DESIGN = str(Path(__file__).parents[2] / "designs" / "triplet_to_optimize.toml")


def test_the_better_lens_is_written_and_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, picture = tmp_path / "better.toml", tmp_path / "course.png"
    assert main(["optimize", DESIGN, "-o", str(out), "--plot", str(picture)]) == 0
    printed = capsys.readouterr().out
    assert "RMS spot, field 14 deg, 0.55 um, mm" in printed
    assert "thickness 4, mm" in printed
    assert "a minimum; " in printed
    assert picture.stat().st_size > 10_000
    assert float(lenstrace.first_order(lenstrace.load(out)).focal_length[1]) == pytest.approx(49.9998, abs=1e-3)
    assert main(["report", str(out)]) == 0
    assert main(["optimize", str(out)]) == 0
    assert "not improved" in capsys.readouterr().out


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["optimize", DESIGN, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["merit_after"] == pytest.approx(1.3868265e-3, rel=1e-6)
    assert found["steps"] > 5
    assert found["seconds"] > 0
    assert len(found["wants"]) == 10
    assert {"want", "target", "before", "after"} <= set(found["wants"][0])
    assert sum(want["merit_before"] for want in found["wants"]) == pytest.approx(found["merit_before"])
    assert found["wants"][-1]["target"] == pytest.approx(49.99978)


def test_many_starts(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["optimize", DESIGN, "--starts", "4", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["ended"] == found["starts"] == 4
    assert found["minima"] == sorted(found["minima"])
    assert found["merit_after"] == found["minima"][0]


def test_ctrl_c_writes_the_best_so_far(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    once = search._Record._once

    def interrupted(self: search._Record, *arguments: object) -> object:
        if len(self.steps) == 6:
            raise KeyboardInterrupt
        return once(self, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(search._Record, "_once", interrupted)
    out = tmp_path / "better.toml"
    assert main(["optimize", DESIGN, "-o", str(out)]) == 130
    assert "stopped: interrupted; the best lens so far" in capsys.readouterr().out
    assert lenstrace.load(out)[1].radius != lenstrace.load(DESIGN)[1].radius


def test_mistakes_are_a_line_and_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain = str(Path(DESIGN).with_name("tessar.toml"))
    out = tmp_path / "better.toml"
    for arguments, said in (
        (["optimize", plain, "-o", str(out)], "the file has no section [optimize]"),
        (["optimize", DESIGN, "-o", str(tmp_path / "no" / "better.toml")], "cannot be written"),
        (["optimize", DESIGN, "--plot", "course.bmp"], "the suffix must be one of png, pdf, svg"),
        (["optimize", DESIGN, "--seconds", "0", "-o", str(out)], "seconds must be positive"),
        (["optimize", DESIGN, "--starts", "0", "-o", str(out)], "starts must be at least 1"),
        (["sensitivity", DESIGN, "--tilt", "-1"], "tolerance tilt must be a number, 0 or more"),
    ):
        assert main(arguments) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.count("\n") == 1
    assert not out.exists()


def test_sensitivity(capsys: pytest.CaptureFixture[str]) -> None:
    tessar = str(Path(DESIGN).with_name("tessar.toml"))
    assert main(["sensitivity", tessar]) == 0
    printed = capsys.readouterr().out
    assert "refocused for each error" in printed
    assert "decenter y of 4" in printed
    assert main(["sensitivity", tessar, "--json", "--no-refocus", "--decenter", "0"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["refocused"] is False
    assert not any("decenter" in row["name"] for row in found["rows"])
    assert {"name", "tolerance", "unit", "focal_length", "spots"} <= set(found["rows"][0])
