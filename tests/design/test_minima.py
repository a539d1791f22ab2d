"""Many starts at once, and real glasses for model glasses."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import lenstrace
from lenstrace import Lens, Problem
from lenstrace.design import (
    Abbe,
    Curvature,
    FocalLength,
    Index,
    SpotRMS,
    Thickness,
    fit_glasses,
    optimize_from,
)
from lenstrace.design.ready import begun
from lenstrace.optics.glasses import glass_map
from tests.design.problems import plates


@pytest.fixture(scope="module")
def flat(designs: dict[str, Lens]) -> Problem:
    """Three flat plates of the triplet's glasses."""
    return plates(designs["cooke_triplet"], rings=3)


def test_from_flat_plates_to_a_triplet(flat: Problem, designs: dict[str, Lens]) -> None:
    """At least as good as the published lens, whose focal length and aperture it has."""
    told: list[tuple[int, int]] = []
    found = optimize_from(flat, 24, keep=3, progress=lambda done, all: told.append((done, all)))
    assert found.ended == found.starts == 24
    assert told[-1] == (24, 24)
    merits = [each.merit_after for each in found]
    assert merits == sorted(merits)
    assert len({round(merit, 9) for merit in merits}) == len(found) == 3
    best = found[0].lens
    published, ours = (np.asarray(lenstrace.spots(lens).rms_centroid) for lens in (designs["cooke_triplet"], best))
    assert np.sum(ours**2) < np.sum(published**2)
    assert float(lenstrace.first_order(best).focal_length[1]) == pytest.approx(50.0, abs=0.1)
    gaps = np.asarray(best.thickness)
    assert np.all(gaps[[0, 2, 4]] >= 1.0)
    assert np.all(gaps[[0, 2, 4]] <= 8.0)
    assert np.all(gaps[[1, 3]] >= 0.5)


def test_given_starts_and_an_interruption(flat: Problem, designs: dict[str, Lens]) -> None:
    published = designs["cooke_triplet"]
    numbers = np.concatenate([published.curvature, np.asarray(published.thickness)[[0, 2, 4, 1, 3, 5]]])
    numbers[6:9] = np.clip(numbers[6:9], 1.0, 8.0)
    want = [SpotRMS(rings=3), FocalLength(50.0, weight=0.1)]
    found = optimize_from(dataclasses.replace(flat, want=want), numbers[None] * np.array([[1.0], [1.001]]), keep=4)
    assert found.distinct == 1  # both come to the same lens
    given = begun(dataclasses.replace(flat, want=want), checked=False).merit.evaluated(numbers).terms.merit
    assert found[0].merit_after < float(np.sum(given))

    def stop(_: int, __: int) -> None:
        raise KeyboardInterrupt

    assert optimize_from(dataclasses.replace(flat, want=want), 24, progress=stop).ended < 24


def test_real_glasses_for_model_glasses(designs: dict[str, Lens]) -> None:
    lens = designs["cemented_doublet"]
    nearest = min(glass_map("SCHOTT"), key=lambda row: abs(row[1] - 1.5168) + abs(row[2] - 64.17))
    assert nearest[0] in ("N-BK7", "N-BK7HT")
    lens = lens.replace(surface=1, abbe={"nd": 1.52, "vd": 63.0})
    vary = [Curvature("all"), Thickness("last"), Index(1, bounds=(1.45, 1.6)), Abbe(1, bounds=(55.0, 70.0))]
    focal_length = float(lenstrace.first_order(lens).focal_length[1])
    found = fit_glasses(Problem(lens, vary=vary, want=[SpotRMS(rings=3), FocalLength(focal_length)]), candidates=2)
    (swap,) = found.swaps
    assert swap.surface == 1
    assert found.lens[1].glass == swap.glass
    assert len(swap.tried) == 2
    assert swap.merit_before == pytest.approx(found.model.merit_after)
    assert swap.merit_after == min(merit for _, merit in swap.tried) == pytest.approx(found.optimized.merit_after)
    assert swap.glass in found.table()
