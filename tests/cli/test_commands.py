"""The commands: keys of their JSON, figures in it, bad input with status 2 and one line."""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lenstrace.__main__ import main

ROOT = Path(__file__).parent.parent.parent
GAUSS, TRIPLET, SLAB, TESSAR = (
    str(ROOT / "designs" / f"{name}.toml")
    for name in ("double_gauss", "cooke_triplet", "negative_index_slab", "tessar")
)


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    """The object that a command prints."""
    assert main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_report_keys_and_figures(capsys: pytest.CaptureFixture[str]) -> None:
    report = run(capsys, "report", GAUSS)
    assert list(report) == [
        "name", "primary_um", "wavelengths_um", "first_order", "magnification", "f_number", "entrance_pupil",
        "exit_pupil", "total_track", "newton",
    ]  # fmt: skip
    assert set(report["first_order"][0]) == {
        "wavelength_um", "focal_length", "back_focal_length", "front_focal_length", "front_principal_plane",
        "rear_principal_plane", "front_focal_point", "rear_focal_point", "front_nodal_point", "rear_nodal_point",
        "object_focal_length", "power",
    }  # fmt: skip
    assert (report["magnification"], report["primary_um"]) == (None, 0.5876)
    assert_allclose(report["first_order"][1]["focal_length"], 100.00374787083726, rtol=1e-12)
    assert_allclose(report["first_order"][1]["power"], 1 / 100.00374787083726, rtol=1e-12)
    # the aperture was stated as f/5
    assert_allclose(report["f_number"], 5, rtol=1e-9)
    assert_allclose(report["total_track"], 139.454938, rtol=1e-9)
    newton = report["newton"]
    assert {"kind", "magnification", "x_object", "x_image", "product", "expected", "residual"} <= set(newton[0])
    paraxial = [row for row in newton if row["kind"] == "paraxial"]
    assert len({row["magnification"] for row in paraxial}) >= 5
    assert max(abs(row["residual"]) for row in paraxial) < 1e-12
    for row in paraxial:
        assert_allclose(row["x_object"] * row["x_image"], -(100.00374787083726**2), rtol=1e-12)
    assert all(abs(row["slope"] - 2) < 0.01 for row in newton if row["kind"] == "real")


def test_an_afocal_lens_is_reported_with_nulls(capsys: pytest.CaptureFixture[str]) -> None:
    report = run(capsys, "report", SLAB)
    first = report["first_order"][0]
    assert (first["power"], first["focal_length"], report["f_number"], report["newton"]) == (0, None, None, [])
    assert_allclose(report["magnification"], 1, rtol=1e-14)
    assert main(["report", SLAB]) == 0
    assert "afocal" in capsys.readouterr().out


def test_spots_keys_and_figures(capsys: pytest.CaptureFixture[str]) -> None:
    found = run(capsys, "spots", SLAB)
    assert set(found["spots"][0]) >= {
        "field", "wavelength_um", "rays", "lost", "centroid", "chief", "rms_centroid", "rms_chief", "largest",
    }  # fmt: skip
    assert set(found["polychromatic"][0]) == {"field", "rms_centroid", "rms_primary_chief"}
    assert [spot["rays"] for spot in found["spots"]] == [127, 127]
    # Veselago's slab images perfectly: at most 1e-14 of its thickness
    assert max(spot["largest"] for spot in found["spots"]) < 2e-14
    assert_allclose(found["spots"][1]["centroid"], [0, 0.5], atol=2e-14)


def test_vignetting_of_clipped_spots(capsys: pytest.CaptureFixture[str]) -> None:
    found = run(capsys, "spots", TESSAR, "--clip", "--vignetting", "--rings", "2")
    assert [sorted(field) for field in found["vignetting"]] == [["bottom", "field", "left", "right", "top"]] * 3
    assert_allclose(found["vignetting"][0]["top"], 1, rtol=1e-12)
    assert main(["spots", TESSAR, "--clip", "--vignetting", "--rings", "2"]) == 0
    assert "Pupil that arrives" in capsys.readouterr().out


@pytest.mark.parametrize(("pattern", "count"), [("grid", 49), ("random", 61), ("sobol", 61), ("hexapolar", 61)])
def test_patterns(capsys: pytest.CaptureFixture[str], pattern: str, count: int) -> None:
    found = run(capsys, "spots", SLAB, "--pattern", pattern, "--rings", "4")
    assert found["spots"][0]["rays"] == count


def test_trace_rows(capsys: pytest.CaptureFixture[str]) -> None:
    rows = run(capsys, "trace", TRIPLET, "--field", "0", "--pupil", "0", "1", "--wavelength", "0.55")["surfaces"]
    assert [row["surface"] for row in rows] == list(range(8))
    assert set(rows[0]) == {"surface", "x", "y", "z", "l", "m", "n", "opl", "status"}
    assert (rows[0]["y"], rows[0]["opl"], rows[0]["status"]) == (5, 0, "OK")
    assert_allclose(rows[-1]["y"], -0.004195677081327661, atol=1e-12)
    assert_allclose(rows[-1]["opl"], 64.66817864057856, atol=1e-12)
    # negative numbers and exponents are arguments, not options
    low = run(capsys, "trace", "--field", "-1e1", "--pupil", "0", "-1e-5", "--field-x", "-.5", TRIPLET)["surfaces"]
    assert low[0]["m"] < 0
    # any wavelength the glasses know
    other = run(capsys, "trace", TRIPLET, "--pupil", "0", "1", "--wavelength", "0.65")["surfaces"]
    assert abs(other[-1]["y"] - rows[-1]["y"]) > 1e-4


def test_a_failed_ray_has_no_numbers_behind_its_failure(capsys: pytest.CaptureFixture[str]) -> None:
    rows = run(capsys, "trace", TRIPLET, "--field", "60", "--pupil", "0", "1")["surfaces"]
    failed = next(i for i, row in enumerate(rows) if row["status"] != "OK")
    assert rows[failed]["status"] in ("MISSED", "TIR")
    assert all(row["y"] is None and row["opl"] is None for row in rows[failed + 1 :])
    assert all(np.isfinite(row["y"]) for row in rows[:failed])
    assert main(["trace", TRIPLET, "--field", "60", "--pupil", "0", "1"]) == 0
    assert rows[failed]["status"] in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["report", "nothing.toml"], "nothing.toml: cannot be read"),
        (["spots", "{afocal}"], "at infinity"),
        (["spots", "{lost}"], "all 127 rays are lost"),
        (["trace", "{good}", "--wavelength", "550"], "write 0.55"),
        (["trace", "{good}", "--field", "nan"], "finite"),
        (["spots", "{good}", "--rings", "0"], "rings must be at least 1"),
        (["draw", "{good}", "-o", "lens.xyz"], "png, pdf"),
    ],
)
def test_bad_input_is_one_line_and_status_2(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    good = (
        "aperture = { entrance_pupil_diameter = 10 }\nfields = { y = [0, 5] }\nwavelengths = { um = [0.55] }\n"
        '[lens]\nsurfaces = [{ radius = 50, thickness = 5, glass = "N-BK7", stop = true }, '
        "{ radius = -50, thickness = 45 }]\n"
    )
    files = {
        "{good}": good,
        "{afocal}": good.replace("radius = 50, ", "").replace("radius = -50, ", ""),
        "{lost}": good.replace("thickness = 45", "thickness = 45, aperture = { obscuration = 30 }"),
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    assert main(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert words in printed.err
    assert {path.name for path in tmp_path.iterdir()} == set(files)


def test_unusable_arguments_end_with_status_2(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["trace", TRIPLET, "--pupil", "1"])
    assert ended.value.code == 2
    assert "pupil" in capsys.readouterr().err
