"""Colours: the fitted observer against the CIE's table, white, sRGB, colours beyond a screen's."""

import jax
import jax.numpy as jnp
import numpy as np
from numpy.testing import assert_allclose

from lenstrace.optics.colour import LUMINANCE, SRGB_FROM_XYZ, encoded, srgb_of_xyz, within_gamut, xyz_of_wavelength

# The CIE 1931 standard observer (CIE 15): um, xbar, ybar, zbar.
TABLE = np.array(
    [
        (0.400, 0.0143, 0.0004, 0.0679),
        (0.450, 0.3362, 0.0380, 1.7721),
        (0.500, 0.0049, 0.3230, 0.2720),
        (0.520, 0.0633, 0.7100, 0.0782),
        (0.550, 0.4334, 0.9950, 0.0087),
        (0.555, 0.5121, 1.0000, 0.0057),
        (0.600, 1.0622, 0.6310, 0.0008),
        (0.650, 0.2835, 0.1070, 0.0000),
        (0.700, 0.0114, 0.0041, 0.0000),
    ]
)
# Largest error of the fit of Wyman, Sloan & Shirley (2013) at these wavelengths.
FIT = 0.025
D65 = np.array([0.9505, 1.0, 1.089])  # white of sRGB, IEC 61966-2-1

observer = jax.jit(xyz_of_wavelength)
spectrum = np.asarray(observer(np.arange(0.36, 0.8305, 0.001)))


def test_the_observer_of_the_table() -> None:
    assert_allclose(observer(TABLE[:, 0]), TABLE[:, 1:], atol=FIT)


def test_chromaticities() -> None:
    xyz = np.asarray(observer(np.array([0.45, 0.52, 0.60])))
    xy = (xyz / xyz.sum(-1, keepdims=True))[:, :2]
    assert_allclose(xy, [(0.1566, 0.0177), (0.0743, 0.8338), (0.6270, 0.3725)], atol=0.015)


def test_equal_energy_is_white() -> None:
    # the table sums to 106.9 for each function, every nanometre
    assert_allclose(spectrum.sum(0), 106.86, rtol=5e-3)
    assert_allclose(spectrum.sum(0)[:2] / spectrum.sum(), 1 / 3, atol=1e-3)


def test_srgb() -> None:
    assert_allclose(srgb_of_xyz(jnp.asarray(D65)), 1, atol=5e-4)
    assert_allclose(np.linalg.inv(SRGB_FROM_XYZ)[1], LUMINANCE, atol=5e-5)
    # 0.2140 is the middle of the curve, published with it: 0.5
    assert_allclose(encoded(jnp.asarray([-1.0, 0.0, 0.002, 0.214041, 1.0, 7.0])), [0, 0, 0.02584, 0.5, 1, 1], atol=1e-6)


def test_spectral_colours_are_brought_within_reach() -> None:
    rgb = np.asarray(srgb_of_xyz(jnp.asarray(spectrum)))
    assert (rgb.min(-1) < 0).any()
    shown = np.asarray(within_gamut(jnp.asarray(rgb)))
    assert (shown >= 0).all()
    luminance = np.maximum(rgb @ np.asarray(LUMINANCE), 0)
    assert_allclose(shown @ np.asarray(LUMINANCE), luminance, atol=1e-15)
    inside = jnp.asarray([0.2, 0.5, 1.7])
    assert_allclose(within_gamut(inside), inside)
    assert_allclose(within_gamut(jnp.asarray([-1.0, 0.0, 0.0])), 0)


def test_derivatives_and_single_precision() -> None:
    waves = jnp.asarray([0.4, 0.442, 0.5688, 0.6, 0.9], jnp.float32)

    def shown(um: jax.Array) -> jax.Array:
        return encoded(within_gamut(srgb_of_xyz(xyz_of_wavelength(um))))

    value, slope = jax.jvp(shown, (waves,), (jnp.ones_like(waves),))
    assert value.dtype == jnp.float32
    assert jnp.isfinite(value).all()
    assert jnp.isfinite(slope).all()
