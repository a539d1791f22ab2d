"""Spots: their definitions, weights, lost rays."""

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens, RayStatus
from lenstrace.analysis.spot_figures import loss_text


def defocused(weights: list[float], **more: object) -> Lens:
    """A thin lens, f = 100 at 0.5 um and 200 at 0.6 um, its image surface at 100 mm; the second colour is a disk."""
    index = {"um": [0.5, 0.6], "n": [1.5, 1.25]}
    rows = [{"radius": 50.0, "thickness": 0.0, "index": index, "stop": True} | more, {"thickness": 100.0}]
    waves = {"um": [0.5, 0.6], "weights": weights}
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 0.02}, [0.0, 1.0], waves)


def test_figures_of_a_uniform_disk() -> None:
    # h = 0.01 mm: aberrations are 1e-9; the second colour keeps half of the height: rings of radius k / 6 * h / 2
    spots = lenstrace.spots(defocused([1.0, 1.0]))
    k = np.arange(1, 7)
    rms = np.sqrt((6 * k * (k / 6) ** 2).sum() / 127) * 0.005
    assert_allclose(spots.rms_centroid[0, 1], rms, rtol=1e-6)
    assert_allclose(spots.rms_chief[0, 1], rms, rtol=1e-6)
    assert_allclose(spots.largest[0, 1], 0.005, rtol=1e-6)
    assert float(spots.rms_centroid[0, 0]) < 1e-8
    assert spots.rays == 127


def test_polychromatic_spot_is_pooled_by_weight() -> None:
    spots = lenstrace.spots(defocused([3.0, 1.0]))
    x, y = (np.asarray(part)[1] for part in (spots.x, spots.y))
    w = np.repeat([[3.0], [1.0]], 127, 1) / (4 * 127)
    cx, cy = (w * x).sum(), (w * y).sum()
    assert_allclose(spots.polychromatic.centroid_y[1], cy, rtol=1e-12)
    expected = np.sqrt((w * ((x - cx) ** 2 + (y - cy) ** 2)).sum())
    assert_allclose(spots.polychromatic.rms_centroid[1], expected, rtol=1e-9)


def test_lost_rays_are_counted_by_surface_and_reason() -> None:
    lens = defocused([1.0, 1.0], aperture={"circle": 0.0076})
    spots = lenstrace.spots(lens)
    # rings 5 and 6 of the six are larger than 0.0076 mm: 30 + 36 rays
    assert np.asarray(spots.lost).tolist() == [[66, 66], [66, 66]]
    assert spots.losses(0, 0) == {(1, RayStatus.CLIPPED): 66}
    assert loss_text(spots.losses(0, 0)) == "66 clipped at surface 1"
    k = np.arange(1, 5)
    rms = np.sqrt((6 * k * (k / 6) ** 2).sum() / 61) * 0.005
    assert_allclose(spots.rms_centroid[0, 1], rms, rtol=1e-6)


def test_an_obscured_chief_ray_keeps_its_place(designs: dict[str, Lens]) -> None:
    spots = lenstrace.spots(designs["hubble"])
    # 0.1 degrees of 57.6 m
    assert_allclose(spots.chief_y[1, 0], 57600 * np.tan(np.radians(0.1)), rtol=1e-3)
    assert int(spots.lost[0, 0]) == 7


def test_a_spot_without_rays_is_an_error_and_nan_under_jit() -> None:
    lens = defocused([1.0, 1.0], aperture={"obscuration": 1.0})
    with pytest.raises(lenstrace.LostRaysError, match="all 127 rays are lost"):
        lenstrace.spots(lens)
    spots = jax.jit(lenstrace.spots)(lens)
    assert np.isnan(spots.rms_centroid).all()
    assert np.isnan(spots.polychromatic.rms_centroid).all()
    assert np.asarray(spots.lost).tolist() == [[127, 127], [127, 127]]
