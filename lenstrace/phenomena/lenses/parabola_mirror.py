"""Parabola against sphere as the mirror of a telescope: where a beam along the axis goes.

A sphere of radius R sends the ray that falls in at sin i = h / R to R / (2 cos i) from its centre, where those near the
axis go to R / 2; in the plane of that focus it misses by

    (R - R / (2 cos i) - R / 2) tan 2i,      about h^3 / R^2.

A parabola sends all of them to R / 2, by paths that are equal.
Source: Born & Wolf, Principles of Optics (7th ed.), section 4.4; Kepler, Paralipomena (1604), on the parabola.
"""

from __future__ import annotations

from typing import Annotated, Any

import jax
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.prescription import lens

RAYS = 24  # drawn; none of them on the axis
HEIGHTS = np.geomspace(0.01, 1, 25)  # of the beam, for the plot
PERFECT = 1e-14  # of the focal length


@result
class ParabolaMirror(Demonstration):
    """A beam on two mirrors; mm, z from the vertex, toward the light.

    radius:           of curvature, both.
    heights:          (N,).        mirror_z, crossings: (2, N), of the sphere and of the parabola.
    f_numbers:        (K,), of beams.       misses: (2, K), of their outermost rays, in the plane of the focus.
    theory:           (K,), of the sphere.
    """

    radius: float
    heights: np.ndarray
    mirror_z: np.ndarray
    crossings: np.ndarray
    f_numbers: np.ndarray
    misses: np.ndarray
    theory: np.ndarray


@demonstration
def parabola_mirror(
    focal_length: Annotated[float, Option("focal length of the mirrors", "mm", above=0, most=1e6)] = 100.0,
    diameter: Annotated[float, Option("diameter of the beam over the focal length", above=0, most=2.7)] = 1.2,
) -> ParabolaMirror:
    """Parabola against sphere: a mirror that focuses, and one that nearly does."""
    radius, half = 2 * focal_length, diameter * focal_length / 2
    share = np.linspace(-1, 1, RAYS)
    sphere, parabola = (_on(conic, radius, half, np.append(share, HEIGHTS)) for conic in (0.0, -1.0))
    y = half * np.append(share, HEIGHTS)
    sine = y / radius
    cosine = np.sqrt(1 - sine**2)
    # R - R / (2 cos i) - R / 2, written so that nothing cancels
    along = radius * sine**2 / (2 * cosine * (1 + cosine))
    miss = along * 2 * sine * cosine / (1 - 2 * sine**2)
    where = radius / 2 - along
    crossings = np.array([-(mirror.z[1] - mirror.y[1] * mirror.n[1] / mirror.m[1]) for mirror in (sphere, parabola)])
    path = parabola.opl[1] + np.hypot(parabola.y[1], focal_length + parabola.z[1])
    rows = []
    for at in (RAYS // 2 + RAYS // 4, RAYS - 1):
        ray = f"ray at {y[at]:.4g} mm"
        rows += [
            Comparison(f"{ray}: sphere sends it to", "mm", crossings[0, at], where[at]),
            Comparison(f"{ray}: in the focal plane it misses by", "mm", -sphere.y[2, at], miss[at]),
            Comparison(f"{ray}: parabola sends it to", "mm", crossings[1, at], focal_length),
            Comparison(f"{ray}: there it misses by", "mm", parabola.y[2, at], 0.0, PERFECT * focal_length),
            Comparison(f"{ray}: path to the focus", "mm", path[at], focal_length),
        ]
    beams = slice(RAYS, None)
    return ParabolaMirror(
        setting=f"a beam of {2 * half:g} mm along the axis of mirrors of focal length {focal_length:g} mm",
        rows=tuple(rows),
        radius=radius,
        heights=y[:RAYS],
        mirror_z=-np.array([sphere.z[1, :RAYS], parabola.z[1, :RAYS]]),
        crossings=crossings[:, :RAYS],
        f_numbers=focal_length / (2 * y[beams]),
        misses=np.abs([sphere.y[2, beams], parabola.y[2, beams]]),
        theory=miss[beams],
    )


def _on(conic: float, radius: float, half: float, share: np.ndarray) -> Any:
    """A `Ray` of numpy arrays: the beam at the launch, on the mirror, and in the plane of the focus."""
    mirror = lens(
        [{"radius": -radius, "conic": conic, "mirror": True, "stop": True, "thickness": -radius / 2}],
        {"entrance_pupil_diameter": 2 * half},
        [0.0],
        [0.5876],
    )
    return jax.device_get(trace(mirror, pupil=(0.0, share)))
