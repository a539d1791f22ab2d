"""Numbers of rays filled up to a few sizes, so that few programs are compiled."""

from __future__ import annotations

import numpy as np

FEWEST = 64


def padded(*arrays: np.ndarray) -> list[np.ndarray]:
    """Arrays of N rays, (..., N), made longer with zeros, to `padded_count(N)`."""
    count = arrays[0].shape[-1]
    return [np.pad(a, [(0, 0)] * (a.ndim - 1) + [(0, padded_count(count) - count)]) for a in arrays]


def padded_count(count: int) -> int:
    """The least of 64, 256, 1024, 4096 ... that is not below N.

    >>> [padded_count(count) for count in (1, 64, 65, 1000)]
    [64, 64, 256, 1024]
    """
    size = FEWEST
    while size < count:
        size *= 4
    return size
