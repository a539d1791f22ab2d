"""Longitudinal chromatic aberration, and the doublet that cures it.

A thin lens of focal length f and Abbe number V = (n_d - 1) / (n_F - n_C) has at any wavelength the focal length
f (n_d - 1) / (n - 1): C light is focused farther than F light by about f / V. Two in contact, of the powers

    phi_1 = phi V1 / (V1 - V2),      phi_2 = -phi V2 / (V1 - V2),

have one focus for F and C. What they leave is the secondary spectrum: between d and F their power differs by
phi (P1 - P2) / (V1 - V2), with the partial dispersions P = (n_F - n_d) / (n_F - n_C).
Source: Smith, Modern Optical Engineering (4th ed.), section 16.1; Hecht, Optics (5th ed.), section 6.3.2.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from lenstrace.analysis.colour import longitudinal_aberration
from lenstrace.errors import OptionError
from lenstrace.optics.glasses import glass
from lenstrace.optics.media import LINE_C, LINE_D, LINE_F
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.prescription import lens

SPECTRUM = np.linspace(0.42, 0.68, 53)  # um, of the plot
LINES = (LINE_F, LINE_D, LINE_C)
WAVELENGTHS = np.array([*LINES, *SPECTRUM])
ALIKE = 1.0  # two glasses whose Abbe numbers differ by less make no useful doublet
ROUNDING = 1e-12  # of a focal length, and of a share of one
BEAM = 1e-3  # of the focal length: a beam; the rays that count are beside the axis


@result
class Achromat(Demonstration):
    """Focal shift against wavelength; mm.

    wavelengths:      (Q,), um.
    singlet, doublet: (Q,), focal length at each less that of d light, traced.
    singlet_theory, doublet_theory:  (Q,), by the equation of thin lenses.
    lines:            the wavelengths F, d, C, um.
    """

    wavelengths: np.ndarray
    singlet: np.ndarray
    doublet: np.ndarray
    singlet_theory: np.ndarray
    doublet_theory: np.ndarray
    lines: tuple[float, float, float]


@demonstration
def achromat(
    focal_length: Annotated[float, Option("focal length at the d line", "mm", not_zero=True, slider=(20, 500))] = 100.0,
    crown: Annotated[str, Option("glass of the first lens, and of the singlet")] = "N-BK7",
    flint: Annotated[str, Option("glass of the second lens")] = "N-SF5",
) -> Achromat:
    """Colour of a single lens, and the doublet that cures it.

    UnknownGlassError for a glass that no catalogue has; OptionError for two of nearly the same Abbe number.
    """
    first, second = (_dispersion(name) for name in (crown, flint))
    if abs(first.abbe - second.abbe) < ALIKE:
        raise OptionError(
            f"achromat: {crown} and {flint} have nearly the same Abbe number, {first.abbe:.4g} and {second.abbe:.4g}; "
            "choose two that differ by more"
        )
    power = 1 / focal_length
    powers = power * np.array([first.abbe, -second.abbe]) / (first.abbe - second.abbe)
    single, front = power / 2 / (first.d - 1), powers[0] / 2 / (first.d - 1)
    singlet = _focal_lengths([(single, crown), (-single, None)], focal_length)
    doublet = _focal_lengths(
        [(front, crown), (-front, flint), (-front - powers[1] / (second.d - 1), None)], focal_length
    )
    growth = [(each.n - 1) / (each.d - 1) for each in (first, second)]
    singlet_theory, doublet_theory = 1 / (power * growth[0]), 1 / (powers @ np.array(growth))
    f, d, c = range(3)  # places of the lines F, d, C
    apart, apart_theory = singlet[c] - singlet[f], singlet_theory[c] - singlet_theory[f]
    spread = singlet[d] / singlet[f] - singlet[d] / singlet[c]
    left = doublet[d] / doublet[f] - 1
    left_theory = (first.partial - second.partial) / (first.abbe - second.abbe)
    within = ROUNDING * abs(focal_length)
    return Achromat(
        setting=f"thin lenses of focal length {focal_length:g} mm: {crown} (V = {first.abbe:.2f}) alone, and with "
        f"{flint} (V = {second.abbe:.2f})",
        rows=(
            Comparison("singlet: C light focuses behind F light by", "mm", apart, apart_theory, within),
            Comparison("singlet: powers in F less in C light, of that in d", "", spread, 1 / first.abbe),
            Comparison("doublet: focal length in d light", "mm", doublet[d], focal_length),
            Comparison("doublet: C light focuses behind F light by", "mm", doublet[c] - doublet[f], 0.0, within),
            Comparison("doublet: power in F less in d light, of that in d", "", left, left_theory, ROUNDING),
        ),
        wavelengths=SPECTRUM,
        singlet=singlet[3:] - singlet[d],
        doublet=doublet[3:] - doublet[d],
        singlet_theory=singlet_theory[3:] - singlet_theory[d],
        doublet_theory=doublet_theory[3:] - doublet_theory[d],
        lines=LINES,
    )


class _Dispersion(NamedTuple):
    """Index at all wavelengths, index at d, Abbe number, partial dispersion of a glass."""

    n: np.ndarray
    d: float
    abbe: float
    partial: float


def _dispersion(name: str) -> _Dispersion:
    n = np.asarray(glass(name).index(WAVELENGTHS))
    f, d, c = map(float, n[:3])
    return _Dispersion(n, d, (d - 1) / (f - c), (f - d) / (f - c))


def _focal_lengths(surfaces: list[tuple[float, str | None]], focal_length: float) -> np.ndarray:
    """At all wavelengths, of surfaces (curvature, glass behind) without distances: by rays near the axis."""
    rows = [
        {"curvature": curvature, **({} if name is None else {"glass": name}), **({} if i else {"stop": True})}
        for i, (curvature, name) in enumerate(surfaces)
    ]
    thin = lens(rows, {"entrance_pupil_diameter": BEAM * abs(focal_length)}, [0.0], list(WAVELENGTHS))
    return np.asarray(longitudinal_aberration(thin, points=2).z)[0]
