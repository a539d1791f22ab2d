"""`lenstrace fans` and `lenstrace wavefront`: keys and figures of their JSON, tables, plots, bad input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

import lenstrace
from lenstrace.__main__ import main
from lenstrace.analysis.fans import fans
from lenstrace.analysis.wavefront import wavefront
from lenstrace.plotting.fans import fan_axes, plot_fans
from lenstrace.plotting.wavefront import plot_wavefront, pupil_maps, wavefront_axes

DESIGNS = Path(__file__).parents[2] / "designs"
GAUSS, HUBBLE, EXPANDER = (str(DESIGNS / f"{name}.toml") for name in ("double_gauss", "hubble", "afocal_expander"))


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    """The object that a command prints."""
    assert main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(arguments) == 0
    return capsys.readouterr().out


def test_fans_of_the_double_gauss(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    found = run(capsys, "fans", GAUSS, "--points", "5")
    assert list(found) == ["reference", "unit", "pupil", "fans"]
    assert (found["reference"], found["unit"], found["pupil"]) == ("primary", "mm", [-1, -0.5, 0, 0.5, 1])
    assert len(found["fans"]) == 9
    # Optiland 0.6.3: RayFan and Wavefront at 14 degrees, 0.5876 um
    fan = next(each for each in found["fans"] if each["field"] == [0, 14] and each["wavelength_um"] == 0.5876)
    assert_allclose(fan["tangential"]["y"][0], 0.04394651556265927, atol=1e-12)
    assert_allclose(fan["sagittal"]["x"][-1], -0.06121762857226276, atol=1e-12)
    picture = tmp_path / "fans.png"
    text = printed(capsys, "fans", GAUSS, "--points", "5", "--plot", str(picture))
    assert "ey, µm" in text
    assert "43.946516" in text
    assert picture.stat().st_size > 10000


def test_fans_of_an_afocal_lens_are_angles(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "fans", EXPANDER, "--points", "5")["unit"] == "rad"
    assert "µrad" in printed(capsys, "fans", EXPANDER, "--points", "5")


def test_obscured_rays_are_null(capsys: pytest.CaptureFixture[str]) -> None:
    found = run(capsys, "fans", HUBBLE, "--points", "5")
    assert found["fans"][0]["tangential"]["opd"][2] is None
    assert "lost: 3 tangential and 3 sagittal rays of 15 each" in printed(capsys, "fans", HUBBLE, "--points", "5")


def test_wavefront_of_the_double_gauss(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    found = run(capsys, "wavefront", GAUSS, "--samples", "33", "--zernike", "noll", "--terms", "11")
    assert list(found) == ["reference", "notes", "zernike_order", "terms", "wavefronts"]
    assert found["terms"][3] == {"number": 4, "n": 2, "m": 0, "name": "defocus"}
    assert len(found["wavefronts"]) == 9
    on_axis = found["wavefronts"][1]
    assert set(on_axis) == {
        "field", "wavelength_um", "rms", "rms_without_tilt", "rms_without_focus", "peak_to_valley", "strehl_from_rms",
        "strehl", "zernike", "zernike_residual",
    }  # fmt: skip
    # Optiland 0.6.3: the rim of the pupil is 0.7897 waves ahead
    assert_allclose(on_axis["peak_to_valley"], 0.7897360559076806, atol=1e-9)
    # the terms of Noll are orthonormal: what they leave of the mean square is the residual's
    squares = np.square(on_axis["zernike"][1:]).sum() + on_axis["zernike_residual"] ** 2
    assert_allclose(np.sqrt(squares), on_axis["rms"], rtol=0.02)
    picture = tmp_path / "wavefront.svg"
    text = printed(
        capsys, "wavefront", GAUSS, "--samples", "33", "--zernike", "noll", "--terms", "11", "--plot", str(picture)
    )
    assert "primary astigmatism 0 deg" in text
    assert "0.789736" in text
    assert "Strehl: path differences step by up to" in text
    assert picture.stat().st_size > 10000


def test_too_many_terms_are_said_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["wavefront", GAUSS, "--samples", "33", "--terms", "38"]) == 2
    assert "1 to 37" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["fans", GAUSS, "--points", "6"], "odd whole number"),
        (["wavefront", GAUSS, "--samples", "4"], "samples across the pupil"),
        (["fans", GAUSS, "--points", "5", "--plot", "fans.bmp"], "the suffix must be"),
    ],
)
def test_bad_input(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


def test_plots_come_back_on_the_axes_given() -> None:
    lens = lenstrace.load(GAUSS)
    result, front = fans(lens, points=5), wavefront(lens, samples=33)
    panels = fan_axes(Figure(), 3)
    assert plot_fans(result, lens, panels) == tuple(panels)
    assert [(p.get_xlabel(), p.get_ylabel()) for p in panels[4:8]] == [
        ("py", "ey, µm"),
        ("px", "ex, µm"),
        ("py", "OPD, waves"),
        ("px", "OPD, waves"),
    ]
    assert_allclose(np.asarray(panels[8].lines[1].get_ydata()), np.asarray(result.tangential.y)[2, 1] * 1000)
    assert_allclose(np.asarray(panels[11].lines[0].get_ydata()), np.asarray(result.sagittal.opd)[2, 0])
    maps = wavefront_axes(Figure(), 3)
    assert plot_wavefront(front, lens, maps) == tuple(maps)
    assert (maps[1].get_xlabel(), maps[1].get_ylabel()) == ("px", "py")
    assert "RMS 0.236, P-V 0.79 waves" in maps[0].get_title()


def test_the_map_stands_upright() -> None:
    # more coma at the top or bottom than left and right: a lens is symmetrical in x, not in y
    maps = pupil_maps(wavefront(lenstrace.load(GAUSS), samples=33))[2, 1]
    assert_allclose(maps, maps[:, ::-1], atol=1e-9)
    assert np.nanmax(np.abs(maps - maps[::-1])) > 0.1
    found = fans(lenstrace.load(GAUSS), points=5, reference="chief")
    # rows 8 and 24 of 33 stand at y = -1/2 and 1/2
    assert_allclose(maps[[8, 24], 16], np.asarray(found.tangential.opd)[2, 1, [1, 3]], atol=1e-9)
