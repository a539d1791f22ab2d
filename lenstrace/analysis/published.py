"""What the source of a lens says of it, beside what comes out here."""

from __future__ import annotations

import math
from typing import NamedTuple

import jax.numpy as jnp

from lenstrace.analysis.cardinal import first_order, overview
from lenstrace.analysis.spots import spots
from lenstrace.errors import ImageError, LostRaysError
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens


class PublishedFigure(NamedTuple):
    """A figure at the primary wavelength, lengths in mm. agrees: within the tolerance that the file states;
    `largest_spot` is an upper bound."""

    name: str
    published: float
    computed: float
    agrees: bool


def published_figures(lens: Lens) -> tuple[PublishedFigure, ...]:
    """Every figure of the [published] section of a lens, in its order; nothing where it has none.

    A figure that cannot be computed is nan, and does not agree. In float32 the tolerance is at least its own.
    """
    values = dict(lens.published)
    tolerance = max(values.pop("tolerance", 0.0), 100 * float(jnp.finfo(lens.system.curvature.dtype).eps))
    found = []
    for name, published in values.items():
        try:
            computed = _computed(lens, name)
        except (ImageError, LostRaysError):
            computed = math.nan
        bound = published if name == "largest_spot" else abs(published) * tolerance
        distance = computed if name == "largest_spot" else abs(computed - published)
        found.append(PublishedFigure(name, published, computed, bool(distance <= bound)))
    return tuple(found)


def _computed(lens: Lens, name: str) -> float:
    match name:
        case "largest_spot":
            return float(jnp.max(spots(lens).largest))
        case "f_number":
            return float(overview(lens).f_number)
        case "magnification":
            magnification = overview(lens).magnification
            return math.nan if magnification is None else float(magnification)
        case "angular_magnification":
            return float(paraxial.angular_magnification(lens.system.at(lens.system.primary)))
        case _:
            return float(getattr(first_order(lens), name)[lens.wavelengths.primary])
