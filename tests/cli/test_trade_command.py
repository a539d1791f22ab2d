"""`lenstrace trade` and `lenstrace spots --tolerance`: keys of their JSON, tables, plots, bad input."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from lenstrace.__main__ import main
from lenstrace.analysis.extremes.cases import cases
from lenstrace.analysis.extremes.judging import judged
from lenstrace.cli import trade

DESIGNS = Path(__file__).parents[2] / "designs"
GAUSS, MENISCUS, HUBBLE = (str(DESIGNS / f"{name}.toml") for name in ("double_gauss", "thick_meniscus", "hubble"))
KEYS = {"setting", "value", "error", "relative_error", "seconds", "first_seconds", "rays", "pareto"}


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["trade", GAUSS, "--quantity", "chief_height", "--field", "10", "--tolerance", "1e-9", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["quantity"], found["field"], found["unit"]) == ("chief_height", 10.0, "mm")
    assert found["truth"] == pytest.approx(17.5456642377865, abs=1e-12)
    assert set(found["settings"][0]) == set(found["chosen"]) == KEYS
    assert found["chosen"]["setting"] == "exact, float64"
    assert found["chosen"]["rays"] == 1
    assert any(each["pareto"] for each in found["settings"])


def test_no_setting_is_accurate_enough(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "trade.svg"
    assert main(["trade", MENISCUS, "--quantity", "focal_length", "--tolerance", "1e-30", "--plot", str(picture)]) == 0
    text = capsys.readouterr().out
    assert "derivative of the exact trace, float64" in text
    assert "truth: " in text
    assert picture.stat().st_size > 10000


def test_extremes(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    first = judged(next(case for case in cases() if case.name == "a ray through every vertex"))
    monkeypatch.setattr(trade, "extremes", lambda progress: progress(1, 1, "") or (first,))
    assert main(["trade", "--extremes"]) == 0
    assert "a ray through every vertex" in capsys.readouterr().out
    assert main(["trade", "--extremes", "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["extremes"]
    assert found["float32"]["statuses"] is True
    assert found["float64"]["course"] < 16
    assert found["float64"]["gradients"] == 2
    assert found["float64"]["gradient"] < 64


def test_spots_within_a_tolerance(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["spots", HUBBLE, "--tolerance", "1e-3"]) == 0
    text = capsys.readouterr().out
    assert "two gaussian rules of" in text
    assert "tolerance 0.001: reached by every spot" in text
    assert main(["spots", HUBBLE, "--tolerance", "1e-3", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["accuracy"]["reached"] is True
    assert 0 < found["spots"][2]["rms_centroid_error"] < 1e-3 * found["spots"][2]["rms_centroid"]
    # the shadow of the secondary mirror: 1 - 0.33^2
    assert found["spots"][0]["open"] == pytest.approx(0.8911, abs=1e-9)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["trade"], "trade needs a DESIGN"),
        (["trade", GAUSS, "--extremes"], "leave out design"),
        (["trade", "--extremes", "--quantity", "opd"], "leave out quantity"),
        (["trade", GAUSS, "--quantity", "focal_length", "--field", "7"], "a focal length has no field"),
        (["trade", GAUSS, "--plot", "/nowhere/trade.png"], "/nowhere is not a folder that can be written to"),
        (["trade", GAUSS, "--plot", "trade.gif"], "the suffix must be one of png, pdf, svg, got '.gif'"),
        (["trade", GAUSS, "--quantity", "chief_height", "--tolerance", "0"], "tolerance must be a positive number"),
        (["spots", GAUSS, "--tolerance", "1e-3", "--rings", "3"], "--tolerance chooses the rays by itself"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    printed = capsys.readouterr()
    assert message in printed.err
    assert printed.err.count("\n") == 1
    assert not printed.out
