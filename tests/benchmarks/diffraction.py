"""Section diffraction: third order, transfer functions and point spreads, against Optiland."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np

import lenstrace
from tests.benchmarks import launched, peers
from tests.benchmarks.paired import interleaved, repeated
from tests.benchmarks.table import Table

ROUNDS = 5
TIMES = 5  # calls of lenstrace in one timing
SAMPLES = 64  # across the pupil, of lenstrace; of both for the point spread by direct integration
FREQUENCIES = np.linspace(0.0, 200.0, 41)  # cycles/mm


def diffraction() -> Table:
    """Warm calls from Python; the double Gauss, 3 fields and 3 wavelengths."""
    lens = launched.double_gauss()
    one = lens.replace(
        fields=lenstrace.Fields((0.0,), (0.0,), "angle"), wavelengths=lenstrace.Wavelengths((1.0,), (0.5876,), 0)
    )
    calls: dict[str, Any] = {
        "lenstrace seidel": repeated(_ready(lambda: lenstrace.seidel(lens)), TIMES),
        "lenstrace mtf": repeated(_ready(lambda: lenstrace.mtf(lens, FREQUENCIES, samples=SAMPLES)), TIMES),
        "lenstrace huygens": _ready(lambda: lenstrace.psf(one, samples=SAMPLES, method="huygens")),
    }
    times = {"lenstrace seidel": TIMES, "lenstrace mtf": TIMES, "lenstrace huygens": 1}
    missing = peers.absent("optiland")
    if not missing:
        from optiland.mtf import FFTMTF
        from optiland.psf import HuygensPSF

        optic = peers.optiland_double_gauss()
        waves = lens.wavelengths.um
        calls["Optiland seidel"] = optic.aberrations.seidels
        calls["Optiland mtf"] = lambda: [FFTMTF(optic, wavelength=um) for um in waves]
        calls["Optiland huygens"] = lambda: HuygensPSF(
            optic, field=(0, 0), wavelength=0.5876, num_rays=SAMPLES, image_size=2 * SAMPLES
        )
        times |= {"Optiland seidel": 1, "Optiland mtf": 1, "Optiland huygens": 1}
    seconds = interleaved(calls, ROUNDS)
    table = Table("diffraction: warm calls from Python, double Gauss, 3 fields x 3 wavelengths", notes=missing)
    each = {name: values * 1e3 / times[name] for name, values in seconds.items()}
    for name, values in each.items():
        table.time(name, values, "ms")
    if not missing:
        for name, least in (("seidel", 10.0), ("mtf", 20.0), ("huygens", 50.0)):
            ours, theirs = each[f"lenstrace {name}"], each[f"Optiland {name}"]
            table.compare(f"{name}: Optiland / lenstrace", theirs, ours, at_least=least)
    table.notes.append(
        f"mtf: {len(FREQUENCIES)} frequencies, {SAMPLES} samples across the pupil; Optiland's default 128"
    )
    table.notes.append(
        f"huygens: one field and wavelength, {2 * SAMPLES} x {2 * SAMPLES} points, {SAMPLES} across the pupil"
    )
    return table


def _ready(call: Any) -> Any:
    return lambda: jax.block_until_ready(call())
