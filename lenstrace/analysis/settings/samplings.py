"""Ways to sample the pupil that are traded: patterns, numbers of rays, symmetries."""

from __future__ import annotations

from typing import NamedTuple

from lenstrace.analysis.symmetry import is_centred, is_mirrored
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import PupilPoints, chance_points, pupil_points, radial_rule

# Rings of the patterns, or numbers of points: most numbers of rays lie just below 64, 256, 1024, 4096, see `padded`.
RINGS = {
    "hexapolar": (1, 2, 4, 6, 8, 17, 36),
    "grid": (2, 4, 6, 8, 17, 35),
    "gaussian": (1, 2, 3, 4, 5, 6, 8, 16),
}
COUNTS = (16, 64, 256, 1024, 4096)
# Rays of a lens whose rays are aimed, which takes a thousand times as long.
MOST_AIMED = 300
# Newton's steps that are shown, and the rings of the pattern that shows them.
NEWTON_STEPS, NEWTON_RINGS = (0, 1, 2, 3, 4), 8


class Sampling(NamedTuple):
    """A way to sample the pupil. free: along x and y, 1 where the centroid of a spot may lie anywhere, 0 where symmetry
    keeps it on the axis."""

    family: str
    name: str
    points: PupilPoints
    free: tuple[float, float] = (1.0, 1.0)


def samplings(lens: Lens) -> list[Sampling]:
    """All that apply to the lens, the cheapest of each family first."""
    found = [
        Sampling(pattern, f"{pattern}, {_rings(rings)}", pupil_points(pattern, rings))
        for pattern in ("hexapolar", "grid")
        for rings in RINGS[pattern]
    ]
    found += [
        Sampling(pattern, pattern, chance_points(pattern, count)) for pattern in ("random", "sobol") for count in COUNTS
    ]
    found += map(_gaussian, RINGS["gaussian"])
    if is_mirrored(lens):
        found += map(_half, RINGS["gaussian"])
    if is_centred(lens) and not (any(lens.fields.x) or any(lens.fields.y)):
        found += map(_spoke, RINGS["gaussian"])
    return [each for each in found if _affordable(lens, each)]


def _affordable(lens: Lens, sampling: Sampling) -> bool:
    return not lens.ray_aiming or len(sampling.points.x) <= MOST_AIMED


def newton_sampling() -> Sampling:
    """What they are shown with."""
    return _gaussian(NEWTON_RINGS)


def _gaussian(rings: int) -> Sampling:
    return Sampling("gaussian", f"gaussian, {_rings(rings)}", pupil_points("gaussian", rings))


def _half(rings: int) -> Sampling:
    """Of the gaussian pattern, none of whose spokes lies on the y axis, what is to the right of it."""
    points = pupil_points("gaussian", rings)
    right = points.x > 0
    return Sampling(
        "gaussian, half the pupil",
        f"gaussian, {_rings(rings)}, half the pupil",
        PupilPoints(*(p[right] for p in points)),
        (0.0, 1.0),
    )


def _spoke(rings: int) -> Sampling:
    """One spoke of it: all spokes of an axial point see the same."""
    radius, weight = radial_rule(rings)
    return Sampling(
        "gaussian, one spoke",
        f"gaussian, {_rings(rings)}, one spoke",
        PupilPoints(0 * radius, radius, weight * rings),
        (0.0, 0.0),
    )


def _rings(count: int) -> str:
    return "1 ring" if count == 1 else f"{count} rings"


def newton_steps(lens: Lens) -> tuple[int, ...]:
    """Numbers of Newton's steps to be shown of a lens."""
    aspheric = any(kind.powers for kind in lens.system.kinds) and not lens.ray_aiming
    return NEWTON_STEPS if aspheric else ()
