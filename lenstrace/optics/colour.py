"""Colours of light: from wavelengths to CIE 1931 XYZ, and on to the sRGB of a screen.

A spectrum is summed in XYZ. `srgb_of_xyz` gives linear sRGB, in which lights add; `within_gamut` takes colours that no
screen can show to the nearest of the same luminance along the way to grey; `encoded` applies the curve of a picture
file, last.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp

NANOMETRES = 1000.0  # in a micrometre

# Of a lobe: height, peak in nm, steepness below and above the peak in 1/nm.
_X = ((0.362, 442.0, 0.0624, 0.0374), (1.056, 599.8, 0.0264, 0.0323), (-0.065, 501.1, 0.0490, 0.0382))
_Y = ((0.821, 568.8, 0.0213, 0.0247), (0.286, 530.9, 0.0613, 0.0322))
_Z = ((1.217, 437.0, 0.0845, 0.0278), (0.681, 459.0, 0.0385, 0.0725))

# Linear sRGB from XYZ, white D65. Source: IEC 61966-2-1:1999, 5.2.
SRGB_FROM_XYZ = ((3.2406, -1.5372, -0.4986), (-0.9689, 1.8758, 0.0415), (0.0557, -0.2040, 1.0570))
# The second row of the inverse: what each primary adds to the luminance Y.
LUMINANCE = (0.2126, 0.7152, 0.0722)


def xyz_of_wavelength(um: jax.Array) -> jax.Array:
    """The colour matching functions of the CIE 1931 observer (2 degrees), (..., 3); um: (...), micrometres.

    A sum of lobes exp(-(s (L - peak))^2 / 2) whose steepness s differs on the two sides of the peak; every function
    stays within 0.025 of the table at the tests' wavelengths. Beyond the visible it fades to 0.
    Source: Wyman, Sloan & Shirley, J. Computer Graphics Techniques 2 (2), 1 (2013), Eq. (4) and Listing 1.
    """
    nm = NANOMETRES * um
    return jnp.stack([_lobes(each, nm) for each in (_X, _Y, _Z)], -1)


def srgb_of_xyz(xyz: jax.Array) -> jax.Array:
    """Linear sRGB, (..., 3); Y = 1 of white D65 is (1, 1, 1). Colours beyond a screen's have negative parts."""
    return xyz @ jnp.asarray(SRGB_FROM_XYZ, xyz.dtype).T


def within_gamut(rgb: jax.Array) -> jax.Array:
    """Linear sRGB without negative parts, (..., 3): mixed with the grey of its own luminance as far as that needs.

    Luminance is kept, and the line from grey; pure spectral colours become paler. Parts above 1 are left: exposure is
    the picture's concern. Where the luminance is not positive the result is black.
    """
    grey = jnp.maximum(rgb @ jnp.asarray(LUMINANCE, rgb.dtype), 0)[..., None]
    lowest = jnp.min(rgb, -1, keepdims=True)
    kept = jnp.where(lowest < 0, grey / jnp.where(lowest < 0, grey - lowest, 1), 1)
    return jnp.maximum(grey + kept * (rgb - grey), 0)


def encoded(rgb: jax.Array) -> jax.Array:
    """Values of a picture file, 0 to 1, from linear sRGB; what is brighter than 1 is clipped.

    Source: IEC 61966-2-1:1999, 5.2.
    """
    linear = jnp.clip(rgb, 0, 1)
    curved = 1.055 * jnp.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055
    return jnp.where(linear <= 0.0031308, 12.92 * linear, curved)


def _lobes(lobes: tuple[tuple[float, float, float, float], ...], nm: jax.Array) -> jax.Array:
    total = jnp.zeros_like(nm)
    for height, peak, below, above in lobes:
        distance = (nm - peak) * jnp.where(nm < peak, below, above).astype(nm.dtype)
        total += height * jnp.exp(-distance * distance / 2)
    return total
