"""Longitudinal colour of a thin lens, and the doublet of two glasses that cures it.

With V = (n_d - 1) / (n_F - n_C) and P = (n_F - n_d) / (n_F - n_C) of a glass, a thin lens of power phi = 1 / f at d has

    phi(L) = phi (n(L) - 1) / (n_d - 1),      phi_F - phi_C = phi / V,      f_F - f_C = -f / V + ...,

and two in contact, of the powers

    phi1 = phi V1 / (V1 - V2),      phi2 = -phi V2 / (V1 - V2),

one focal length at F and C, and another at d:  phi_F - phi_d = phi (P1 - P2) / (V1 - V2), the secondary spectrum.
Source: Kingslake & Johnson, Lens Design Fundamentals (2010), chapter 5; Born & Wolf, section 4.7.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.errors import MediumError, OptionError
from lenstrace.optics.glasses import glass
from lenstrace.optics.media import LINE_C, LINE_D, LINE_F
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.lenses.near_axis import neighbours
from lenstrace.phenomena.options import Option, demonstration, length_of_either_sign
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

WHERE = "achromat"
LINES = np.array([LINE_F, LINE_D, LINE_C])  # micrometres
SPECTRUM = np.linspace(0.44, 0.7, 27)  # micrometres: visible, and known of most plastics too
ROUNDING = 1e-14  # of the powers that are added up
SAME = 1e-6  # of an Abbe number: two that differ by less need lenses of a million times the power
SECOND = 2.0  # times the square of a relative shift: what is left out of its first order, at most


@result
class Achromat(Demonstration):
    """Focal lengths of the singlet and of the doublet, mm.

    glasses:        names of the two.
    wavelengths:    (W,), micrometres.
    shifts, shifts_theory:  (2, W), f(L) - f_d, of the singlet and of the doublet.
    """

    glasses: tuple[str, str]
    wavelengths: np.ndarray
    shifts: np.ndarray
    shifts_theory: np.ndarray


class _Glass(NamedTuple):
    """A glass: its name, Abbe number, partial dispersion, and (n(L) - 1) / (n_d - 1) at LINES and along SPECTRUM."""

    name: str
    abbe: float
    partial: float
    n_d: float
    power: np.ndarray


@demonstration
def achromat(
    focal_length: Annotated[float, length_of_either_sign("focal length at d", slider=(20, 500))] = 100.0,
    crown: Annotated[str, Option("glass of the singlet and of the first lens of the doublet")] = "N-BK7",
    flint: Annotated[str, Option("glass of the second lens of the doublet")] = "F2",
) -> Achromat:
    """An achromatic doublet: two glasses cure the colour of one.

    OptionError for a name that is no glass, for one that is not known for all visible light, and for two glasses of one
    Abbe number.
    """
    one, two = _read(crown, "crown"), _read(flint, "flint")
    v1, v2 = one.abbe, two.abbe
    if abs(v1 - v2) <= SAME * abs(v1):
        raise OptionError(f"{WHERE}: both glasses have the Abbe number {v1:.4g}; take two that differ in it")
    f, phi = focal_length, 1 / focal_length
    powers = np.array([[phi, 0.0], [phi * v1 / (v1 - v2), -phi * v2 / (v1 - v2)]])
    # both sides of the crown alike, the flint cemented to it
    front = powers[:, 0] / (one.n_d - 1) / 2
    curvatures = np.column_stack([front, -front, -front - powers[:, 1] / (two.n_d - 1)])
    waves = [*LINES, *SPECTRUM]
    lenses = [_thin(curvatures[0], crown, "air", waves), _thin(curvatures[1], crown, flint, waves)]
    indices = np.array([np.asarray(each.system.index) for each in lenses])
    measured = np.asarray(_focal_lengths(lenses[1], curvatures, indices))
    theory = 1 / (powers[:, :1] * one.power + powers[:, 1:] * two.power)

    x = (one.partial - two.partial) / (v1 - v2)
    # of 1 / f against phi, and of f
    noise = ROUNDING * np.array([1.0, abs(powers[1]).sum() * abs(f)])
    within = 2 * noise[:, None] * theory**2 / abs(f)
    rows = []
    for i, name in enumerate(("singlet", "doublet")):
        for k, line in enumerate("FdC"):
            what = f"{name}: focal length at {line}"
            rows.append(Comparison(what, "mm", measured[i, k], theory[i, k], within[i, k]))
    (f_f, _, f_c), (g_f, g_d, g_c) = measured[:, :3]
    first = SECOND * abs(f)
    rows += [
        Comparison(
            "singlet: difference of the powers at F and C, by that at d", "", f * (1 / f_f - 1 / f_c), 1 / v1, noise[0]
        ),
        Comparison("singlet: colour, f_F - f_C, to first order", "mm", f_f - f_c, -f / v1, first / v1**2),
        Comparison("doublet: colour, f_F - f_C", "mm", g_f - g_c, 0.0, 2 * abs(f) * noise[1]),
        Comparison("doublet: secondary spectrum, in power", "", f * (1 / g_f - 1 / g_d), x, 2 * noise[1]),
        Comparison("doublet: secondary spectrum, f_F - f_d, to first order", "mm", g_f - g_d, -f * x, first * x * x),
    ]
    return Achromat(
        setting=f"thin lenses of the focal length {f:g} mm: one of {one.name} (V = {v1:.2f}), and one of it "
        f"with one of {two.name} (V = {v2:.2f})",
        rows=tuple(rows),
        glasses=(one.name, two.name),
        wavelengths=SPECTRUM,
        shifts=measured[:, 3:] - measured[:, 1:2],
        shifts_theory=theory[:, 3:] - f,
    )


def _read(name: str, which: str) -> _Glass:
    try:
        medium = glass(name)
        n = np.asarray(medium.index(np.append(LINES, SPECTRUM)), float)
    except MediumError as error:
        raise OptionError(f"{WHERE}: {which} must be a glass that is known for visible light: {error}") from None
    n_f, n_d, n_c = n[:3]
    if n_f == n_c:
        raise OptionError(f"{WHERE}: {which} must be a glass that disperses light, got {name!r}")
    return _Glass(medium.name, (n_d - 1) / (n_f - n_c), (n_f - n_d) / (n_f - n_c), n_d, (n - 1) / (n_d - 1))


def _thin(curvatures: np.ndarray, first: str, second: str, waves: list[float]) -> Lens:
    """Two lenses without thickness in contact."""
    rows = [{"curvature": c, "glass": name} for c, name in zip(curvatures, (first, second, "air"), strict=True)]
    rows[0]["stop"] = True
    return lens(rows, {"entrance_pupil_diameter": 1.0}, [0.0], {"um": waves, "primary": LINE_D})


@jax.jit
def _focal_lengths(template: Lens, curvatures: jax.Array, indices: jax.Array) -> jax.Array:
    """(L, W) of L lenses, by real rays near the axis; curvatures: (L, 3), indices: (L, W, 4)."""

    def focal_length(curvature: jax.Array, index: jax.Array) -> jax.Array:
        made = template.replace(curvature=curvature)
        for surface in (1, 2, 3):
            made = made.replace(surface=surface, index=index[surface])
        return -1 / neighbours(made, jnp.ones(1), jnp.zeros(1)).slope[-1, 0]

    return jax.vmap(jax.vmap(focal_length, (None, 0)))(curvatures, indices)
