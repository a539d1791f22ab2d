"""The document of a lens: what is written in its file, as data."""

from __future__ import annotations

import math
from typing import Any

from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.apertures import ApertureKind
from lenstrace.sequential.rows import Number, Row

DEGREE = math.pi / 180
MM_PER_UNIT = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}


@pytree
class Aperture:
    """How wide the lens is open.

    kind:  entrance_pupil_diameter or stop_semi_diameter (value in mm), image_f_number or object_na (a pure number).
    """

    value: Number
    kind: str = static()


@pytree
class Fields:
    """The points that are imaged, F of them.

    kind:         angle (x, y in degrees), object_height or image_height (x, y in length_unit, that of the file).
    length_unit:  mm, cm, m or in.
    """

    x: tuple[Number, ...]
    y: tuple[Number, ...]
    kind: str = static()
    length_unit: str = static(default="mm")

    @property
    def unit(self) -> str:
        """deg, or the unit of length."""
        return "deg" if self.kind == "angle" else self.length_unit

    @property
    def scale(self) -> float:
        """Radians in a degree, or mm in the unit of length."""
        return DEGREE if self.kind == "angle" else MM_PER_UNIT[self.length_unit]


@pytree
class Wavelengths:
    """The colours, W of them, in micrometres, with their weights; `primary` is the place of the chosen one."""

    weights: tuple[Number, ...]
    um: tuple[float, ...] = static()
    primary: int = static()

    @property
    def primary_alone(self) -> Wavelengths:
        """The primary one without the others."""
        return Wavelengths((1.0,), (self.um[self.primary],), 0)


@pytree
class Document:
    """Everything a prescription says.

    rows:             surfaces 1 ... S in order; `lens[3]` is row 3.
    image:            the image surface: its curvature and conic count.
    object_distance:  mm from the object to the first vertex, positive; None at infinity.
    clip_at_semi_diameters:  a surface without an aperture stops rays beyond its semi_diameter, if it has one.
    precision:        the numbers' type in every trace, "float64" or "float32": see `astype`.
    published:        names and values (mm) of what the source says of the lens as it was written, and the
                      relative tolerance of these figures; see `analysis/published.py`.
    """

    rows: tuple[Row, ...]
    image: Row
    aperture: Aperture
    fields: Fields
    wavelengths: Wavelengths
    object_medium: Any
    object_distance: Number | None = None
    object_glass: str | None = static(default=None)
    ray_aiming: bool = static(default=False)
    clip_at_semi_diameters: bool = static(default=False)
    name: str = static(default="")
    source: str = static(default="")
    published: tuple[tuple[str, float], ...] = static(default=())
    precision: str = static(default="float64")

    @property
    def stop(self) -> int:
        """Number of the stop surface."""
        return next(i for i, row in enumerate(self.rows, 1) if row.stop)

    def opening(self, row: Row) -> tuple[ApertureKind, tuple[Number, ...]]:
        """What stops rays at one of the rows: the kind of its aperture, and its numbers, mm."""
        if self.clip_at_semi_diameters and row.aperture_kind is ApertureKind.NONE and row.semi_diameter is not None:
            return ApertureKind.CIRCLE, (row.semi_diameter,)
        return row.aperture_kind, row.aperture
