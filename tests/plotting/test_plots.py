"""Plots: the axes come back labelled, show what the result says, and files appear whole or not at all."""

from __future__ import annotations

import dataclasses
import functools
import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure

from lenstrace.__main__ import main
from lenstrace.analysis.layout import Layout, layout
from lenstrace.analysis.spot_figures import Spots
from lenstrace.analysis.spots import spots
from lenstrace.errors import LensTraceError
from lenstrace.io.native import load
from lenstrace.plotting.colours import colours
from lenstrace.plotting.files import save_figure
from lenstrace.plotting.layout import field_text, figure_size, layout_figure, plot_layout
from lenstrace.plotting.report import figure_of
from lenstrace.plotting.spots import plot_spots, spots_figure
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

TESSAR = Path(__file__).parents[2] / "designs" / "tessar.toml"


@functools.cache
def tessar() -> tuple[Lens, Layout, Spots]:
    loaded = load(TESSAR)
    return loaded, layout(loaded), spots(loaded)


def test_layout_is_drawn_on_the_axes_given() -> None:
    written, drawn, _ = tessar()
    axes = Figure().add_subplot()
    assert plot_layout(drawn, axes) is axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("z, mm", "y, mm")
    assert axes.get_title() == written.name
    assert axes.get_aspect() == 1
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["0°", "11.3°", "22.6°"]
    assert len(axes.patches) == 4  # elements of a Tessar


def test_legend_stands_beside_the_drawing() -> None:
    figure = layout_figure(tessar()[1])
    figure.draw_without_rendering()
    axes = figure.axes[0]
    legend = axes.get_legend()
    assert legend is not None
    assert legend.get_window_extent().x0 >= axes.get_window_extent().x1
    assert legend.get_window_extent().x1 <= figure.bbox.x1


def test_mirrors_are_hatched_and_negative_glass_has_its_own_tint() -> None:
    mirror = lens(
        [{"radius": -200, "thickness": -100, "mirror": True, "stop": True}],
        {"entrance_pupil_diameter": 20},
        [0],
        [0.55],
    )
    assert len(plot_layout(layout(mirror), Figure().add_subplot()).collections) == 1
    tints = set()
    for index in (-1.0, 1.5):
        rows = [{"thickness": 20, "index": index, "stop": True}, {"thickness": 10}]
        slab = lens(rows, {"entrance_pupil_diameter": 5}, [0], [0.55], object_distance=10)
        tints.add(plot_layout(layout(slab), Figure().add_subplot()).patches[0].get_facecolor())
    assert len(tints) == 2


def test_layout_and_spots_make_their_own_figure_through_pyplot() -> None:
    written, drawn, result = tessar()
    before = len(pyplot.get_fignums())
    plot_layout(drawn)
    assert len(plot_spots(result, written)) == 3
    assert len(pyplot.get_fignums()) == before + 2
    pyplot.close("all")


def test_figures_do_not_touch_pyplot() -> None:
    written, drawn, result = tessar()
    before = pyplot.get_fignums()
    layout_figure(drawn)
    spots_figure(result, written)
    assert len(figure_of(written, drawn, result).axes) == 4
    assert len(figure_of(written, drawn, None).axes) == 1
    assert pyplot.get_fignums() == before


def test_figure_is_as_flat_as_the_drawing() -> None:
    wide, high = figure_size(tessar()[1])
    assert 0.3 < high / wide < 1


def test_spots_have_the_spread_that_the_title_says() -> None:
    written, _, result = tessar()
    panels = Figure().subplots(1, 3)
    drawn = plot_spots(result, written, list(panels))
    assert drawn == tuple(panels)
    assert len({axes.get_xlim() for axes in drawn} | {axes.get_ylim() for axes in drawn}) == 1
    for axes, field in zip(drawn, written.fields.y, strict=True):
        points = np.array([line.get_xydata() for line in axes.lines])
        assert points.shape == (3, 127, 2)
        # all weights are 1: the pooled RMS radius is that of all points together
        rms = np.sqrt(points.reshape(-1, 2).var(axis=0).sum())
        assert axes.get_title().splitlines() == [f"{float(field):g}°", f"RMS {rms:.3g} µm"]
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("x, µm", "y, µm")
        # the first of a hexapolar pattern is the chief ray, the primary wavelength is the second
        assert points[1, 0] == pytest.approx([0, 0], abs=1e-9)
    legend = drawn[-1].get_legend()
    assert legend is not None
    assert len(legend.get_texts()) == 3


def test_spots_without_chief_ray_are_about_their_centroid() -> None:
    written, _, result = tessar()
    lost = np.full_like(np.asarray(result.chief_x), np.nan)
    drawn = plot_spots(dataclasses.replace(result, chief_x=lost, chief_y=lost), written, list(Figure().subplots(1, 3)))
    for axes in drawn:
        points = np.concatenate([line.get_xydata() for line in axes.lines])
        assert points.mean(axis=0) == pytest.approx([0, 0], abs=1e-9)


def test_large_spots_are_in_mm_and_lost_rays_are_not_drawn() -> None:
    rows = [{"radius": 50, "thickness": 5, "index": 1.5, "stop": True, "aperture": {"circle": 3.9}}]
    rows.append({"radius": -50, "thickness": 10})
    written = lens(rows, {"entrance_pupil_diameter": 10}, [0], [0.55])
    (axes,) = plot_spots(spots(written), written, [Figure().add_subplot()])
    points = np.asarray(axes.lines[0].get_xydata())
    # rings 0 to 4 of 6 pass: their radius, 3.33 mm and less, is below 3.9; ring 5 has 4.17 mm
    assert np.isfinite(points[:, 0]).sum() == 1 + 6 + 12 + 18 + 24
    assert axes.get_xlabel() == "x, mm"


def test_field_text_and_colours() -> None:
    assert field_text(0.0, 22.6, "deg") == "22.6°"
    assert field_text(1.0, -2.5, "mm") == "(1, -2.5) mm"
    assert len(set(colours(3))) == 3
    assert len(set(colours(12))) == 12


@pytest.mark.parametrize(("suffix", "begin"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("SVG", b"<?xml")])
def test_file_has_the_format_of_its_suffix(tmp_path: Path, suffix: str, begin: bytes) -> None:
    target = tmp_path / f"picture.{suffix}"
    save_figure(Figure(), target)
    assert target.read_bytes().startswith(begin)
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("name", ["picture.gif", "picture", "absent/picture.png"])
def test_file_that_cannot_be_is_one_clear_line(tmp_path: Path, name: str) -> None:
    with pytest.raises(LensTraceError) as error:
        save_figure(Figure(), tmp_path / name)
    assert "\n" not in str(error.value)
    assert name in str(error.value)
    assert "png, pdf, svg" in str(error.value) or "cannot be written" in str(error.value)
    assert list(tmp_path.iterdir()) == []


def test_half_a_file_never_stands_under_its_name(tmp_path: Path) -> None:
    class Broken(Figure):
        def savefig(self, fname: Path, **_: object) -> None:
            fname.write_bytes(b"half")
            raise OSError(28, "No space left on device")

    target = tmp_path / "picture.png"
    target.write_bytes(b"old")
    with pytest.raises(LensTraceError, match="No space left on device"):
        save_figure(Broken(), target)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_draw_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "tessar.svg"
    assert main(["draw", str(TESSAR), "-o", str(target), "--rays", "3"]) == 0
    assert capsys.readouterr().out == f"wrote {target}: 9 rays of 3 fields\n"
    assert target.read_bytes().startswith(b"<?xml")
    assert main(["draw", str(TESSAR), "-o", str(target), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"file": str(target), "fields": 3, "rays": 15}
    assert main(["draw", str(TESSAR), "-o", str(tmp_path / "tessar.bmp")]) == 2
    assert "png, pdf, svg" in capsys.readouterr().err
