"""The trade of a lens: truths in closed form, settings that tend to them, predictions of third order."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import lenstrace
from lenstrace import Lens
from lenstrace.accuracy.trade import Outcome
from lenstrace.analysis.predictions import predicted_chief, predicted_spot, predicted_wavefront
from lenstrace.analysis.settings import samplings
from lenstrace.analysis.settings.rays import chief_truth, focal_truth
from lenstrace.analysis.trade import LensTrade, trade


@pytest.fixture(autouse=True)
def _fewer_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    """One number of rays in one program: what is compiled takes the time here."""
    few = {"hexapolar": (1, 4), "grid": (4,), "gaussian": (1, 2, 3, 4)}
    monkeypatch.setattr(samplings, "RINGS", few)
    monkeypatch.setattr(samplings, "COUNTS", (64,))
    monkeypatch.setattr(samplings, "NEWTON_RINGS", 4)


def singlet(*, field: float = 0.0, **more: object) -> Lens:
    rows = [
        {"radius": 50.0, "thickness": 10.0, "index": 1.5, "stop": True, **more},
        {"radius": -50.0, "thickness": 48.0},
    ]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 5.0}, [field], [0.55])


def outcome(found: LensTrade, name: str) -> Outcome:
    return next(each for each in found.trade.outcomes if name in each.setting.name)


def test_spot_of_an_axial_point() -> None:
    found = trade(singlet(conic=-0.5, asphere={4: -1e-5, 6: 1e-8}), tolerance=1e-6)
    assert (found.quantity, found.unit, found.field) == ("spot", "mm", (0.0, 0.0))
    names = [each.setting.family for each in found.trade.outcomes]
    assert {"paraxial", "third order", "sobol, float32", "gaussian, one spoke, float64", "Newton steps"} <= set(names)
    for name in (
        "gaussian, 4 rings, 64 rays, float64",
        "half the pupil, 32 rays, float64",
        "one spoke, 4 rays, float64",
    ):
        assert outcome(found, name).relative_error < 1e-9, name
    assert 1e-9 < outcome(found, "gaussian, 4 rings, 64 rays, float32").relative_error < 1e-3
    # each ring counts too much of the edge in the hexapolar pattern
    assert outcome(found, "hexapolar, 4 rings, 61 rays, float64").relative_error > 0.01
    # the conic alone leaves the asphere out; on so mild a one a single step ends it
    steps = [outcome(found, f"Newton steps {count}").relative_error for count in (0, 1, 2)]
    assert steps[0] > 1e-5
    assert max(steps[1:]) < 1e-9
    assert found.trade.chosen is not None
    assert found.trade.chosen.relative_error <= 1e-6
    assert found.trade.truth == pytest.approx(
        float(lenstrace.spots(singlet(conic=-0.5, asphere={4: -1e-5, 6: 1e-8}), rings=300).rms_centroid[0, 0]), rel=0.01
    )


def test_opd_summed_and_as_excess() -> None:
    found = trade(singlet(field=2.0), "opd")
    excess, summed = (outcome(found, f"gaussian, 4 rings, 64 rays, float32{form}") for form in ("", ", path summed"))
    assert summed.error > 3 * excess.error
    assert outcome(found, "gaussian, 4 rings, 64 rays, float64").relative_error < 1e-9
    assert found.trade.truth == pytest.approx(
        float(lenstrace.wavefront(singlet(field=2.0), samples=257).rms[0, 0]), rel=1e-3
    )


def test_focal_length_of_a_thick_lens() -> None:
    # 1/f = (n - 1) (1/R1 - 1/R2 + (n - 1) d / (n R1 R2))
    assert focal_truth(singlet())[0] == pytest.approx(1 / (0.5 * (0.04 - 0.5 * 10 / (1.5 * 2500))), rel=1e-15)
    found = trade(singlet(), "focal_length", tolerance=1e-9)
    assert found.field is None
    zones = [outcome(found, f"exact ray at {zone:g} of the pupil, float64").error for zone in (1, 0.1, 0.01)]
    assert zones[0] / zones[1] == pytest.approx(100, rel=0.05)
    assert zones[1] / zones[2] == pytest.approx(100, rel=0.01)
    for name in ("paraxial, float64", "derivative of the exact trace, float64"):
        assert outcome(found, name).relative_error < 1e-14
    assert 1e-9 < outcome(found, "paraxial, float32").relative_error < 1e-5


def test_chief_height() -> None:
    found = trade(singlet(), "chief_height", field=3.0)
    assert found.field == (0.0, 3.0)
    assert outcome(found, "exact, float64").relative_error < 1e-14
    assert outcome(found, "third order").error < outcome(found, "paraxial").error / 30


def test_an_aimed_chief_ray_is_the_judges(designs: dict[str, Lens]) -> None:
    lens = designs["fisheye"]
    one = lens.replace(fields=lenstrace.Fields((0.0,), (95.0,), "angle"))
    traced = lenstrace.trace(one, field=95.0, path=False, opl=False)
    assert abs(chief_truth(one)[0] - float(traced.y)) < 1e-9


def test_third_order_departs_with_the_fifth_power() -> None:
    """Of aperture and field together, exact figures being those of rays."""
    errors = []
    for size in (1.0, 0.5):
        lens = singlet(field=4.0 * size)
        lens = lens.replace(aperture=lenstrace.Aperture(8.0 * size, "entrance_pupil_diameter"))
        # the image where paraxial rays meet, so that third order is all there is
        lens = lens.replace(surface=2, thickness=float(lenstrace.first_order(lens).back_focal_length[0]))
        exact = (
            float(lenstrace.spots(lens, tolerance=1e-9).rms_centroid[0, 0]),
            float(lenstrace.wavefront(lens, samples=257).rms[0, 0]),
            float(lenstrace.trace(lens, field=4.0 * size, path=False).y),
        )
        predicted = [f(lens, third_order=True) for f in (predicted_spot, predicted_wavefront, predicted_chief)]
        errors.append([abs(a - b) for a, b in zip(exact, predicted, strict=True)])
        assert predicted_spot(lens, third_order=False) < 1e-9
    (spot, wave, chief), (spot_half, wave_half, chief_half) = errors
    assert np.log2(spot / spot_half) == pytest.approx(5, abs=0.2)
    assert np.log2(wave / wave_half) == pytest.approx(6, abs=0.3)
    assert np.log2(chief / chief_half) == pytest.approx(5, abs=0.2)


def test_what_cannot_be_asked(designs: dict[str, Lens]) -> None:
    with pytest.raises(lenstrace.AccuracyError, match="unknown quantity 'colour'; one of spot"):
        trade(singlet(), "colour")
    with pytest.raises(lenstrace.AccuracyError, match="nothing to be accurate about"):
        trade(designs["afocal_expander"], "focal_length")
    with pytest.raises(lenstrace.ImageError):
        trade(designs["afocal_expander"])
    with pytest.raises(lenstrace.PrescriptionError, match="below 180"):
        trade(singlet(), field=200.0)


def test_the_plot_draws_front_and_tolerance() -> None:
    found = trade(singlet(), "focal_length", tolerance=1e-6)
    axes = lenstrace.plot_trade(found)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time of a call, ms", "relative error")
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    legend = axes.get_legend()
    assert legend is not None
    labels = [text.get_text() for text in legend.get_texts()]
    assert {"paraxial", "paraxial, float32", "Pareto front", "tolerance 1e-06", "chosen"} <= set(labels)
    drawn = {line.get_label(): line for line in axes.lines}
    assert len(drawn["Pareto front"].get_xdata()) == len(found.trade.front)  # type: ignore[arg-type]
    nothing = dataclasses.replace(found, trade=dataclasses.replace(found.trade, tolerance=None, chosen=None))
    assert "chosen" not in [line.get_label() for line in lenstrace.plot_trade(nothing).lines]
