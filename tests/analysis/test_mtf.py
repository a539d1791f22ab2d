"""Contrast: of a perfect lens, of defocus by waves and by rays, through focus, derivatives, Optiland."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import j1

import lenstrace
from lenstrace import Lens
from lenstrace.analysis.mtf import geometric_mtf, mtf, mtf_through_focus

FOCUS, DIAMETER, UM = 2000.0, 100.0, 0.55
MM = UM / 1000
NA = DIAMETER / 2 / (FOCUS + (DIAMETER / 2) ** 2 / (4 * FOCUS))
CUTOFF = 2 * NA / MM
FREQUENCY = np.linspace(0, 1.1, 23) * CUTOFF


def parabola(shift: float = 0.0) -> Lens:
    """Perfect on its axis, f/20; the image `shift` behind the focus."""
    row = {"radius": -2 * FOCUS, "conic": -1, "thickness": -FOCUS - shift, "mirror": True, "stop": True}
    return lenstrace.lens([row], {"entrance_pupil_diameter": DIAMETER}, [0.0], [UM])


def contrast(lens: Lens, frequency: Any = FREQUENCY) -> np.ndarray:
    return np.asarray(mtf(lens, frequency, samples=64).tangential[0])


def test_perfect_lens() -> None:
    found = mtf(parabola(), FREQUENCY, samples=64)
    k = np.minimum(FREQUENCY / CUTOFF, 1)
    exact = 2 / np.pi * (np.arccos(k) - k * np.sqrt(1 - k * k))
    for each in (found.tangential, found.sagittal, found.limit_tangential, found.each_sagittal[:, 0]):
        assert_allclose(each[0], exact, atol=1e-4)


def test_large_defocus_is_geometric() -> None:
    """A disc evenly filled, of radius a: |2 J1(2 pi a f) / (2 pi a f)|; waves come to it as the defocus grows."""
    apart = []
    for waves in (1.0, 4.0):
        lens = parabola(waves * MM * 2 / NA**2)
        radius = waves * MM * 2 / NA**2 * np.tan(np.arcsin(NA))
        frequency = np.linspace(0.05, 0.8, 12) / radius
        v = 2 * np.pi * radius * frequency
        exact = np.abs(2 * j1(v) / v)
        # the pupil is filled by rings of equal weight: half a ring of light at the edge
        assert_allclose(geometric_mtf(lens, frequency).tangential[0], exact, atol=2e-3)
        apart.append(np.abs(contrast(lens, frequency) - exact).max())
    assert apart[1] < apart[0] / 2
    assert apart[1] < 0.05


def test_through_focus_is_the_lens_with_its_image_moved() -> None:
    shifts = np.array([-0.6, 0.0, 0.6])
    found = mtf_through_focus(parabola(), 30.0, shifts, samples=64)
    # +z is against the light: the image `shift` behind the focus lies at -shift
    moved = [contrast(parabola(-shift), [30.0, 40.0])[0] for shift in shifts]
    assert_allclose(found.tangential[0], moved, atol=1e-6)
    assert moved[0] < 0.9 * moved[1]


def test_derivative() -> None:
    lens = parabola(0.5)

    def value(curvature: Any) -> jax.Array:
        return mtf(lens.replace(curvature=curvature), [30.0], samples=64).tangential[0, 0]

    jitted = jax.jit(jax.value_and_grad(value))
    step = 2e-10
    (ahead, _), (behind, _) = jitted(lens.curvature + step), jitted(lens.curvature - step)
    assert_allclose(jitted(lens.curvature)[1][0], (ahead - behind) / (2 * step), rtol=1e-5)


def test_single_precision_and_errors(designs: dict[str, Lens]) -> None:
    with pytest.warns(lenstrace.AccuracyWarning, match="rounding"):
        single = mtf(parabola(0.5).astype("float32"), FREQUENCY, samples=64)
    assert single.tangential.dtype == np.dtype("float32")
    assert_allclose(single.tangential[0], contrast(parabola(0.5)), atol=0.01)
    with pytest.raises(lenstrace.RayError, match="spatial frequencies must be"):
        mtf(parabola(), [-1.0])
    with pytest.raises(lenstrace.RayError, match="even number"):
        mtf(parabola(), samples=33)
    with pytest.raises(lenstrace.ImageError, match="needs an image"):
        mtf(designs["afocal_expander"], [10.0])
