"""The index of a medium over visible light as six numbers, for programs that are given wavelengths.

With w = (L^-2 - a) / b, -1 at 0.78 um and +1 at 0.38 um, of the wavelength L in micrometres

    n(L) = c0 + c1 w + c2 w^2 + c3 w^3 + c4 w^4 + c5 L^2,

the powers of SCHOTT's old formula, of n instead of n^2: it is linear in what it is fitted to, exact for a constant
index, also a negative one, and loses nothing to cancellation in float32. Of the 1,289 glasses of the catalogues that
are known over all of the range half are met to 2e-8, 94 % to 1e-6; the worst, dense flints that absorb near 0.35 um, to
3e-5 (at 0.38 um). A medium known at a few wavelengths alone takes as few curves as it has nodes.
Source of the powers: SCHOTT technical information TIE-29, section 2; of Conrady's curve: see `media.CONRADY_POWER`.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import WavelengthError
from lenstrace.optics.made_media import Melt, Sampled
from lenstrace.optics.media import CONRADY_POWER, Air, Constant, Formula, Medium, Table

RANGE_UM = (0.38, 0.78)
"""Shortest and longest wavelength that a fit is made for: those of the CIE observers that count."""

SAMPLES = 40
TERMS = 6
# With so many nodes or fewer the curve runs through all of them.
EXACT_NODES = 3
# Nodes of a table count up to this far beyond the range, relatively.
REACH = 1.15


@pytree
class Dispersion:
    """The numbers of n(L), see above; scalars, or arrays that broadcast with the wavelengths."""

    constant: Any
    first: Any
    second: Any
    third: Any
    fourth: Any
    infrared: Any

    def index(self, um: Any) -> Any:
        """n, relative to air, of the shape of the wavelengths, micrometres; meant for RANGE_UM."""
        square = um * um
        w = (1 / square - MIDDLE) * (1 / HALF)
        total = ((self.fourth * w + self.third) * w + self.second) * w + self.first
        return self.constant + (total * w + self.infrared * square)


def dispersion_of(medium: Medium) -> Dispersion:
    """The fit of a medium, by least squares over the part of RANGE_UM in which it is known.

    A table, or a medium known at some wavelengths, is met at its nodes if there are at most three, by Conrady's curve
    through them, A + B / L + C / L^3.5 (a straight line in L^-2 through two), which also goes on beyond them: out of
    F, d and C half of the catalogue's glasses are met to 1.3e-4 at 0.40 um, 3e-6 at 0.70 um and 2e-5 at 0.78 um, 90 %
    to 6e-4, 8e-6 and 5e-5. More nodes take L^2 and L^-2 too, by least squares with one curve less than there are nodes,
    and all six terms from seven nodes on.

    Numbers of the medium may be traced by JAX. WavelengthError where it is not known in visible light.

    >>> print(dispersion_of(Constant(1.6)).index(np.array(0.45)))
    1.6
    """
    if isinstance(medium, Air | Constant):
        n = 1.0 if isinstance(medium, Air) else medium.n
        return Dispersion(*_numbers([n, *[0.0] * (TERMS - 1)]))
    um = _known_at(medium)
    n = [medium.index(each) for each in um]
    n = jnp.stack([jnp.asarray(each) for each in n]) if is_traced(n) else np.asarray(n, float)
    return Dispersion(*_numbers(list(_fit(tuple(um)) @ n)))


def dispersions_of(media: Sequence[Medium]) -> Dispersion:
    """Those of several media, stacked: six arrays (len(media),)."""
    found = [dispersion_of(medium) for medium in media]
    return jax.tree.map(lambda *each: jnp.stack(each) if is_traced(each) else np.stack(each), *found)


def _known_at(medium: Any) -> list[float]:
    """The wavelengths of which a fit is made, micrometres."""
    low, high = RANGE_UM
    inner = medium.medium if isinstance(medium, Melt) else medium
    if isinstance(inner, Table | Sampled):
        found = [um for um in inner.um if low / REACH <= um <= high * REACH]
        if not found:
            raise WavelengthError(
                f"{medium.name}: known from {min(inner.um):g} to {max(inner.um):g} um, not in visible light, {low} to "
                f"{high} um; take another medium, or no wavelengths"
            )
        return sorted(found)
    if isinstance(inner, Formula):
        low, high = max(low, inner.range_um[0]), min(high, inner.range_um[1])
        if low >= high:
            raise WavelengthError(
                f"{medium.name}: known from {inner.range_um[0]:g} to {inner.range_um[1]:g} um, not in visible light, "
                f"{RANGE_UM[0]} to {RANGE_UM[1]} um; take another medium, or no wavelengths"
            )
    return _chebyshev(low, high)


@functools.lru_cache(maxsize=256)
def _fit(um: tuple[float, ...]) -> np.ndarray:
    """(6, len(um)): the numbers of the fit out of the indices at some wavelengths."""
    if len(um) > TERMS:
        return np.linalg.pinv(_columns(um))
    terms = min(len(um), max(EXACT_NODES, len(um) - 1))
    curves = _few_curves()[:, :terms] if terms != 2 else np.eye(TERMS)[:, :2]
    # met by the fits of the curves, not by the curves: the nodes are then exact
    return curves @ np.linalg.pinv(_columns(um) @ curves)


def _columns(um: Sequence[float]) -> np.ndarray:
    """(len(um), 6): what the six numbers are multiplied by."""
    at = np.asarray(um)
    w = (at**-2.0 - MIDDLE) / HALF
    return np.stack([w**0, w, w**2, w**3, w**4, at**2], 1)


@functools.cache
def _few_curves() -> np.ndarray:
    """(6, 5): the numbers of 1, 1 / L, L^-3.5, L^2 and L^-2, in the order in which they are taken."""
    um = _chebyshev(*RANGE_UM)
    at = np.asarray(um)
    curves = np.stack([at**0, at**-1, at**CONRADY_POWER, at**2, at**-2], 1)
    return np.linalg.pinv(_columns(um)) @ curves


def _chebyshev(low: float, high: float) -> list[float]:
    """Chebyshev's nodes in L^-2: the fit is then near the one whose largest error is least."""
    nodes = np.cos(np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)
    ends = high**-2.0, low**-2.0
    return [float(x) for x in ((ends[0] + ends[1]) / 2 + (ends[1] - ends[0]) / 2 * nodes) ** -0.5]


def _numbers(values: Sequence[Any]) -> list[Any]:
    return [value if isinstance(value, jax.Array) else np.asarray(value, float) for value in values]


MIDDLE = (RANGE_UM[0] ** -2 + RANGE_UM[1] ** -2) / 2
HALF = (RANGE_UM[0] ** -2 - RANGE_UM[1] ** -2) / 2
