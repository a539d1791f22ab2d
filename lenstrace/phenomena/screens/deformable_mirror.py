"""A deformable mirror: it takes back what the air has done to a wavefront, as well as its actuators can.

A mirror whose surface is h toward the light shortens the path by 2 h. Turned by the angle t it sends light off by 2 t,
as a plane mirror that stands askew does: W = 2 sin(t) cos(t) y = y sin(2 t). As a paraboloid, W = -r^2 / 2f, it sends
the ray at the height y to sqrt(f^2 - y^2).
Commanded with the negative of a wavefront's path at its actuators, it leaves what the bicubic spline through them does
not follow: nothing of a wavefront that is a cubic polynomial, the more of another the higher its order.
Source of the spline that it is compared with: SciPy's, which is not a knot at the second point either.
"""

from __future__ import annotations

import functools
import math
from typing import Annotated, Any

import jax
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.optics.screens.grid import GridScreen
from lenstrace.optics.screens.zernike import ZernikeScreen
from lenstrace.optics.zernike import zernike_index, zernike_name, zernike_terms
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

RADIUS = 10.0  # mm, of the pupil
FOCAL_LENGTH = 500.0  # mm, of the mirror as a paraboloid
TURN = 0.1  # degrees, by which it is turned
COMA = 7  # a cubic
TERMS = tuple(range(4, 46))  # Noll's numbers, up to the eighth order
SIDE = 81  # points along a side of the picture
ROUNDING = 1e-14  # of the amount: what should be 0


@result
class DeformableMirror(Demonstration):
    """Wavefronts before and behind the mirror.

    name:       of the aberration.           actuators: along a side.
    x:          (SIDE,), mm, along either side.
    before, behind:  (SIDE, SIDE), path, um, nan outside the pupil.
    terms:      (K,), Noll's numbers.     orders: (K,), radial orders n.     left: (K,), RMS path that the mirror leaves
                of each, in units of what came.
    """

    name: str
    actuators: int
    x: np.ndarray
    before: np.ndarray
    behind: np.ndarray
    terms: np.ndarray
    orders: np.ndarray
    left: np.ndarray


@demonstration
def deformable_mirror(
    term: Annotated[
        int, Option("aberration: number of a Zernike polynomial, Noll's", least=TERMS[0], most=TERMS[-1])
    ] = 11,
    amount: Annotated[float, Option("its RMS path", "um", least=1e-3, most=20, slider=(0.1, 2))] = 0.5,
    actuators: Annotated[int, Option("actuators along a side", least=4, most=100, slider=(4, 20))] = 9,
) -> DeformableMirror:
    """A deformable mirror takes back an aberration, actuator by actuator."""
    from scipy.interpolate import RectBivariateSpline

    side = np.linspace(-1, 1, SIDE)
    inside = np.hypot(side[:, None], side) <= 1
    y, x = (a[inside] for a in np.meshgrid(side, side, indexing="ij"))

    at = np.linspace(-1, 1, actuators)
    shapes = np.asarray(zernike_terms("noll", TERMS, *np.meshgrid(at, at)))

    def paths(number: int) -> np.ndarray:
        """um, before and behind the mirror, of the aberration of that number."""
        amounts = np.where(np.array(TERMS) == number, amount * 1e-3, 0.0)
        return 1e3 * _reflected(amounts, -np.tensordot(amounts, shapes, 1), x, y).opl[1:3]

    before, behind = (np.full((SIDE, SIDE), np.nan) for _ in range(2))
    before[inside], behind[inside] = paths(term)
    came, command = (amount * zernike_terms("noll", (term,), *points)[0] for points in ((x, y), np.meshgrid(at, at)))
    left_theory = came - RectBivariateSpline(at, at, command).ev(y, x)
    left = [_rms(behind) / _rms(before) for before, behind in map(paths, TERMS)]

    grid, none = RADIUS * at, np.zeros(len(TERMS))
    slope = math.sin(2 * math.radians(TURN))
    by_actuators = _reflected(none, np.repeat(slope * grid[:, None], actuators, 1), 0 * x, 1 + 0 * y)
    plane = jax.device_get(trace(_bench().replace(surface=2, tilt=(TURN, 0.0, 0.0)), pupil=(0.0, np.ones(1))))
    turned, leaving = (math.degrees(math.atan2(path.m[-1, 0], -path.n[-1, 0])) for path in (plane, by_actuators))
    bowl = _reflected(none, -(grid[:, None] ** 2 + grid**2) / (2 * FOCAL_LENGTH), 0 * x, 1 + 0 * y)
    crossing = -float(bowl.y[2, 0] * bowl.n[2, 0] / bowl.m[2, 0])
    name = zernike_name(*zernike_index("noll", term))
    return DeformableMirror(
        setting=f"a wavefront with {amount:g} um RMS of Noll's polynomial {term} ({name or 'of high order'}) meets a "
        f"mirror with {actuators} x {actuators} actuators, radius of the pupil {RADIUS:g} mm",
        rows=(
            Comparison(f"a plane mirror turned by {TURN:g} deg: light leaves at", "deg", turned, 2 * TURN),
            Comparison("turned so by its actuators: light leaves as from the plane", "deg", leaving, turned),
            Comparison(
                f"a bowl: the ray at {RADIUS:g} mm crosses the axis at",
                "mm",
                crossing,
                -math.sqrt(FOCAL_LENGTH**2 - RADIUS**2),
            ),
            Comparison(
                f"left of polynomial {term}",
                "um",
                _rms(behind[inside]),
                _rms(np.asarray(left_theory)),
                ROUNDING * amount,
            ),
            Comparison(f"left of {amount:g} um of coma", "um", _rms(paths(COMA)[1]), 0.0, ROUNDING * amount),
        ),
        name=name,
        actuators=actuators,
        x=side * RADIUS,
        before=before,
        behind=behind,
        terms=np.array(TERMS),
        orders=np.array([zernike_index("noll", number)[0] for number in TERMS]),
        left=np.array(left),
    )


def _rms(path: np.ndarray) -> float:
    return float(np.sqrt(np.mean(path * path)))


def _reflected(amounts: np.ndarray, command: np.ndarray, x: np.ndarray, y: np.ndarray) -> Any:
    """A `Ray` of numpy arrays: rays along the axis, at points x, y of the unit disk, at the launch, behind the air and
    behind the mirror; amounts of the TERMS, and command, in mm."""
    air = ZernikeScreen(tuple(amounts), RADIUS, TERMS, "noll")
    path = trace(
        _bench().replace(surface=1, screen=air).replace(surface=2, screen=GridScreen(command, (RADIUS, RADIUS))),
        pupil=(x, y),
    )
    return jax.device_get(path)


@functools.cache
def _bench() -> Lens:
    """The air and the mirror, without their screens."""
    rows = [{"stop": True}, {"mirror": True, "thickness": -100.0}]
    return lens(rows, {"entrance_pupil_diameter": 2 * RADIUS}, [0.0], [0.5876])
