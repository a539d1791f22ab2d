"""Dispersion formulas: the nine of the refractiveindex.info database, and the index of air.

Each is a pure function of the wavelength L in micrometres and the coefficients (c1, c2, ...), numbered as in
the database:

    1  Sellmeier              n^2 - 1 = c1 + c2 L^2 / (L^2 - c3^2) + c4 L^2 / (L^2 - c5^2) + ...
    2  Sellmeier-2            n^2 - 1 = c1 + c2 L^2 / (L^2 - c3) + c4 L^2 / (L^2 - c5) + ...
    3  Polynomial             n^2     = c1 + c2 L^c3 + c4 L^c5 + ...
    4  RefractiveIndex.INFO   n^2     = c1 + c2 L^c3 / (L^2 - c4^c5) + c6 L^c7 / (L^2 - c8^c9)
                                     + c10 L^c11 + ...
    5  Cauchy                 n       = c1 + c2 L^c3 + c4 L^c5 + ...
    6  Gases                  n - 1   = c1 + c2 / (c3 - L^-2) + c4 / (c5 - L^-2) + ...
    7  Herzberger             n       = c1 + c2 / (L^2 - 0.028) + c3 / (L^2 - 0.028)^2
                                     + c4 L^2 + c5 L^4 + c6 L^6
    8  Retro                  (n^2 - 1) / (n^2 + 2) = c1 + c2 L^2 / (L^2 - c3) + c4 L^2
    9  Exotic                 n^2     = c1 + c2 / (L^2 - c3) + c4 (L - c5) / ((L - c5)^2 + c6)

Source: M. Polyanskiy, "Dispersion formulas", in the doc folder of the refractiveindex.info database.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import chain

import numpy as np

Coefficients = tuple[float, ...]

HERZBERGER_POLE = 0.028
"""Square of the mean ultraviolet resonance wavelength, um^2 (Herzberger, Opt. Acta 6, 197 (1959))."""


def sellmeier(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 1: the poles are given as wavelengths."""
    squared = wavelength_um**2
    terms = (b * squared / (squared - c**2) for b, c in _pairs(coefficients))
    return np.sqrt(_sum(1 + coefficients[0], terms, wavelength_um))


def sellmeier_2(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 2: the poles are given as squared wavelengths. SCHOTT's form."""
    squared = wavelength_um**2
    terms = (b * squared / (squared - c) for b, c in _pairs(coefficients))
    return np.sqrt(_sum(1 + coefficients[0], terms, wavelength_um))


def polynomial(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 3: SCHOTT's old form, still that of HOYA, HIKARI and SUMITA."""
    return np.sqrt(cauchy(wavelength_um, coefficients))


def refractiveindex_info(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 4: up to two resonances, then powers."""
    squared = wavelength_um**2
    resonances = (coefficients[start : start + 4] for start in range(1, min(len(coefficients), 9), 4))
    terms = (b * wavelength_um**power / (squared - c**d) for b, power, c, d in resonances)
    powers = (b * wavelength_um**power for b, power in _pairs(coefficients[8:]))
    return np.sqrt(_sum(coefficients[0], chain(terms, powers), wavelength_um))


def cauchy(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 5: a sum of powers."""
    terms = (b * wavelength_um**power for b, power in _pairs(coefficients))
    return _sum(coefficients[0], terms, wavelength_um)


def gases(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 6: resonances in wavenumber; relative to vacuum."""
    wavenumber_squared = wavelength_um**-2.0
    terms = (b / (c - wavenumber_squared) for b, c in _pairs(coefficients))
    return _sum(1 + coefficients[0], terms, wavelength_um)


def herzberger(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 7: a fixed ultraviolet pole and an infrared polynomial."""
    c1, c2, c3, *powers = coefficients
    squared = wavelength_um**2
    pole = 1 / (squared - HERZBERGER_POLE)
    return c1 + c2 * pole + c3 * pole**2 + sum(c * squared ** (1 + k) for k, c in enumerate(powers))


def retro(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 8: dispersion of the molar refraction (n^2 - 1) / (n^2 + 2)."""
    c1, c2, c3, c4 = coefficients
    squared = wavelength_um**2
    refraction = c1 + c2 * squared / (squared - c3) + c4 * squared
    return np.sqrt((1 + 2 * refraction) / (1 - refraction))


def exotic(wavelength_um: np.ndarray, coefficients: Coefficients) -> np.ndarray:
    """Formula 9: one resonance and one absorption line."""
    c1, c2, c3, c4, c5, c6 = coefficients
    offset = wavelength_um - c5
    return np.sqrt(c1 + c2 / (wavelength_um**2 - c3) + c4 * offset / (offset**2 + c6))


FORMULAS: dict[int, Callable[[np.ndarray, Coefficients], np.ndarray]] = {
    1: sellmeier,
    2: sellmeier_2,
    3: polynomial,
    4: refractiveindex_info,
    5: cauchy,
    6: gases,
    7: herzberger,
    8: retro,
    9: exotic,
}

CIDDOR = (0.0, 0.05792105, 238.0185, 0.00167917, 57.362)
"""Formula 6 for dry air with 450 ppm CO2 at 15 C, 101325 Pa; um^-2. Ciddor, Appl. Opt. 35, 1566 (1996)."""

DENSITY_20_C = 288.15 / 293.15
"""Density of air at 20 C, where glasses are measured, over that at 15 C and the same pressure (ideal gas)."""


def air_index(wavelength_um: np.ndarray) -> np.ndarray:
    """Index of dry air relative to vacuum at 20 C, 101325 Pa: what "relative to air" divides by.

    wavelength_um: micrometres; Ciddor's equation holds from 0.23 to 1.69 um and is flat beyond.

    >>> print(round(float(air_index(np.array(0.5875618))), 7))
    1.0002724
    """
    return 1 + DENSITY_20_C * (gases(wavelength_um, CIDDOR) - 1)


def _pairs(coefficients: Coefficients) -> Iterator[tuple[float, float]]:
    """(c2, c3), (c4, c5), ...: what follows the constant term."""
    return zip(coefficients[1::2], coefficients[2::2], strict=True)


def _sum(constant: float, terms: Iterable[np.ndarray], wavelength_um: np.ndarray) -> np.ndarray:
    """constant + terms, of the shape of the wavelength even without a term."""
    return sum(terms, start=np.full_like(wavelength_um, constant))
