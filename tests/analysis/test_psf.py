"""Point spreads: Airy's pattern, its energy, an annulus, small defocus, and the two ways of summing waves."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import j0, j1

import lenstrace
from lenstrace import Lens
from lenstrace.analysis.encircled import bessel, encircled_energy, radius_of
from lenstrace.analysis.psf import Psf, psf

FOCUS, DIAMETER, UM = 2000.0, 100.0, 0.55
MM = UM / 1000
# The sine of the steepest ray of a parabola: r / (f + sag).
NA = DIAMETER / 2 / (FOCUS + (DIAMETER / 2) ** 2 / (4 * FOCUS))


def parabola(shift: float = 0.0, **more: Any) -> Lens:
    """Perfect on its axis, f/20; the image `shift` behind the focus."""
    row = {"radius": -2 * FOCUS, "conic": -1, "thickness": -FOCUS - shift, "mirror": True, "stop": True, **more}
    return lenstrace.lens([row], {"entrance_pupil_diameter": DIAMETER}, [0.0], [UM])


@functools.cache
def perfect() -> Psf:
    return psf(parabola(), samples=128)


def radii(found: Psf) -> np.ndarray:
    """v = 2 pi NA r / lambda of the points."""
    return 2 * np.pi * NA / MM * np.hypot(*np.meshgrid(found.position, found.position))


def jinc(v: np.ndarray) -> np.ndarray:
    return np.where(v > 0, 2 * j1(v) / np.where(v > 0, v, 1), 1)


def test_airy_pattern() -> None:
    found = perfect()
    # 5e-5 measured: the edge of the pupil is drawn in cells
    assert_allclose(found.density[0, 0] / found.peak[0, 0], jinc(radii(found)) ** 2, atol=1e-4)
    assert_allclose(found.peak, np.pi * (NA / MM) ** 2, rtol=1e-5)
    assert_allclose(found.strehl, 1, atol=1e-9)
    assert found.method == "fft"
    assert float(found.position[128]) == 0


def test_encircled_energy_of_airy_pattern() -> None:
    """1 - J0^2 - J1^2 (Rayleigh)."""
    v = np.array([1.0, 2.0, 3.8317, 7.0156, 20.0])
    found = encircled_energy(perfect(), v / (2 * np.pi * NA / MM), about="chief")
    assert_allclose(found.circle[0], 1 - j0(v) ** 2 - j1(v) ** 2, atol=1.5e-3)
    everything = encircled_energy(perfect())
    assert_allclose(everything.square[0, -1], everything.within[0], atol=1e-3)
    assert_allclose(radius_of(everything, 0.5), 0.5353 * MM / (2 * NA), rtol=5e-3)
    assert np.isnan(radius_of(everything, 0.999)).all()
    x = np.linspace(0, 300, 999)
    assert_allclose(bessel(x), j1(x), atol=1e-7)


def test_annular_pupil() -> None:
    ratio = 0.4
    found = psf(parabola(aperture={"annulus": [ratio * DIAMETER / 2, 0.5 * DIAMETER]}), samples=128)
    v = radii(found)
    exact = ((jinc(v) - ratio**2 * jinc(ratio * v)) / (1 - ratio**2)) ** 2
    # edges of apertures are found with 4 x 4 rays a cell: 1.8e-3 measured
    assert_allclose(found.density[0, 0] / found.peak[0, 0], exact, atol=2.5e-3)


def test_small_defocus_and_parseval() -> None:
    """W = W020 r^2 of an even disc: sigma = W020 / sqrt(12), and on the axis sinc(W020)^2."""
    wanted = 0.02 * np.sqrt(12)
    found = psf(parabola(wanted * MM * 2 / NA**2), samples=128)
    strehl = float(found.strehl[0, 0])
    assert_allclose(strehl, np.sinc(wanted) ** 2, atol=3e-5)
    assert_allclose(strehl, np.exp(-((2 * np.pi * 0.02) ** 2)), atol=1e-4)
    assert_allclose(np.max(found.density) / found.peak[0, 0], strehl, rtol=1e-9)
    # light is not lost by aberration: the same amplitudes as without
    assert_allclose(found.within, perfect().within, rtol=1e-6)


def test_transform_and_direct_sum_agree(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    both = [psf(lens, samples=64, method=method) for method in ("fft", "huygens")]
    for f in range(3):
        # so few samples let light of the last fields fall on wrong places: 1.0e-3 measured
        peak = np.asarray(both[0].peak[f])[:, None, None]
        assert np.abs(np.asarray(both[0].density[f] - both[1].density[f]) / peak).max() < 2e-3
    assert_allclose(both[0].peak, both[1].peak, rtol=2e-4)


def test_single_precision_and_errors(designs: dict[str, Lens]) -> None:
    with pytest.warns(lenstrace.AccuracyWarning, match="rounding"):
        single = psf(parabola().astype("float32"), samples=128)
    assert single.density.dtype == np.dtype("float32")
    assert_allclose(single.density / single.peak[0, 0], perfect().density / perfect().peak[0, 0], atol=1e-3)
    assert encircled_energy(single).circle.dtype == np.dtype("float32")
    with pytest.raises(lenstrace.RayError, match="unknown method 'ffft'"):
        psf(parabola(), method="ffft")
    with pytest.raises(lenstrace.RayError, match="even number"):
        psf(parabola(), samples=33)
    with pytest.raises(lenstrace.ImageError, match="a point spread function needs an image"):
        psf(designs["afocal_expander"])
    with pytest.raises(lenstrace.RayError, match="unknown centre"):
        encircled_energy(perfect(), about="peak")
    with pytest.raises(lenstrace.RayError, match="radii must be"):
        encircled_energy(perfect(), [-1.0])
