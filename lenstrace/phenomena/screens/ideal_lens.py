"""Two thin lenses that are nothing but an added path W(r): the one that focuses, and the one that nearly does.

A beam along the axis that crosses a screen at the height y leaves it with the transverse momentum dW/dy:

    W = f - sqrt(f^2 + r^2)     sends it to f, all paths to there being f long,
    W = -r^2 / 2 f              sends it to sqrt(f^2 - y^2): its sine is y / f, where the tangent should be.
"""

from __future__ import annotations

from typing import Annotated, Any

import jax
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.errors import OptionError
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import demonstration, length_of_either_sign, positive_length
from lenstrace.sequential.prescription import lens

RAYS = 20  # drawn, of each lens; none of them on the axis
FOCUS = 1e-14  # of the focal length: what is left of a perfect focus
KINDS = ("ideal_lens", "quadratic_lens")


@result
class IdealLens(Demonstration):
    """A parallel beam behind the ideal and the quadratic lens; lengths in mm.

    focal_length:  f.                       heights:    (N,), where the rays cross the screens.
    crossings, crossings_theory:  (2, N), where they cross the axis, of the ideal lens and of the quadratic one.
    focal_heights: (2, N), of the rays in the plane z = f.
    """

    focal_length: float
    heights: np.ndarray
    crossings: np.ndarray
    crossings_theory: np.ndarray
    focal_heights: np.ndarray


@demonstration
def ideal_lens(
    focal_length: Annotated[float, length_of_either_sign("focal length", slider=(20, 200))] = 100.0,
    height: Annotated[float, positive_length("height of the outermost ray", slider=(1, 80))] = 10.0,
) -> IdealLens:
    """Lenses as phase screens: the ideal one, and the parabola that only nearly focuses.

    OptionError where the quadratic lens sends no light on: beyond r = |f|.
    """
    if height >= abs(focal_length):
        raise OptionError(
            f"ideal-lens: the quadratic lens of focal length {focal_length:g} mm sends no light on from the height "
            f"{height:g} mm; keep height below {abs(focal_length):g} mm"
        )
    share = np.linspace(-1, 1, RAYS)
    ideal, quadratic = (_through(kind, focal_length, height, share) for kind in KINDS)
    y = height * share
    theory = np.array([np.full(RAYS, focal_length), np.sign(focal_length) * np.sqrt(focal_length**2 - y * y)])
    crossings = np.array([_crossing(ideal), _crossing(quadratic)])
    within = FOCUS * abs(focal_length)
    rows = []
    for at in (RAYS // 2 + RAYS // 4, RAYS - 1):
        where = f"ray at {y[at]:.4g} mm"
        path = ideal.opl[1, at] + np.sign(focal_length) * np.hypot(focal_length, y[at])
        rows += [
            Comparison(f"{where}: crosses the axis behind the ideal lens", "mm", crossings[0, at], focal_length),
            Comparison(f"{where}: path to there", "mm", path, focal_length, within),
            Comparison(f"{where}: height in the focal plane", "mm", ideal.y[2, at], 0.0, within),
            Comparison(f"{where}: crosses it behind the quadratic lens", "mm", crossings[1, at], theory[1, at]),
        ]
    return IdealLens(
        setting=f"a beam of {2 * height:g} mm along the axis meets screens of focal length {focal_length:g} mm in air",
        rows=tuple(rows),
        focal_length=focal_length,
        heights=y,
        crossings=crossings,
        crossings_theory=theory,
        focal_heights=np.array([ideal.y[2], quadratic.y[2]]),
    )


def _through(kind: str, focal_length: float, height: float, share: np.ndarray) -> Any:
    """A `Ray`: the beam at the launch, behind the screen, and at z = f."""
    thin = lens(
        [{"thickness": focal_length, "stop": True, "screen": {kind: focal_length}}],
        {"entrance_pupil_diameter": 2 * height},
        [0.0],
        [0.5876],
    )
    return jax.device_get(trace(thin, pupil=(0.0, share)))


def _crossing(path: Any) -> np.ndarray:
    """z where the rays behind the screen cross the axis, mm."""
    return -path.y[1] * path.n[1] / path.m[1]
