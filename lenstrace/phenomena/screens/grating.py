"""A linear grating: the orders of its light, in transmission and in reflection.

Lines a period p apart add the path m lambda x / p to the light of order m. Its tangential momentum obeys the grating
equation, and its path along them nothing changes:

    n2 sin b = n1 sin a + m lambda / p,

the mirror of course with n2 = n1. An order whose sine is above 1 does not exist.
Source: Born & Wolf, Principles of Optics (7th ed.), section 8.6.1.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Annotated, Any

import numpy as np

from lenstrace.analysis.rays import ray, trace
from lenstrace.errors import OptionError
from lenstrace.optics.screens.grating import Grating as GratingScreen
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration, positive_index
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

SINE = 1e-14  # of a sine: rounding
GRAZING = 1e-10  # of the sine, from 1: an order along the grating is left out, for rounding decides whether it exists
MOST = 40  # orders on either side that are looked for
SPECTRUM = np.linspace(0.4, 0.7, 7)  # um, for the plot of colours


@result
class Grating(Demonstration):
    """The orders of a grating.

    incidence:    radians.
    orders:       (M,), whole numbers.       transmitted, reflected: (M,), angles against the normal, radians; nan
                  where an order does not exist; positive toward +y.
    spectrum:     (Q,), wavelengths, um.     spectra: (M, Q), transmitted angles of the orders at these, radians.
    """

    incidence: float
    orders: np.ndarray
    transmitted: np.ndarray
    reflected: np.ndarray
    spectrum: np.ndarray
    spectra: np.ndarray


@demonstration
def grating(
    period: Annotated[float, Option("distance of the lines", "um", above=0, most=1e4, slider=(0.3, 5))] = 2.0,
    wavelength: Annotated[float, Option("wavelength", "um", least=0.1, most=20, slider=(0.4, 0.7))] = 0.55,
    angle: Annotated[float, Option("angle of incidence", "deg", above=-90, below=90, slider=(-80, 80))] = 20.0,
    index: Annotated[float, positive_index("refractive index behind the grating", (1, 2))] = 1.5,
    orders: Annotated[int, Option("orders shown on either side", least=0, most=MOST)] = 3,
) -> Grating:
    """A grating: its orders through it and back, against the grating equation.

    OptionError where none of the orders exists.
    """
    numbers = list(range(-orders, orders + 1))
    incident = math.sin(math.radians(angle))
    rows, angles = [], {}
    for name, behind in (("transmitted", {"index": index}), ("reflected", {"mirror": True})):
        plate = _plate(period, behind)
        found = np.array([_sine(plate, number, wavelength, angle) for number in numbers])
        theory = (incident + np.array(numbers) * wavelength / period) / behind.get("index", 1.0)
        for number, measured, expected in zip(numbers, found, theory, strict=True):
            exists = abs(expected) < 1
            if abs(abs(expected) - 1) > GRAZING and (exists or not np.isnan(measured)):
                quantity = f"sine of the {name} order {number:+d}" if number else f"sine of the {name} order 0"
                rows.append(Comparison(quantity, "", measured, expected if exists else np.nan, SINE))
        angles[name] = np.arcsin(found)
    if not rows:
        raise OptionError(f"grating: no order from {-orders} to {orders} exists; take a longer period, or more orders")
    plate = _plate(period, {"index": index})
    spectra = [[_sine(plate, number, um, angle) for um in SPECTRUM] for number in numbers]
    return Grating(
        setting=f"a grating of {1000 / period:g} lines a mm between air and an index of {index:g}, light of "
        f"{wavelength:g} um at {angle:g} deg",
        rows=tuple(rows),
        incidence=math.radians(angle),
        orders=np.array(numbers),
        spectrum=SPECTRUM,
        spectra=np.arcsin(np.array(spectra)),
        **angles,
    )


def _plate(period: float, behind: dict[str, Any]) -> Lens:
    """The grating alone, lines along x; period in um."""
    screen = {"grating": {"period": period * 1e-3, "angle": 90.0}}
    return lens([{"stop": True, "screen": screen, **behind}], {"entrance_pupil_diameter": 1.0}, [0.0], [0.55])


def _sine(plate: Lens, order: int, wavelength: float, angle: float) -> float:
    """Of one order behind the grating, against its normal; nan where it does not exist. angle: degrees."""
    thin = plate[1].screen
    assert isinstance(thin, GratingScreen)
    one = plate.replace(surface=1, screen=dataclasses.replace(thin, order=float(order)))
    start = ray((0.0, 0.0, 0.0), (0.0, math.sin(math.radians(angle)), math.cos(math.radians(angle))))
    end = trace(one, rays=start, wavelength=wavelength)
    return float(end.m[1]) if end.ok[1] else math.nan
