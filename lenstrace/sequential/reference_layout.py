"""The order in which the judge lists the numbers of a ray and of a lens: names for their places, one list or many."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from lenstrace.sequential.reference_surface import ReferenceSurface

LAUNCH = 6  # numbers of the ray: x, y, z, l, m, n
POSE = 5  # numbers of a pose: decentre in x and y, tilt about x, y, z


class Layout(NamedTuple):
    """Places of the numbers along the last axis of an array: six of the ray; the K indices, of the object space and
    behind each surface but the image; then a block for each of the K surfaces.

    surfaces, terms: K, the image included; T, coefficients of a block.
    point, direction, indices are places among all numbers, the others within a block: see `blocks`.
    """

    surfaces: int
    terms: int

    point = slice(0, 3)
    direction = slice(3, LAUNCH)
    curvature = 0
    conic = 1

    @property
    def indices(self) -> slice:
        """Of all media."""
        return slice(LAUNCH, LAUNCH + self.surfaces)

    @property
    def coefficients(self) -> slice:
        """Of the asphere's terms."""
        return slice(2, 2 + self.terms)

    @property
    def gap(self) -> int:
        """Of the gap before the surface; 0 at the first, where there is none."""
        return 2 + self.terms

    @property
    def decenter(self) -> slice:
        """x and y."""
        return slice(3 + self.terms, 5 + self.terms)

    @property
    def tilt(self) -> slice:
        """About x, y, z."""
        return slice(5 + self.terms, 8 + self.terms)

    @property
    def width(self) -> int:
        """Numbers of a block."""
        return 2 + self.terms + 1 + POSE

    @property
    def size(self) -> int:
        """Of all numbers."""
        return LAUNCH + self.surfaces * (1 + self.width)

    def media(self, i: int) -> tuple[int, int]:
        """Places of the indices before and behind the i-th surface; the image has one medium."""
        return LAUNCH + i, LAUNCH + min(i + 1, self.surfaces - 1)

    def blocks(self, numbers: np.ndarray) -> np.ndarray:
        """View (..., K, width) of the surfaces' own numbers, among all (..., size)."""
        return numbers[..., self.indices.stop :].reshape(*numbers.shape[:-1], self.surfaces, self.width)

    def places(self, i: int) -> np.ndarray:
        """Places, among all numbers, of the i-th surface's own."""
        return self.blocks(np.arange(self.size))[i]


def layout_of(surfaces: Sequence[ReferenceSurface]) -> Layout:
    """The layout of a lens."""
    return Layout(len(surfaces), max(len(surface.coefficients) for surface in surfaces))


def input_numbers(
    surfaces: Sequence[ReferenceSurface], point: Sequence[Any] | np.ndarray, direction: Sequence[Any] | np.ndarray
) -> np.ndarray:
    """(I,): the numbers of a ray and a lens in their order."""
    layout = layout_of(surfaces)
    numbers = np.zeros(layout.size)
    numbers[layout.point], numbers[layout.direction] = np.array(point, float), np.array(direction, float)
    numbers[layout.indices] = [float(surface.before) for surface in surfaces]
    for own, surface in zip(layout.blocks(numbers), surfaces, strict=True):
        own[layout.curvature], own[layout.conic], own[layout.gap] = surface.curvature, surface.conic, surface.gap
        own[layout.coefficients][: len(surface.coefficients)] = np.array(surface.coefficients, float)
        own[layout.decenter] = np.array(surface.decenter, float)
        own[layout.tilt] = np.array(surface.tilt, float)
    return numbers
