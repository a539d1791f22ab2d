"""The lens as a document: rows, aperture, fields, wavelengths. What a person reads, edits and saves."""

from __future__ import annotations

import dataclasses
from typing import Any

import jax
import numpy as np

from lenstrace.errors import LensTraceError, PrescriptionError
from lenstrace.pytree import is_traced, pytree, static
from lenstrace.sequential.build import build_system
from lenstrace.sequential.rows import Number, Row
from lenstrace.sequential.rules import check_lens, check_row, number_of
from lenstrace.sequential.system import System
from lenstrace.sequential.table import html_table, text_table


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

    kind:  angle (x, y in degrees), object_height or image_height (x, y in mm).
    """

    x: tuple[Number, ...]
    y: tuple[Number, ...]
    kind: str = static()

    @property
    def unit(self) -> str:
        """deg or mm."""
        return "deg" if self.kind == "angle" else "mm"


@pytree
class Wavelengths:
    """The colours, W of them, in micrometres, with their weights; `primary` is the place of the chosen one."""

    weights: tuple[Number, ...]
    um: tuple[float, ...] = static()
    primary: int = static()


@pytree
class Lens:
    """A lens. Frozen: `replace` gives a new one. A pytree: `jax.grad`, `jit` and `vmap` take it.

    rows:             surfaces 1 ... S in order; `lens[3]` is row 3.
    image:            the image surface: its curvature and conic count.
    object_distance:  mm from the object to the first vertex, positive; None at infinity.
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
    name: str = static(default="")
    source: str = static(default="")
    published: tuple[tuple[str, float], ...] = static(default=())

    def __getitem__(self, surface: int) -> Row:
        """Row of a surface, numbered from 1 as in the file; S + 1 is the image."""
        return self.image if surface == len(self.rows) + 1 else self.rows[number_of(surface, len(self.rows)) - 1]

    def __len__(self) -> int:
        """S, the number of rows."""
        return len(self.rows)

    @property
    def stop(self) -> int:
        """Number of the stop surface."""
        return next(i for i, row in enumerate(self.rows, 1) if row.stop)

    @property
    def curvature(self) -> np.ndarray | jax.Array:
        """(S,), 1/mm."""
        return self.system.curvature[:-1]

    @property
    def thickness(self) -> np.ndarray | jax.Array:
        """(S,), mm."""
        return self.system.thickness

    @property
    def conic(self) -> np.ndarray | jax.Array:
        """(S,)."""
        return self.system.conic[:-1]

    @property
    def system(self) -> System:
        """The numbers, stacked: what is traced. Kept once built, unless JAX is tracing them."""
        kept = self.__dict__.get("_system")
        if kept is not None:
            return kept
        system = build_system(self)
        if not is_traced(self):
            object.__setattr__(self, "_system", system)
        return system

    def replace(self, surface: int | None = None, **changes: Any) -> Lens:
        """A new lens with something changed.

        With `surface`, a field of that row: `replace(surface=3, curvature=0.02)`, also radius, thickness, conic,
        asphere, glass, ... Without it, a field of the lens, or one of curvature, thickness, conic for all rows
        at once: `replace(curvature=array of shape (S,))`. Numbers may be traced by JAX.
        """
        if surface is not None:
            return self._replace_row(surface, changes)
        rows = list(self.rows)
        for name in ("curvature", "thickness", "conic"):
            if name in changes:
                values = changes.pop(name)
                if len(values) != len(rows):
                    raise PrescriptionError(
                        f"{name}: {len(values)} values for {len(rows)} surfaces; give one for each row"
                    )
                rows = [row.replace(**{name: values[i]}) for i, row in enumerate(rows)]
        known = {field.name for field in dataclasses.fields(self)}
        for name in changes:
            if name not in known:
                raise PrescriptionError(f"a lens has no {name!r}; to change a row say replace(surface=..., {name}=...)")
        changed = dataclasses.replace(self, **{"rows": tuple(rows), **changes})
        check_lens(changed)
        return changed

    def _replace_row(self, surface: int, changes: dict[str, Any]) -> Lens:
        where = "image" if surface == len(self.rows) + 1 else f"surface {surface}"
        row = self[surface]
        try:
            row = row.replace(**changes)
        except LensTraceError as error:
            raise type(error)(f"{where}: {error}") from None
        check_row(row, where)
        if where == "image":
            return dataclasses.replace(self, image=row)
        rows = (*self.rows[: surface - 1], row, *self.rows[surface:])
        return self.replace(rows=rows)

    def __repr__(self) -> str:
        return text_table(self)

    def _repr_html_(self) -> str:
        return html_table(self)
