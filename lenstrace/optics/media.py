"""Media: the refractive index relative to air (air = 1 exactly) at a wavelength in micrometres.

Air, a table and a catalogue formula are fixed; `Constant` and `AbbeModel` are pytrees whose numbers an
optimizer may change, so their formulas use nothing but arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import jax
import numpy as np
from numpy.typing import ArrayLike

from lenstrace.compute.pytree import pytree
from lenstrace.errors import MediumError, WavelengthError
from lenstrace.optics.dispersion import FORMULAS, Coefficients, air_index
from lenstrace.optics.interpolation import interpolate

LINE_D, LINE_F, LINE_C, LINE_G = 0.5875618, 0.4861327, 0.6562725, 0.4358343
"""Wavelengths of the helium d, hydrogen F and C, and mercury g lines, um (ISO 7944)."""

NORMAL_LINE = (0.6438, -0.001682)
"""P_gF = 0.6438 - 0.001682 vd, the line through K7 and F2. Source: SCHOTT technical information TIE-29."""

CONRADY_POWER = -3.5
"""n = A + B / L + C / L^3.5. Source: Conrady, Applied Optics and Optical Design II (Dover 1960)."""

ABBE_RANGE_UM = (0.35, 1.1)
"""Where `AbbeModel` answers; beyond, two numbers say too little about a glass."""

RANGE_TOLERANCE = 1e-9
"""A wavelength this close, relatively, to the end of a range is on it: rounding in a change of units."""

UNLIMITED = (0.0, float("inf"))


class Medium(Protocol):
    """What every medium offers."""

    @property
    def name(self) -> str:
        """What a table of surfaces shows."""
        ...

    def index(self, wavelength_um: ArrayLike) -> Any:
        """Index relative to air, of the shape of `wavelength_um` (micrometres); else a WavelengthError."""
        ...


@jax.tree_util.register_static
@dataclass(frozen=True)
class Air:
    """The reference: index 1 at every wavelength."""

    name: str = "air"

    def index(self, wavelength_um: ArrayLike) -> Any:
        """Ones. A wavelength that is not positive and finite is a WavelengthError."""
        return np.ones_like(checked_wavelength(self.name, wavelength_um, UNLIMITED))[()]


AIR = Air()


@pytree
class Constant:
    """One index at every wavelength; it may be negative. `n` is a leaf.

    >>> Constant(1.5).name, float(Constant(1.5).index(0.55))
    ('n=1.5', 1.5)
    """

    n: Any

    @property
    def name(self) -> str:
        """The number itself: "n=1.5"."""
        return f"n={float(self.n):g}"

    def index(self, wavelength_um: ArrayLike) -> Any:
        """`n` in the shape of `wavelength_um`; a wavelength not positive and finite is a WavelengthError."""
        return self.n * np.ones_like(checked_wavelength("constant index", wavelength_um, UNLIMITED))[()]


@pytree
class AbbeModel:
    """A normal glass known by its index `nd` and Abbe number `vd` alone; both are leaves.

    Conrady's form n = A + B / L + C / L^3.5, made to hold n(d) = nd and n(F) - n(C) = (nd - 1) / vd exactly
    and to have its partial dispersion (n(g) - n(F)) / (n(F) - n(C)) on the normal line 0.6438 - 0.001682 vd:

        n = nd + (nd - 1) / vd (u + (a + b vd) v)

    with u, v fixed functions of the wavelength, both 0 at d, u(F) - u(C) = 1, v(F) = v(C).

    Error over the 156 glasses of SCHOTT's optical catalogue, given their nd and vd, every 5 nm from 0.42 to
    0.70 um: rms 1.3e-4, at most 2.8e-3 (P-SF68, a glass far off the normal line); half of the glasses stay
    within 1.8e-4. Over all of 0.35 to 1.1 um: rms 3.9e-4, at most 6.8e-3. Outside that: WavelengthError.

    >>> glass = AbbeModel(1.5168, 64.17)
    >>> glass.name, round(float(glass.index(0.5875618)), 9)
    ('nd=1.5168 vd=64.17', 1.5168)
    """

    nd: Any
    vd: Any

    @property
    def name(self) -> str:
        """Both numbers: "nd=1.62 vd=60.3"."""
        return f"nd={float(self.nd):g} vd={float(self.vd):g}"

    def index(self, wavelength_um: ArrayLike) -> Any:
        """Index in the shape of `wavelength_um`; outside 0.35 to 1.1 um a WavelengthError."""
        wavelength = checked_wavelength("Abbe-number model", wavelength_um, ABBE_RANGE_UM)
        inverse, partial = _conrady_basis(wavelength)
        return self.nd + (self.nd - 1.0) / self.vd * (inverse + (_OFFSET + _SLOPE * self.vd) * partial)


@jax.tree_util.register_static
@dataclass(frozen=True)
class Table:
    """Indices `n` at the wavelengths `um`, in any order: exactly those at its nodes, smooth between them.

    Between: a cubic in 1 / L^2, in which the index of a glass is nearly straight (from the nodes F, d, C of
    N-BK7 and SF5 the worst error is 2e-5 and 3e-5; with L itself 1e-4 and 3e-4); a straight line with two
    nodes. It never leaves the range of its two neighbours, as a plain spline does on noisy measurements. A
    single node is known at its own wavelength only. Outside the nodes: WavelengthError.

    >>> print(Table((0.4861, 0.5876, 0.6563), (1.63, 1.62, 1.61)).index(0.5876))
    1.62
    """

    um: tuple[float, ...]
    n: tuple[float, ...]
    name: str = "table"
    catalog: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        """Refuse what is no table: MediumError."""
        if not self.um or len(self.um) != len(self.n):
            raise MediumError(
                f"{self.name}: an index table needs as many indices as wavelengths, at least one; "
                f"got {len(self.n)} n and {len(self.um)} um"
            )
        if len(set(self.um)) != len(self.um):
            raise MediumError(f"{self.name}: every wavelength of a table may stand once, got um = {self.um}")
        checked_wavelength(self.name, self.um, UNLIMITED)

    @property
    def range_um(self) -> tuple[float, float]:
        """Shortest and longest wavelength."""
        return min(self.um), max(self.um)

    def index(self, wavelength_um: ArrayLike) -> Any:
        """Index in the shape of `wavelength_um`, micrometres."""
        wavelength = np.clip(checked_wavelength(self.name, wavelength_um, self.range_um), *self.range_um)
        if len(self.um) == 1:
            return np.full_like(wavelength, self.n[0])[()]
        nodes = np.asarray(self.um) ** -2.0
        order = np.argsort(nodes)
        at = np.clip(wavelength**-2.0, nodes[order[0]], nodes[order[-1]])
        return interpolate(nodes[order], np.asarray(self.n, dtype=float)[order], at)[()]


@jax.tree_util.register_static
@dataclass(frozen=True)
class Formula:
    """A dispersion formula (`number` and `coefficients` as in `dispersion`), as a maker or a paper gives it.

    range_um: shortest and longest wavelength it holds for; outside: WavelengthError. catalog, source: who
    says so. absolute: True where the coefficients give the index relative to vacuum; it is then divided by
    air's.
    """

    number: int
    coefficients: Coefficients
    range_um: tuple[float, float]
    name: str = "formula"
    catalog: str = ""
    source: str = ""
    absolute: bool = False

    def __post_init__(self) -> None:
        """Refuse an unknown formula: MediumError."""
        if self.number not in FORMULAS:
            raise MediumError(f"{self.name}: dispersion formulas are numbered 1 to 9, got {self.number}")

    def index(self, wavelength_um: ArrayLike) -> Any:
        """Index in the shape of `wavelength_um`, micrometres; MediumError where it is not real."""
        wavelength = checked_wavelength(self.name, wavelength_um, self.range_um)
        with np.errstate(invalid="ignore", divide="ignore"):
            n = FORMULAS[self.number](wavelength, self.coefficients)
        if not np.all(np.isfinite(n)):
            raise MediumError(f"{self.name}: formula {self.number} has no real index at {wavelength} um")
        return (n / air_index(wavelength) if self.absolute else n)[()]


def checked_wavelength(name: str, wavelength_um: ArrayLike, range_um: tuple[float, float]) -> np.ndarray:
    """The wavelengths as float64; a WavelengthError names the medium and the first one outside the range."""
    wavelength = np.asarray(wavelength_um, dtype=np.float64)
    low, high = range_um
    inside = (
        (wavelength > 0)
        & np.isfinite(wavelength)
        & (wavelength >= low * (1 - RANGE_TOLERANCE))
        & (wavelength <= high * (1 + RANGE_TOLERANCE))
    )
    if np.all(inside):
        return wavelength
    got = float(wavelength[~inside].flat[0])
    if not (got > 0 and np.isfinite(got)):
        raise WavelengthError(f"{name}: a wavelength must be positive and finite, in micrometres, got {got:g}")
    micrometres = got / 1000
    if low <= micrometres <= high:
        advice = f"{got:g} looks like nanometres: write {micrometres:g} (micrometres)"
    else:
        advice = "choose a wavelength within it, or another medium"
    raise WavelengthError(f"{name}: wavelength {got:g} um is outside its range, {low:g} to {high:g} um; {advice}")


def _conrady_basis(wavelength: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """u and v of `AbbeModel`: 1 / L scaled to u(F) - u(C) = 1, the same of 1 / L^3.5 less u; both 0 at d."""
    inverse = _scaled(wavelength, -1.0)
    return inverse, _scaled(wavelength, CONRADY_POWER) - inverse


def _scaled(wavelength: np.ndarray, power: float) -> np.ndarray:
    return (wavelength**power - LINE_D**power) / (LINE_F**power - LINE_C**power)


def _normal_line_coefficients() -> tuple[float, float]:
    """a and b of `AbbeModel`, from u(g) - u(F) + (a + b vd) (v(g) - v(F)) = P_gF."""
    inverse, partial = _conrady_basis(np.array([LINE_G, LINE_F]))
    drop = float(partial[0] - partial[1])
    return (NORMAL_LINE[0] - float(inverse[0] - inverse[1])) / drop, NORMAL_LINE[1] / drop


_OFFSET, _SLOPE = _normal_line_coefficients()
