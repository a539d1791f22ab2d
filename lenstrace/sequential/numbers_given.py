"""Numbers that a person gives: plain ones become floats, those that JAX holds stay as they are."""

from __future__ import annotations

import numbers
from collections.abc import Sequence
from typing import Any

import jax
import numpy as np

from lenstrace.errors import PrescriptionError


def number(value: Any, what: str) -> Any:
    """A float, or a scalar that JAX holds, as it is; else PrescriptionError."""
    if isinstance(value, jax.Array) and value.ndim == 0:
        return value
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        return float(value)
    raise PrescriptionError(f"{what} must be a number, got {value!r}")


def several(values: Any, length: int, what: str) -> tuple[Any, ...]:
    """So many numbers; else PrescriptionError."""
    if not isinstance(values, (Sequence, np.ndarray, jax.Array)) or len(values) != length:
        raise PrescriptionError(f"{what} takes {length} numbers, got {values}")
    return tuple(number(value, what) for value in values)
