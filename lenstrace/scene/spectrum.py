"""One wavelength for a ray, and the colour that stands for it: only where a scene tells wavelengths apart.

Colours of materials and lights are RGB all the same, each channel of an even spectrum. A sample at a wavelength is what
a scene without dispersion would give, times the colour of that wavelength, whose mean over all samples is white
(1, 1, 1): without dispersion the picture is the same, with it white light is taken apart into its spectrum.
"""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.colour import SRGB_FROM_XYZ, srgb_of_xyz, xyz_of_wavelength
from lenstrace.scene.colours import Colour

# Beyond these an eye sees less than a thousandth of what it sees at its best.
SHORTEST, LONGEST = 0.40, 0.70
STEPS = 3000  # of the integral over all wavelengths


def sampled_wavelength(u: jax.Array) -> tuple[jax.Array, Colour]:
    """Wavelength, um, evenly for u in [0, 1), and its colour: linear sRGB, negative where no screen shows it."""
    um = SHORTEST + (LONGEST - SHORTEST) * u
    rgb = srgb_of_xyz(xyz_of_wavelength(um)) / jnp.asarray(_white(), u.dtype)
    return um, (rgb[..., 0], rgb[..., 1], rgb[..., 2])


@functools.cache
def _white() -> tuple[float, float, float]:
    """The mean colour of all wavelengths, linear sRGB."""
    um = SHORTEST + (LONGEST - SHORTEST) * (np.arange(STEPS) + 0.5) / STEPS
    mean = np.mean(_xyz(um), 0) @ np.array(SRGB_FROM_XYZ).T
    return tuple(mean.tolist())


def _xyz(um: np.ndarray) -> np.ndarray:
    with jax.ensure_compile_time_eval():
        return np.asarray(xyz_of_wavelength(jnp.asarray(um, jnp.float64)))
