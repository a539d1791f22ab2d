"""The tracer at its named extremes: backward errors against the judge, and what each extreme must contain."""

from __future__ import annotations

import numpy as np
import pytest

import lenstrace
from lenstrace import RayStatus
from lenstrace.analysis.extremes.cases import cases
from lenstrace.analysis.extremes.judging import Errors, extremes, judged

MOST = 16.0  # C for each surface crossed; and for a whole lens of up to 20 surfaces
SHORT = 20
LAUNCHED = 4.0
GRADIENT = 64.0  # of derivatives, for each surface crossed
PRECISIONS = ("float32", "float64")
CASES = {case.name: case for case in cases()}


@pytest.mark.parametrize("name", CASES)
def test_the_named_extremes(name: str) -> None:
    found = judged(CASES[name])
    for errors in (found.float32, found.float64):
        assert errors.finite
        assert errors.gradients_finite
        assert errors.statuses
        assert errors.surface <= MOST
        assert errors.course <= MOST or found.surfaces > SHORT
        assert errors.launch <= LAUNCHED
        # at a rim and a tangency a derivative may be infinite
        assert errors.gradients > 0 or "rim" in name or "tangent" in name
        assert errors.gradient is None or errors.gradient <= GRADIENT * found.surfaces
    assert found.exact is not False
    assert (found.exact is None) == (not CASES[name].scales and not CASES[name].afocal)


def test_every_extreme_is_run_and_progress_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    fine = Errors(1.0, 1.0, 0.0, True, True, True, 1.0, 1)
    monkeypatch.setattr("lenstrace.analysis.extremes.judging._errors", lambda *_: fine)
    monkeypatch.setattr("lenstrace.analysis.extremes.judging._scales", lambda *_: True)
    told: list[tuple[int, int, str]] = []
    found = extremes(lambda *progress: told.append(progress))
    assert [extreme.name for extreme in found] == list(CASES)
    assert told == [*((i, len(CASES), name) for i, name in enumerate(CASES)), (len(CASES), len(CASES), "")]


def test_an_asphere_is_met_at_its_rim_or_said_not_to_be() -> None:
    """Where its rays have no root or two they are lost; those that arrive are on the sheet through the vertex."""
    lost = 0
    for trial in CASES["asphere r^16 at its rim"].trials:
        assert trial.rays is not None
        x, y, z, l, m, n = trial.rays.T
        path = lenstrace.trace(trial.lens, lenstrace.ray((x, y, z), (l, m, n)))
        number, status = np.divmod(np.asarray(path.failure)[-1], 8)
        lost += int(((number == 1) & np.isin(status, (RayStatus.MISSED, RayStatus.NOT_CONVERGED))).sum())
        r = np.hypot(np.asarray(path.x)[1], np.asarray(path.y)[1])[number != 1]
        assert (r <= 10.0).all()
        terms = trial.lens[1].asphere
        sag = r * r / (10 + np.sqrt(100 - r * r)) + sum(a * r**power for power, a in terms.items())
        # toward the rim the sheet stands upright: a rounding of r is a larger one of z
        steep = r / np.sqrt(100 - r * r)
        assert (np.abs(np.asarray(path.z)[1][number != 1] - sag) <= 1e-13 * (1 + steep)).all()
    assert lost > 0


@pytest.mark.parametrize("precision", PRECISIONS)
def test_no_step_at_a_boundary_is_lost_to_rounding(precision: str) -> None:
    for name in ("index ratio 1 +- 1e-12, 1 +- 4 eps", "index -1, -1 +- 1e-9, -1 +- 4 eps"):
        own = [trial for trial in CASES[name].trials if trial.precision == precision]
        indices = [float(trial.lens.astype(precision).system.index[0, 1]) for trial in own]
        assert len(set(indices)) == len(own) == 2
        assert min(abs(abs(index) - 1) for index in indices) == 4 * np.finfo(precision).eps
    for name in (
        "tangent to a sphere within 1e-4 ... 1e-12",
        "at the critical angle within 1e-12 ... 1e-4",
        "critical angle inside a sphere",
    ):
        (own,) = (trial for trial in CASES[name].trials if trial.precision == precision)
        assert own.rays is not None
        assert len(np.unique(own.rays.astype(precision), axis=0)) == len(own.rays)
