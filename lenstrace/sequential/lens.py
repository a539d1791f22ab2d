"""The lens: a document that a person reads, edits and asks questions of."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import LensTraceError, PrescriptionError
from lenstrace.sequential.build import build_system
from lenstrace.sequential.document import Aperture, Document, Fields, Wavelengths
from lenstrace.sequential.rows import Row
from lenstrace.sequential.rules import check_lens, check_row, number_of
from lenstrace.sequential.system import System
from lenstrace.sequential.table import html_table, text_table

KINDS = {"aperture": Aperture, "fields": Fields, "wavelengths": Wavelengths, "image": Row}
IMAGE_CAN = {"radius", "curvature", "conic", "asphere", "semi_diameter"}


@pytree
class Lens(Document):
    """A lens. Frozen: `replace` gives a new one. A pytree: `jax.grad`, `jit` and `vmap` take it.

    Its fields are those of `Document`; `lens[3]` is row 3.
    """

    def __getitem__(self, surface: int) -> Row:
        """Row of a surface, numbered from 1 as in the file; S + 1 is the image."""
        return self.image if surface == len(self.rows) + 1 else self.rows[number_of(surface, len(self.rows)) - 1]

    def __iter__(self) -> Iterator[Row]:
        """Rows 1 ... S."""
        return iter(self.rows)

    def __len__(self) -> int:
        """S, the number of rows."""
        return len(self.rows)

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
        system = build_system(self).astype(self.precision)
        if not is_traced((self, system)):
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
                if np.ndim(values) != 1:
                    raise PrescriptionError(f"{name} must be an array, one value for each row; got {values!r}")
                if len(values) != len(rows):
                    raise PrescriptionError(
                        f"{name}: {len(values)} values for {len(rows)} surfaces; give one for each row"
                    )
                each = jnp.unstack(values) if isinstance(values, jax.Array) else values
                rows = [row.replace(**{name: value}) for row, value in zip(rows, each, strict=True)]
        known = {field.name for field in dataclasses.fields(self)}
        for name in changes:
            if name not in known:
                raise PrescriptionError(f"a lens has no {name!r}; to change a row say replace(surface=..., {name}=...)")
        for name, kind in KINDS.items():
            if not isinstance(changes.get(name, getattr(self, name)), kind):
                raise PrescriptionError(f"{name} must be a lenstrace.{kind.__name__}, got {changes[name]!r}")
        changed = dataclasses.replace(self, **{"rows": tuple(rows), **changes})
        check_lens(changed)
        return changed

    def astype(self, dtype: Any) -> Lens:
        """The same lens, traced in float32 or float64 throughout. float32 is good to 2e-5 mm in position at the
        100 mm scale; its derivatives are off by 0.3 %."""
        name = np.dtype(dtype).name
        if name not in ("float32", "float64"):
            raise PrescriptionError(f"a lens is traced in float32 or float64, got {name}")
        return self.replace(precision=name)

    def _replace_row(self, surface: int, changes: dict[str, Any]) -> Lens:
        if isinstance(surface, bool) or not isinstance(surface, int | np.integer):
            raise PrescriptionError(f"surface must be the number of a row, got {surface!r}")
        where = "image" if surface == len(self.rows) + 1 else f"surface {surface}"
        row = self[surface]
        try:
            row = row.replace(**changes)
        except LensTraceError as error:
            raise type(error)(f"{where}: {error}") from None
        check_row(row, where)
        if where == "image":
            for name in set(changes) - IMAGE_CAN:
                raise PrescriptionError(f"image: {name} cannot be given to the image surface; put it on a row before")
            return dataclasses.replace(self, image=row)
        rows = (*self.rows[: surface - 1], row, *self.rows[surface:])
        return self.replace(rows=rows)

    def __repr__(self) -> str:
        return text_table(self)

    def _repr_html_(self) -> str:
        return html_table(self)
