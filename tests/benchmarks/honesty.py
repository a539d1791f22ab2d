"""Section honesty: how often the error of a spot is within its estimate, and how far the estimate is above it.

The designs and random neighbours of them, a third of these tilted and decentred out of every symmetry; every field and
wavelength by itself, and all wavelengths of a field pooled. The truth is the integral over the open pupil, by one rule,
Gauss's, with many more rings.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import lenstrace
from lenstrace import Lens
from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.pupil_rules import open_pupil
from lenstrace.sequential.sampling import pupil_points
from tests.benchmarks import launched
from tests.benchmarks.table import Table

NEIGHBOURS = 1_000
TOLERANCES = (1e-2, 1e-4, 1e-6)
SPREAD = (0.005, 0.02)  # relative changes of a neighbour's numbers
TILT, SHIFT = 0.3, 0.002  # degrees; of the largest thickness
RINGS = 24
MORE_RINGS = {"phone_lens": 72, "fisheye": 12, "relay_one_to_one": 12}  # odd powers; rays that are aimed take long
SLOW = {"fisheye": 0.05, "relay_one_to_one": 0.2}  # share of the neighbours of the others
# No image, or a perfect one of which only the neighbours have a spot.
WITHOUT_IMAGE = {"afocal_expander"}
PERFECT = {"cartesian_oval", "hyperbolic_singlet", "immersion_objective", "negative_index_slab"}
# The neighbours; the constants of `accuracy.convergence` were found with another number.
SEED = 11


class Judged(NamedTuple):
    """Of every spot: its design, estimated and true error, mm, and whether the tolerance was reached."""

    design: list[str]
    estimate: np.ndarray
    error: np.ndarray
    reached: np.ndarray


def honesty() -> Table:
    """All designs and 1,000 neighbours, at three tolerances."""
    table = Table(f"honesty: estimates of spots(tolerance=...), the designs and {NEIGHBOURS:,} neighbours")
    for tolerance in TOLERANCES:
        found = judged(names(), NEIGHBOURS, tolerance)
        within, ratio = figures(found)
        table.value(f"tolerance {tolerance:g}: errors within their estimates", 100 * within, "%", at_least=99.0)
        table.value(f"tolerance {tolerance:g}: median of estimate / error", ratio, "times", at_most=20.0)
        table.notes.append(
            f"tolerance {tolerance:g}: {len(found.error):,} spots, {np.mean(found.reached):.1%} reached it"
        )
    return table


def names() -> list[str]:
    """The designs that have spots, or whose neighbours do."""
    return [path.stem for path in sorted(launched.DESIGNS.glob("*.toml")) if path.stem not in WITHOUT_IMAGE]


def judged(designs: list[str], neighbours: int, tolerance: float, seed: int = SEED) -> Judged:
    """Designs, and so many neighbours of them all together."""
    chance = np.random.default_rng(seed)
    share = np.array([SLOW.get(name, 1.0) for name in designs])
    counts = np.ceil(neighbours * share / share.sum()).astype(int)
    rows: list[tuple[str, np.ndarray, np.ndarray, bool]] = []
    for name, count in zip(designs, counts, strict=True):
        lens = lenstrace.load(launched.DESIGNS / f"{name}.toml")
        for place in range(name in PERFECT, 1 + count):
            one = lens if place == 0 else neighbour(lens, chance, SPREAD[place % 2], tilted=place % 3 == 2)
            try:
                spots = lenstrace.spots(one, tolerance=tolerance)
                truth = true_sizes(one, MORE_RINGS.get(name, RINGS))
            except lenstrace.LensTraceError:
                continue  # a neighbour that loses all its light, or its chief ray
            assert spots.error is not None
            value = np.append(np.ravel(spots.rms_centroid), spots.polychromatic.rms_centroid)
            estimate = np.append(np.ravel(spots.error.rms_centroid), spots.error.polychromatic)
            known = np.isfinite(truth)
            rows.append((name, estimate[known], np.abs(value - truth)[known], spots.error.reached))
    return Judged(
        [name for name, estimate, *_ in rows for _ in estimate],
        np.concatenate([estimate for _, estimate, *_ in rows]),
        np.concatenate([error for *_, error, _ in rows]),
        np.concatenate([np.full(len(estimate), reached) for _, estimate, _, reached in rows]),
    )


def figures(found: Judged) -> tuple[float, float]:
    """The share of errors within their estimates, and the median of estimate / error."""
    within = found.error <= found.estimate
    return float(np.mean(within)), float(np.median(found.estimate / np.maximum(found.error, 1e-17)))


def neighbour(lens: Lens, chance: np.random.Generator, spread: float, *, tilted: bool) -> Lens:
    """A lens with all its numbers changed a little; `tilted`: its first surface tilted and decentred too."""

    def changed(values: np.ndarray) -> np.ndarray:
        return np.asarray(values) * (1 + spread * chance.standard_normal(np.shape(values)))

    lens = lens.replace(**{name: changed(getattr(lens, name)) for name in ("curvature", "thickness", "conic")})
    for surface, row in enumerate(lens, 1):
        if row.powers:
            terms = {power: float(changed(np.asarray(term))) for power, term in row.asphere.items()}
            lens = lens.replace(surface=surface, asphere=terms)
    if tilted:
        shift = SHIFT * float(np.abs(lens.thickness).max())
        pose = {"tilt": tuple(TILT * chance.standard_normal(3)), "decenter": tuple(shift * chance.standard_normal(2))}
        lens = lens.replace(surface=1, **pose)
    return lens


def true_sizes(lens: Lens, rings: int) -> np.ndarray:
    """RMS about the centroid of every field and wavelength, then of every field; nan where a ray is lost."""
    x, y, weight = _points(lens, rings)
    sizes, pooled = [], []
    waves = np.asarray(lens.wavelengths.weights, float)
    for f, field in enumerate(zip(map(float, lens.fields.x), map(float, lens.fields.y), strict=True)):
        moments = []
        for w, um in enumerate(lens.wavelengths.um):
            share = weight[w, f]
            image = lenstrace.trace(lens, field=field, pupil=(x[w, f], y[w, f]), wavelength=um, path=False, opl=False)
            at = np.array([image.x, image.y])
            centre = (share * at).sum(1) / share.sum()
            square = share @ ((at - centre[:, None]) ** 2).sum(0) / share.sum()
            moments.append([*centre, square if np.asarray(image.ok).all() else np.nan, share.sum()])
        moments = np.array(moments)
        sizes += list(np.sqrt(moments[:, 2]))
        part = waves * moments[:, 3] / (waves @ moments[:, 3])
        spread = moments[:, 2] + ((moments[:, :2] - part @ moments[:, :2]) ** 2).sum(1)
        pooled.append(np.sqrt(part @ spread))
    return np.array(sizes + pooled)


def _points(lens: Lens, rings: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gauss's rule over the open pupil of every wavelength and field: x, y and weight, (W, F, N)."""
    if any(row.aperture for row in lens):
        system, front = with_pupil(lens)
        pair = open_pupil(front, system.light, system.fields, rings)
        first = pair.first.sum(tuple(range(pair.first.ndim - 1))) > 0
        return pair.x[..., first], pair.y[..., first], pair.first[..., first]
    x, y, weight = pupil_points("gaussian", rings)
    shape = len(lens.wavelengths.um), len(lens.fields.y), len(x)
    return np.broadcast_to(x, shape), np.broadcast_to(y, shape), np.broadcast_to(weight, shape)
