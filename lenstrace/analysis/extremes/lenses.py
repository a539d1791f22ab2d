"""What an extreme is made of, and the extremes of launching, of scale, of glass, and of what lies at infinity."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from lenstrace.analysis.extremes.rays import bundle, over_pupil
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens as lens_of

UM = 0.5876  # the wavelength of all lenses but those at the ends of a glass

Keys = Mapping[str, Any]


@dataclasses.dataclass(frozen=True)
class Trial:
    """A lens and rays through it at its primary wavelength.

    rays:      (N, 6), point (mm) and direction at the first vertex; or None, then they are launched by the tracer:
    launched:  (N, 4), field x and y (in the lens's unit), pupil x and y.
    precision: the one that it is an extreme of; None: of every one.
    """

    lens: Lens
    rays: np.ndarray | None = None
    launched: np.ndarray | None = None
    precision: str | None = None

    @property
    def count(self) -> int:
        """N."""
        given = self.rays if self.launched is None else self.launched
        assert given is not None
        return len(given)


@dataclasses.dataclass(frozen=True)
class Case:
    """An extreme.

    scales:  the trials after the first are its lens and rays scaled by these powers of two: results must be the same to
             the last bit, up to the scale.
    afocal:  first-order figures must say so: power 0, infinite focal lengths, nothing nan.
    """

    name: str
    trials: tuple[Trial, ...]
    scales: tuple[float, ...] = ()
    afocal: bool = False


def made(rows: Sequence[Keys], aperture: Keys | None = None, fields: Any = (0.0,), um: float = UM, **more: Any) -> Lens:
    """A lens whose first row is the stop unless one is marked."""
    rows = [dict(row) for row in rows]
    if not any(row.get("stop") for row in rows):
        rows[0]["stop"] = True
    return lens_of(rows, aperture or {"entrance_pupil_diameter": 1.0}, fields, [um], **more)


def distant_and_near_objects() -> tuple[Case, ...]:
    """Far and near objects, launched by angle; the stop is the rear surface."""
    rows = [
        {"radius": 50.0, "thickness": 5.0, "index": 1.5},
        {"radius": -60.0, "thickness": 45.0, "stop": True},
    ]

    def at(distance: float) -> Trial:
        fields = {"kind": "angle", "y": [0.0, 5.0]}
        return Trial(
            made(rows, {"entrance_pupil_diameter": 10.0}, fields, object_distance=distance),
            launched=over_pupil((0.0, 5.0)),
        )

    return (
        Case("object 1e6 ... 1e12 mm away", tuple(map(at, (1e6, 1e9, 1e10, 1e12)))),
        Case("object 1e-6 mm away", (at(1e-6),)),
    )


def scaled_lenses() -> tuple[Case, ...]:
    """A lens with terms up to r^16, scaled."""
    front = {4: -3e-5, 6: 2e-7, 16: -2e-18}

    def at(scale: float) -> Trial:
        terms = {power: a * scale ** (1 - power) for power, a in front.items()}
        rows = [
            {"radius": 20.0 * scale, "thickness": 5.0 * scale, "index": 1.5, "conic": -0.5, "asphere": terms},
            {"radius": -60.0 * scale, "thickness": 40.0 * scale},
        ]
        return Trial(made(rows), bundle(8.0) * np.array([scale] * 3 + [1.0] * 3))

    powers = (2.0**-10, 2.0**20)
    return (
        Case("scaled by 2^-10 and 2^20", tuple(at(scale) for scale in (1.0, *powers)), scales=powers),
        Case("scaled by 1e-3 and 1e6", tuple(at(scale) for scale in (1e-3, 1e6))),
    )


def ends_of_a_glass() -> tuple[Case, ...]:
    """At both ends of a glass's range."""
    rows = [{"radius": 50.0, "thickness": 5.0, "glass": "N-BK7"}, {"radius": -300.0, "thickness": 50.0}]
    return (
        Case(
            "wavelength at the edge of a glass's range",
            tuple(Trial(made(rows, um=um), bundle(8.0)) for um in (0.3, 2.5)),
        ),
    )


def things_at_infinity() -> tuple[Case, ...]:
    """What lies at infinity: image, pupil, principal planes."""
    expander = [
        {"thickness": 2.0, "stop": True},
        {"curvature": 1 / 64, "thickness": 0.0, "index": 1.5},
        {"thickness": 192.0},
        {"thickness": 0.0, "index": 1.5},
        {"curvature": -1 / 32, "thickness": 64.0},
    ]
    telecentric = [
        {"curvature": 1 / 64, "thickness": 0.0, "index": 1.5},
        {"thickness": 128.0},
        {"thickness": 128.0, "stop": True},
        {"curvature": 1 / 64, "thickness": 0.0, "index": 1.5},
        {"thickness": 128.0},
    ]
    height = {"kind": "object_height", "y": [0.0, 5.0]}
    return (
        Case(
            "afocal: principal planes at infinity",
            (Trial(made(expander), launched=over_pupil((0.0, 1.0))),),
            afocal=True,
        ),
        Case(
            "telecentric: pupils at infinity",
            (
                Trial(
                    made(telecentric, {"object_na": 0.05}, height, object_distance=128.0),
                    launched=over_pupil((0.0, 5.0)),
                ),
            ),
            afocal=True,
        ),
    )
