"""A Zernike polynomial as a screen: what it does to paths and directions of a beam, against its integrals.

The orthonormal polynomial Z of orders n and m over a pupil of radius R, times c, gives a beam along the axis the paths
c Z and the direction cosines c grad Z, whose mean squares over the pupil are

    <W^2> = c^2,      <|grad W|^2> = (c / R)^2 (n + 1) (n (n + 2) - m^2).

The second follows from the first by Green's theorem with Zernike's differential equation. Source of the polynomials:
Noll, JOSA 66, 207 (1976).
"""

from __future__ import annotations

from typing import Annotated, Any

import jax
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.analysis.zernike import fit_zernike
from lenstrace.errors import OptionError
from lenstrace.optics.zernike import zernike_index, zernike_name
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.prescription import lens
from lenstrace.sequential.sampling import pupil_points

FOCAL_LENGTH = 200.0  # mm, of an ideal lens behind the screen, for the picture of the spot
LARGEST = 66  # number of the last term: all up to the tenth order
SIDE = 129  # points along a side of the picture


@result
class ZernikeScreen(Demonstration):
    """A screen, and the spot of a beam through it and an ideal lens.

    name:          of the polynomial.       amount: its coefficient, um.
    x:             (SIDE,), along either side, in units of the pupil's radius.
    path:          (SIDE, SIDE), um, a row for each y; nan outside the pupil.
    spot_x, spot_y:  (N,), mm, in the focal plane of an ideal lens of FOCAL_LENGTH mm.
    """

    name: str
    amount: float
    x: np.ndarray
    path: np.ndarray
    spot_x: np.ndarray
    spot_y: np.ndarray


@demonstration
def zernike_screen(
    term: Annotated[int, Option("number of the polynomial, Noll's", least=2, most=LARGEST)] = 7,
    amount: Annotated[float, Option("coefficient: RMS of the path", "um", size=(1e-3, 50))] = 0.5,
    radius: Annotated[float, Option("radius of the pupil", "mm", least=0.5, most=1000, slider=(1, 20))] = 10.0,
) -> ZernikeScreen:
    """A Zernike screen: paths and directions behind it, against its integrals.

    OptionError where it is so steep that light is turned back.
    """
    c = amount * 1e-3
    n, m = zernike_index("noll", term)
    points = pupil_points("gaussian", n + 2)
    square = np.linspace(-1, 1, SIDE)
    inside = np.hypot(square[:, None], square) <= 1
    drawn_y, drawn_x = (a[inside] for a in np.meshgrid(square, square, indexing="ij"))
    x, y = np.concatenate([points.x, drawn_x]), np.concatenate([points.y, drawn_y])
    whole = _through(term, c, radius, x, y)
    if not whole.ok[1].all():
        raise OptionError(
            f"zernike-screen: {amount:g} um of polynomial {term} on a radius of {radius:g} mm sends no light on at the "
            "rim; lower amount, or enlarge radius"
        )
    count = len(points.x)
    rays = jax.tree.map(lambda a: a[..., :count], whole)
    mean = np.asarray(points.weight) / np.sum(points.weight)
    paths = np.sum(mean * rays.opl[1] ** 2)
    slopes = np.sum(mean * (rays.l[1] ** 2 + rays.m[1] ** 2))
    fitted = fit_zernike("noll", term, points.x, points.y, rays.opl[1], points.weight)
    path = np.full((SIDE, SIDE), np.nan)
    path[inside] = whole.opl[1, count:] * 1e3
    some = slice(count, None, 7)
    return ZernikeScreen(
        setting=f"a beam along the axis through a screen of {amount:g} um of Noll's polynomial {term} "
        f"({zernike_name(n, m) or f'n = {n}, m = {m}'}), radius {radius:g} mm",
        rows=(
            Comparison("RMS of the path over the pupil", "um", 1e3 * np.sqrt(paths), abs(amount)),
            Comparison("the term fitted to the traced paths", "um", 1e3 * float(fitted.coefficients[-1]), amount),
            Comparison(
                "RMS of the angle (sine)",
                "mrad",
                1e3 * np.sqrt(slopes),
                1e3 * abs(c) / radius * np.sqrt((n + 1) * (n * (n + 2) - m * m)),
            ),
        ),
        name=zernike_name(n, m),
        amount=amount,
        x=square,
        path=path,
        spot_x=whole.x[2, some],
        spot_y=whole.y[2, some],
    )


def _through(term: int, coefficient: float, radius: float, x: np.ndarray, y: np.ndarray) -> Any:
    """A `Ray` at points of the pupil: at the launch, behind the screen, behind an ideal lens in the focal plane."""
    thin = lens(
        [
            {"stop": True, "screen": {"zernike": {"radius": radius, "terms": {term: coefficient}}}},
            {"screen": {"ideal_lens": FOCAL_LENGTH}, "thickness": FOCAL_LENGTH},
        ],
        {"entrance_pupil_diameter": 2 * radius},
        [0.0],
        [0.5876],
    )
    path = jax.device_get(trace(thin, pupil=(x, y)))
    return jax.tree.map(lambda a: a[[0, 1, 3]], path)
