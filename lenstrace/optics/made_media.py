"""Media made out of others: known at some wavelengths alone, or melted a little wrong."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np
from numpy.typing import ArrayLike

from lenstrace.compute.pytree import pytree, static
from lenstrace.errors import WavelengthError


@pytree
class Sampled:
    """A medium as a program sees it: its indices `n` at some wavelengths `um`, and nothing between; n are leaves."""

    n: tuple[Any, ...]
    um: tuple[float, ...] = static()
    name: str = static(default="sampled")

    def index(self, wavelength_um: ArrayLike) -> Any:
        """Index at one of the wavelengths, or several; WavelengthError for another."""
        wavelength = np.asarray(wavelength_um)
        for um in wavelength.flat:
            if um not in self.um:
                raise WavelengthError(
                    f"the medium is known at {', '.join(map(str, self.um))} um alone, not at {um:g} um"
                )
        found = [self.n[self.um.index(float(um))] for um in wavelength.flat]
        return found[0] if wavelength.ndim == 0 else jnp.stack(found)


@pytree
class Melt:
    """A medium as it was melted: its index changed by `shift` at every wavelength, its dispersion by a part `spread`,

        n(L) = m(L) + shift + spread (m(L) - m(L0)),

    m of the medium it should be, L0 a wavelength, micrometres, at which its dispersion is not seen. 1 / (1 + spread) is
    the factor of the Abbe number, but for that of nd - 1.
    """

    medium: Any
    shift: Any
    spread: Any
    reference_um: Any

    @property
    def name(self) -> str:
        """Of the medium that it should be."""
        return self.medium.name

    def index(self, wavelength_um: ArrayLike) -> Any:
        """Index in the shape of `wavelength_um`; WavelengthError as the medium says."""
        index = self.medium.index(wavelength_um)
        return index + self.shift + self.spread * (index - self.medium.index(self.reference_um))
