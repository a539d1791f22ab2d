"""Focus: closed forms, the image surface actually moved; spot curves against spots of other lenses."""

import argparse
import json
from pathlib import Path

import jax
import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Fields, Lens, Wavelengths
from lenstrace.analysis.focus import best_focus, through_focus
from lenstrace.analysis.spot_curves import spot_field, spot_spectrum
from lenstrace.cli import focus as command
from lenstrace.plotting.focus import plot_through_focus
from lenstrace.plotting.spot_curves import plot_spot_field, plot_spot_spectrum

# the annulus stops the ray in the centre; with other radii more, by the same compiled program
SINGLET = [
    {"radius": 60.0, "thickness": 6.0, "glass": "N-BK7", "stop": True, "aperture": {"annulus": [1e-3, 9.0]}},
    {"radius": -60.0, "thickness": 57.0},
]


def singlet(*annulus: float) -> Lens:
    first = SINGLET[0] | ({"aperture": {"annulus": list(annulus)}} if annulus else {})
    waves = {"um": [0.48, 0.55, 0.65], "weights": [1, 2, 1]}
    return lenstrace.lens([first, SINGLET[1]], {"entrance_pupil_diameter": 12.0}, [0.0, 5.0], waves)


def moved(lens: Lens, shift: float) -> Lens:
    """The image surface itself moved."""
    return lens.replace(surface=len(lens), thickness=lens[len(lens)].thickness + shift)


def test_an_ellipsoid_out_of_focus() -> None:
    # all rays from one focus of an ellipsoid of revolution, p before the mirror, meet in the other, q before it; one
    # that leaves at an angle t meets the mirror after r, r + |P - F2| = p + q
    p, q, radius = 300.0, 150.0, 30.0
    row = {"radius": -2 * p * q / (p + q), "conic": -(((p - q) / (p + q)) ** 2), "mirror": True, "thickness": -q}
    lens = lenstrace.lens(
        [row | {"stop": True}],
        {"entrance_pupil_diameter": 2 * radius},
        {"kind": "object_height", "y": [0.0]},
        [0.5],
        object_distance=p,
    )
    k = np.arange(1, 7)
    t = np.arctan(radius * k / 6 / p)
    r = 2 * p * q / (p + q - (p - q) * np.cos(t))
    slope = r * np.sin(t) / (q - p + r * np.cos(t))
    square = (6 * k * slope**2).sum() / 127
    shifts = np.array([-0.3, 0.02, 1.0])
    through = through_focus(lens, shifts)
    assert_allclose(through.rms, np.abs(shifts) * np.sqrt(square), rtol=1e-12)
    assert_allclose(through.spots.rms_centroid[:, 0, 0], np.abs(shifts) * np.sqrt(square), rtol=1e-12)
    best = best_focus(moved(lens, 0.7))
    for shift in (best.spot.shift, best.paraxial.shift, best.field_shift[0]):
        assert_allclose(shift, -0.7, atol=1e-12)
    assert_allclose(best.given.rms, 0.7 * np.sqrt(square), rtol=1e-12)
    assert float(best.spot.rms) < 1e-13
    # the depth of focus alone: 1.5 lambda / (4 A) = 0.0089 mm, rounded up
    assert 0.008 < 1.5 * 0.5e-3 / (4 * square) < 0.009
    assert_allclose(through_focus(lens, steps=3).shifts, [-0.009, 0.0, 0.009], rtol=1e-12)


def test_shifts_are_those_of_the_image_surface() -> None:
    lens, shifts = singlet(), np.linspace(-0.4, 0.6, 21)
    through = through_focus(lens, shifts)
    for k in (0, 8, 20):
        there = lenstrace.spots(moved(lens, float(shifts[k])))
        assert_allclose(through.spots.x[k], there.x, atol=1e-12)
        assert_allclose(through.spots.y[k], there.y, atol=1e-12)
        assert_allclose(through.at(k).polychromatic.rms_centroid, there.polychromatic.rms_centroid, atol=1e-12)
        expected = np.sqrt((np.asarray(there.polychromatic.rms_centroid) ** 2).mean())
        assert_allclose(through.rms[k], expected, atol=1e-12)


@pytest.mark.parametrize("annulus", [(), (1.0, 4.1)])
def test_the_least_spots_by_moving_the_image_surface(annulus: tuple[float, ...]) -> None:
    lens = singlet(*annulus)
    best = best_focus(lens)

    def squares(shift: float) -> np.ndarray:
        each = np.asarray(lenstrace.spots(moved(lens, shift)).polychromatic.rms_centroid) ** 2
        return np.append(each, each.mean())

    # the parabola through three places of the image surface
    before, here, behind = (squares(shift) for shift in (-1.0, 0.0, 1.0))
    vertex = (before - behind) / (2 * (before - 2 * here + behind))
    assert_allclose(np.append(best.field_shift, best.spot.shift), vertex, atol=1e-11)
    for f, shift in enumerate(np.asarray(best.field_shift)):
        assert_allclose(best.field_rms[f], np.sqrt(squares(float(shift))[f]), atol=1e-12)
    at_best = squares(float(best.spot.shift))
    assert_allclose(np.append(best.spot.field_rms, best.spot.rms), np.sqrt(at_best), atol=1e-12)
    for near in (-1e-3, 1e-3):
        assert squares(float(best.spot.shift) + near)[2] > at_best[2]
    # default shifts reach beyond the best focus
    assert through_focus(lens).shifts[-1] > abs(best.spot.shift)


def test_the_best_focus_of_a_double_gauss(designs: dict[str, Lens]) -> None:
    # Optiland 0.6.3, spots of its sample DoubleGauss with the image surface moved by -1, 0, 1 mm: of each field the
    # vertex of the parabola through the three mean squares, of 6 hexapolar rings and all wavelengths
    best = best_focus(designs["double_gauss"])
    assert_allclose(best.field_shift, [-0.1290085606281, -0.3087171254141, -0.4904786677433], atol=1e-12)
    assert_allclose(best.spot.shift, -0.3100919638944, atol=1e-12)
    assert_allclose(best.given.field_rms, [0.0113169753874, 0.0246605105507, 0.0384055315671], atol=1e-12)
    # as published, less the thickness
    assert_allclose(best.paraxial.shift, 61.487546239192355 - 61.487536, atol=1e-12)


def test_paraxial_focus() -> None:
    # the thick lens at the primary wavelength: 1/f = (n - 1)(1/R1 - 1/R2 + (n - 1) d / (n R1 R2))
    n, d, r = float(lenstrace.glass("N-BK7").index(0.55)), 6.0, 60.0
    f = 1 / ((n - 1) * (2 / r - (n - 1) * d / (n * r * r)))
    assert_allclose(best_focus(singlet()).paraxial.shift, f * (1 - (n - 1) * d / (n * r)) - 57.0, atol=1e-12)


def test_a_curved_image_counts_as_its_tangent_planes() -> None:
    lens = singlet()
    lens = lens.replace(image=lens.image.replace(curvature=-0.05))
    error = []
    for shift in (1e-2, 1e-3):
        here, there = through_focus(lens, np.full(21, shift)).at(0), lenstrace.spots(moved(lens, shift))
        error.append(float(np.abs(np.asarray(here.y) - np.asarray(there.y)).max()))
    # second order in the shift
    assert error[0] < 1e-7
    assert error[1] == pytest.approx(error[0] / 100, rel=0.05)


def test_derivatives_and_nan_inside_a_program() -> None:
    def shift(lens: Lens) -> jax.Array:
        return best_focus(lens).spot.shift

    by_lens = jax.jit(jax.value_and_grad(shift))
    lens = singlet()
    value, slopes = by_lens(lens)
    assert_allclose(value, shift(lens), rtol=1e-12)
    # the focus stays where it is as the last thickness grows
    assert_allclose(slopes[2].thickness, -1, rtol=1e-10)
    before, behind = (shift(lens.replace(surface=1, thickness=6.0 + step)) for step in (-1e-3, 1e-3))
    assert_allclose(slopes[1].thickness, (behind - before) / 2e-3, rtol=1e-6)
    blind = singlet(8.0, 9.0)
    with pytest.raises(lenstrace.LostRaysError, match="all 127 rays are lost"):
        best_focus(blind)
    with pytest.raises(lenstrace.LostRaysError, match="all 127 rays are lost"):
        through_focus(blind, np.zeros(21))
    assert np.isnan(by_lens(blind)[0])


def test_what_has_no_answer_is_an_error(designs: dict[str, Lens]) -> None:
    for question in (best_focus, through_focus):
        with pytest.raises(lenstrace.ImageError, match="a focus needs an image"):
            question(designs["afocal_expander"])
    with pytest.raises(lenstrace.RayError, match="from 2 to 1001, got 1"):
        through_focus(singlet(), steps=1)
    for wrong in (np.zeros((2, 2)), np.array([np.nan])):
        with pytest.raises(lenstrace.RayError, match="shifts must be"):
            through_focus(singlet(), wrong)
    for curve in (spot_field, spot_spectrum):
        with pytest.raises(lenstrace.RayError, match="from 2 on, got 1"):
            curve(singlet(), points=1)


def test_curves_are_spots_of_other_fields_and_wavelengths() -> None:
    lens = singlet()
    field, spectrum = spot_field(lens), spot_spectrum(lens)
    halfway = lenstrace.spots(lens.replace(fields=Fields((0.0, 0.0), (2.5, 5.0), "angle")))
    assert_allclose(field.y, np.linspace(0, 5.0, 21), atol=1e-14)
    assert_allclose(field.rms[10::10], halfway.rms_centroid, atol=1e-13)
    assert_allclose(field.polychromatic[10::10], halfway.polychromatic.rms_centroid, atol=1e-13)
    assert_allclose(spectrum.um[::10], [0.48, 0.565, 0.65], rtol=1e-14)
    # the pupil is that of the primary wavelength: the stop stands first, so that it is the same for all
    other = lenstrace.spots(lens.replace(wavelengths=Wavelengths((1.0, 1.0, 1.0), (0.48, 0.565, 0.65), 1)))
    assert_allclose(spectrum.rms[:, ::10], other.rms_centroid, atol=1e-13)


def test_single_precision_stays_single() -> None:
    single = singlet().astype("float32")
    for result in (best_focus(single), through_focus(single)):
        numbers = {leaf.dtype for leaf in jax.tree.leaves(result)} - {np.dtype("int32"), np.dtype("int64")}
        assert numbers == {np.dtype("float32")}


def test_plots_and_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lens = singlet()
    through, best = through_focus(lens), best_focus(lens)
    figure = Figure()
    axes = figure.add_subplot()
    assert plot_through_focus(through, lens, axes, best=best) is axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("shift of the image, mm", "RMS spot, µm")
    legend = axes.get_legend()
    assert legend is not None
    names = [text.get_text() for text in legend.get_texts()]
    assert names == ["0°", "5°", "all fields", "least spot", "paraxial"]
    assert plot_spot_field(spot_field(lens), lens, figure.add_subplot()).get_xlabel() == "field, deg"
    assert plot_spot_spectrum(spot_spectrum(lens), lens, figure.add_subplot()).get_xlabel() == "wavelength, µm"

    path, picture = tmp_path / "singlet.toml", tmp_path / "page.png"
    lenstrace.save(lens, path)
    parser = argparse.ArgumentParser()
    command.add_parser(parser.add_subparsers())
    arguments = parser.parse_args(["focus", str(path), "--json", "--plot", str(picture)])
    arguments.run(arguments)
    printed = json.loads(capsys.readouterr().out)
    assert printed["best_focus"]["spot"]["shift"] == float(best.spot.shift)
    assert np.shape(printed["through_focus"]["wavelength_rms"]) == (21, 2, 3)
    assert picture.stat().st_size > 10_000
