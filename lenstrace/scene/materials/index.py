"""The refractive index of a material: one number, or a glass's, which takes the wavelength of the ray."""

from __future__ import annotations

from typing import Any

import jax

from lenstrace.compute.pytree import pytree
from lenstrace.optics.media import Air, Constant, Medium
from lenstrace.scene.dispersion import Dispersion, dispersion_of


@pytree
class FlatIndex:
    """The same at every wavelength. n: relative to air."""

    n: Any

    def index(self, um: jax.Array | None) -> Any:
        """n, whatever the wavelength."""
        del um
        return self.n


def index_of(medium: Medium) -> FlatIndex | Dispersion:
    """The index of a medium; one that has no dispersion asks for no wavelengths."""
    if isinstance(medium, Air | Constant):
        return FlatIndex(float(medium.index(0.55)))
    return dispersion_of(medium)


def disperses(*indices: Any) -> bool:
    """Whether the wavelength makes a difference to one of them."""
    return any(isinstance(index, Dispersion) for index in indices)
