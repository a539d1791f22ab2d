"""What a designer wants to see of a lens on one page."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from lenstrace.analysis.answers import answers
from lenstrace.analysis.arrivals import Asked, arrivals
from lenstrace.analysis.cardinal import first_order, overview
from lenstrace.analysis.colour import lateral_colour, longitudinal_aberration
from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.distortion import distortion
from lenstrace.analysis.fans import fans
from lenstrace.analysis.field_curvature import field_curvature
from lenstrace.analysis.image_rays import check_light
from lenstrace.analysis.layout import layout
from lenstrace.analysis.mtf import mtf
from lenstrace.analysis.spots import spots
from lenstrace.errors import LensTraceError
from lenstrace.optics.rays import Ray
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import pupil_points
from lenstrace.sequential.system import System

MOST_FIELDS = 3
FAN_POINTS, FIELD_POINTS = 41, 11


class Sheet(NamedTuple):
    """The results of one page.

    lens:     with at most three of its fields: the nearest to the axis, the farthest, and the one nearest to seven
              tenths.
    found:    results by the name of the function that gives them: layout, overview, first_order, spots, fans,
              field_curvature, distortion, lateral_colour, longitudinal_aberration, mtf.
    missing:  the names of those that this lens does not have, and why.
    """

    lens: Lens
    found: dict[str, Any]
    missing: dict[str, str]


def sheet(lens: Lens, tell: Callable[[str], None] | None = None) -> Sheet:
    """The results of one page about a lens; `tell` is called with the name of each before it is computed.

    LostRaysError where no ray of any field arrives.
    """
    shown = with_few_fields(lens)
    asked: dict[str, Callable[[], Any]] = {
        "layout": lambda: layout(lens),
        "overview": lambda: overview(lens),
        "first_order": lambda: first_order(lens),
        "spots": lambda: spots(shown),
        "fans": lambda: fans(shown, points=FAN_POINTS),
        "field_curvature": lambda: field_curvature(lens, points=FIELD_POINTS),
        "distortion": lambda: distortion(lens, points=FIELD_POINTS),
        "lateral_colour": lambda: lateral_colour(lens, points=FIELD_POINTS),
        "longitudinal_aberration": lambda: longitudinal_aberration(lens, points=FIELD_POINTS),
        "mtf": lambda: mtf(shown),
    }

    def told(name: str, question: Callable[[], Any]) -> Callable[[], Any]:
        def ask() -> Any:
            if tell is not None:
                tell(name)
            return question()

        return ask

    found, missing = answers({name: told(name, question) for name, question in asked.items()})
    if "spots" in missing and "fans" in missing:
        _check_any(shown)
    return Sheet(shown, found, missing)


def _check_any(lens: Lens) -> None:
    """LostRaysError where no ray of any field arrives; of a lens that can be traced."""
    try:
        system, front = with_pupil(lens)
    except LensTraceError:
        return
    points = pupil_points()
    check_light(arrivals(Asked(front, system.light, _arrives), system.fields, points.x, points.y)[..., 1:])


def _arrives(_: System, rays: Ray) -> Any:
    return rays.ok


def with_few_fields(lens: Lens) -> Lens:
    """The lens with at most MOST_FIELDS of its fields, in the order of their distance from the axis."""
    size = np.hypot(np.asarray(lens.fields.x, float), np.asarray(lens.fields.y, float))
    if len(size) <= MOST_FIELDS:
        return lens
    chosen = [int(size.argmin()), int(np.abs(size - 0.7 * size.max()).argmin()), int(size.argmax())]
    fields = dataclasses.replace(
        lens.fields, x=tuple(lens.fields.x[i] for i in chosen), y=tuple(lens.fields.y[i] for i in chosen)
    )
    return lens.replace(fields=fields)
