"""Refractive indices in a scene: one number, or a formula of the wavelength fitted to a glass.

    n^2 = a0 + a1 L^2 + a2 L^-2 + a3 L^-4 + a4 L^-6 + a5 L^-8,   L in um

Source: Schott, Technical Information TIE-29 (2016), the older form of its dispersion formula.
"""

from __future__ import annotations

from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree
from lenstrace.scene.spectrum import LONGEST, SHORTEST

POWERS = (0, 2, -2, -4, -6, -8)
NODES = 61  # of the fit


@pytree
class Constant:
    """The same at every wavelength."""

    disperses: ClassVar[bool] = False
    index: Any

    def at(self, um: jax.Array | None) -> Any:
        """Relative to air."""
        del um
        return self.index


@pytree
class Dispersion:
    """a0 to a5 of the formula."""

    disperses: ClassVar[bool] = True
    coefficients: tuple[Any, ...]

    def at(self, um: jax.Array | None) -> jax.Array:
        """Relative to air; um: wavelengths."""
        assert um is not None
        a0, a1, a2, a3, a4, a5 = self.coefficients
        square = um * um
        inverse = 1 / square
        return jnp.sqrt(a0 + a1 * square + inverse * (a2 + inverse * (a3 + inverse * (a4 + inverse * a5))))


def fitted(index: Any) -> Dispersion:
    """The formula of a medium that has an `index(um)`, least squares over the wavelengths of a picture."""
    # Chebyshev's nodes keep the error alike over the whole range
    um = (SHORTEST + LONGEST) / 2 - (LONGEST - SHORTEST) / 2 * np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    terms = um[:, None] ** np.array(POWERS)
    scale = np.max(np.abs(terms), axis=0)
    found, *_ = np.linalg.lstsq(terms / scale, np.asarray(index(um), float) ** 2, rcond=None)
    return Dispersion(tuple((found / scale).tolist()))
