"""The extremes that the tracer is judged at: lenses, and rays through them, by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from lenstrace.analysis.extremes.lenses import (
    Case,
    Keys,
    Trial,
    distant_and_near_objects,
    ends_of_a_glass,
    made,
    scaled_lenses,
    things_at_infinity,
)
from lenstrace.analysis.extremes.rays import (
    at_heights,
    bent_to_the_rim,
    bundle,
    fan,
    from_far,
    incident,
    meeting_inside,
    nearly_axial,
    nearly_flat,
    rays_of,
    tangents,
    turned,
)
from lenstrace.sequential.lens import Lens

CRITICAL, BREWSTER = math.asin(1 / 1.5), math.atan(1.5)
STEPS = (1e-4, -1e-4, 1e-8, -1e-8, 1e-10, -1e-10, 1e-12, -1e-12)  # on both sides of a boundary
# The same in units of eps: what is smaller than one is no step.
EPS_STEPS = (4.0, -4.0, 16.0, -16.0, 64.0, -64.0, 1024.0, -1024.0)
# Of r^16 on a sphere of 10 mm: its rim stands 1 mm higher or lower, or so much lower (10 mm, 30 mm) that rays there
# meet the sheet twice or, where it has turned away, not at all.
RIM_TERMS = (1e-16, -1e-16, -1e-15, -3e-15)
RIM_STEPS = (1e-2, 1e-4, 1e-6, 1e-12, -1e-12, -1e-6, -1e-4, -1e-2)
EPS = {name: float(np.finfo(name).eps) for name in ("float32", "float64")}


def cases() -> tuple[Case, ...]:
    """Every extreme."""
    return (
        _case("curvature 0", _singlet({"curvature": 0.0}), bundle(8.0)),
        _case(
            "curvature 1e-15 and 1e-9 / mm", *_each(lambda c: _singlet({"curvature": c}), (1e-15, 1e-9), bundle(8.0))
        ),
        _case("radius 1e-3 mm", _singlet({"radius": 1e-3}, gap=1e-3), bundle(4e-4)),
        _case("radius 1e12 mm", _singlet({"radius": 1e12}), bundle(8.0)),
        _case(
            "hemisphere at its rim",
            *_near(
                _singlet({"radius": 10.0}, gap=20.0),
                lambda steps: at_heights(10.0, steps),
                (1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 1e-15, 0.0, -1e-12),
            ),
        ),
        _case(
            "tangent to a sphere within 1e-4 ... 1e-12",
            *_near(
                _singlet({"radius": 10.0}),
                lambda steps: tangents(10.0, steps),
                (1e-4, -1e-4, 1e-6, 1e-8, -1e-8, 1e-10, 1e-12, -1e-12),
            ),
        ),
        _case(
            "parabola along its axis",
            *_each(lambda c: _singlet({"curvature": c, "conic": -1.0}), (0.05, -0.05), nearly_axial(8.0)),
        ),
        _case(
            "hyperboloid's other sheet",
            _singlet({"radius": 10.0, "conic": -4.0}),
            fan(-10.0, np.linspace(0.1, 0.8, 8)),
        ),
        _case("oblate ellipsoid, k = 10", _singlet({"radius": 10.0, "conic": 10.0}), bundle(2.9)),
        _case(
            "direction cosine d_z to 1e-6",
            *_each(lambda c: _singlet({"curvature": c}), (0.0, -0.02), nearly_flat()),
        ),
        _case("light that runs backward", _singlet({"radius": 30.0}, gap=-5.0), turned(bundle(5.0))),
        _case(
            "at the critical angle within 1e-12 ... 1e-4",
            *_near(_singlet({"index": None}, object_index=1.5), lambda steps: incident(CRITICAL, steps)),
        ),
        _case(
            "critical angle inside a sphere",
            *_near(
                _singlet({"radius": -10.0, "index": None}, object_index=1.5),
                lambda steps: meeting_inside(10.0, CRITICAL, steps),
            ),
        ),
        _case("Brewster's angle", *_near(_singlet({}), lambda steps: incident(BREWSTER, steps))),
        _case(
            "index ratio 1 +- 1e-12, 1 +- 4 eps",
            *_indices(1.0, 1e-12),
        ),
        _case("index 4", _singlet({"radius": 20.0, "index": 4.0}), bundle(8.0)),
        _case(
            "index -1, -1 +- 1e-9, -1 +- 4 eps",
            Trial(_singlet({"radius": 20.0, "index": -1.0}), bundle(8.0)),
            *_indices(-1.0, 1e-9),
        ),
        *distant_and_near_objects(),
        _case("rays given 1e6 ... 1e12 mm away", _singlet({"radius": 50.0}), from_far(bundle(8.0))),
        *scaled_lenses(),
        Case(
            "300 surfaces",
            (
                Trial(
                    made(
                        [
                            {"radius": r * 300.0, "index": 1.5, "thickness": 0.2}
                            if r > 0
                            else {"radius": r * 300.0, "thickness": 0.2}
                            for r in (1, -1)
                        ]
                        * 150
                    ),
                    rays_of([[0.3, 1.5, 0.0]], [[0.01, 0.02, 1.0]]),
                ),
            ),
        ),
        _case(
            "thickness 0 and negative", *_each(lambda t: _singlet({"radius": 40.0}, gap=t), (0.0, -3.0), bundle(8.0))
        ),
        _case(
            "a ray through every vertex",
            _singlet({"radius": 40.0}),
            rays_of([[0.0, 0.0, -5.0]] * 2, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]),
        ),
        _case(
            "asphere r^16 at its rim",
            *(
                Trial(_singlet({"radius": 10.0, "asphere": {4: 1e-5, 6: 0.0, 16: a}}), rays)
                for a in RIM_TERMS
                for rays in (at_heights(10.0, RIM_STEPS), bent_to_the_rim(10.0))
            ),
        ),
        _case(
            "decentre 1e6 times the beam",
            _singlet({"radius": 2e5, "decenter": [0.0, 1e4], "tilt": [1.0, 0.0, 0.0]}, gap=100.0),
            bundle(1e-2),
        ),
        *ends_of_a_glass(),
        *things_at_infinity(),
    )


def _case(name: str, *trials: Any) -> Case:
    """Of trials, or of one lens and its rays."""
    if isinstance(trials[0], Lens):
        trials = (Trial(*trials),)
    return Case(name, trials)


def _each(lens: Callable[[float], Lens], values: Sequence[float], rays: np.ndarray) -> tuple[Trial, ...]:
    """The same rays through a lens for each of the values."""
    return tuple(Trial(lens(value), rays) for value in values)


def _near(lens: Lens, rays: Callable[[Sequence[float]], np.ndarray], steps: Sequence[float] = STEPS) -> list[Trial]:
    """Rays near a boundary, by steps of any precision and by those of each."""
    own = (Trial(lens, rays([eps * step for step in EPS_STEPS]), precision=name) for name, eps in EPS.items())
    return [Trial(lens, rays(steps)), *own]


def _indices(middle: float, step: float) -> list[Trial]:
    """Glasses whose index is by a step, and by four eps of a precision, more or less than a number."""

    def at(change: float, precision: str | None = None) -> Trial:
        return Trial(_singlet({"radius": 20.0, "index": middle + change}), bundle(8.0), precision=precision)

    own = (at(sign * 4 * eps, name) for name, eps in EPS.items() for sign in (1, -1))
    return [at(step), at(-step), *own]


def _singlet(front: Keys, gap: float = 5.0, **more: Any) -> Lens:
    """A front surface, of index 1.5 behind it unless it has another (None: air), and a bent back."""
    front = {"index": 1.5, "thickness": gap, **front}
    if front["index"] is None:
        del front["index"]
    return made([front, {"curvature": -1 / (60 * abs(gap)) if gap else 0.0, "thickness": 10.0 * gap}], **more)
