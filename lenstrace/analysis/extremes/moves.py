"""A ray and a lens whose numbers are moved a little, for the judge to trace again."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from lenstrace.sequential.reference_layout import layout_of
from lenstrace.sequential.reference_surface import ReferenceSurface, Vector, exact, mp

DIGITS = 50


def moved(
    surfaces: Sequence[ReferenceSurface], start: np.ndarray, parts: np.ndarray
) -> tuple[list[ReferenceSurface], Vector]:
    """All numbers moved by these parts of themselves, a point's by parts of its largest one, a direction's by parts
    of 1; parts: (I,), in the order of `Layout`. The direction is no longer a unit vector."""
    layout = layout_of(surfaces)
    with mp.workdps(DIGITS):
        part = np.array([exact(p) for p in parts], object)
        sizes = np.array([exact(np.abs(start[:3]).max())] * 3 + [mp.one] * 3, object)
        there = np.array([exact(x) for x in start], object) + part[: len(start)] * sizes
        return [
            dataclasses.replace(
                surface,
                before=surface.before * (1 + part[layout.media(i)[0]]),
                behind=surface.behind * (1 + part[layout.media(i)[1]]),
                curvature=surface.curvature * (1 + own[layout.curvature]),
                conic=surface.conic * (1 + own[layout.conic]),
                coefficients=_each(surface.coefficients, own[layout.coefficients]),
                gap=surface.gap * (1 + own[layout.gap]),
                decenter=_each(surface.decenter, own[layout.decenter]),
                tilt=_each(surface.tilt, own[layout.tilt]),
            )
            for i, (surface, own) in enumerate(zip(surfaces, layout.blocks(part), strict=True))
        ], there


def _each(numbers: Sequence[object], parts: np.ndarray) -> tuple[object, ...]:
    """A lens's terms may be more than a surface has."""
    return tuple(a * (1 + p) for a, p in zip(numbers, parts[: len(numbers)], strict=True))  # type: ignore[operator]
