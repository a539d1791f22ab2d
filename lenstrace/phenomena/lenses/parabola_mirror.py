"""Why a telescope's mirror is a parabola: the spot of a parabolic mirror and of a spherical one.

A ray parallel to the axis meets a sphere of radius R = 2 f at the height h = R sin i, is turned by 2 i, and crosses the
axis at the distance R - R / (2 cos i) from the vertex; in the focal plane it is

    H = (R / 2) (1 / cos i - 1) tan 2i = R sin^3 i / ((1 + cos i) (1 - 2 sin^2 i)) = h^3 / (2 R^2) + ...,
    d log H / d log h = 3 + sin^2 i / (cos i (1 + cos i)) + 4 sin^2 i / (1 - 2 sin^2 i)

from the axis. The parabola sends every ray through the focus.
Source: Hecht, Optics, section 5.4; Born & Wolf, Principles of Optics, section 4.2.
"""

from __future__ import annotations

from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.lenses.near_axis import Neighbours, neighbours
from lenstrace.phenomena.options import Option, demonstration, positive_length
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

MIRRORS = ("parabola", "sphere")
CONICS = np.array([-1.0, 0.0])
HIGHEST = 1.3  # focal lengths; at 1.41 a ray leaves the sphere across the axis
ROUNDING = 1e-14  # of the lengths that are added up
NODES = 24  # of Gauss's rule over the area of the beam: exact to rounding up to HIGHEST
APERTURES, DECADES = 15, 2  # on the curves, over so many decades
DRAWN = 8  # rays of each mirror


@result
class ParabolaMirror(Demonstration):
    """Rays of both mirrors, and how large their spots are; lengths in mm, z from the vertex. First the parabola.

    focal_length:  f.
    heights:       (N,), of the rays that are drawn.
    met:           (2, N), z where they meet the mirrors.           slopes: (2, N), dy/dz behind them.
    profiles:      (2, M), z of the mirrors at profile_heights, (M,).
    apertures:     (A,), radius of the beam, in focal lengths.
    largest, rms:  (2, A), of the spots in the focal plane.
    largest_theory, rms_theory:  (A,), of the sphere.
    """

    focal_length: float
    heights: np.ndarray
    met: np.ndarray
    slopes: np.ndarray
    profiles: np.ndarray
    profile_heights: np.ndarray
    apertures: np.ndarray
    largest: np.ndarray
    rms: np.ndarray
    largest_theory: np.ndarray
    rms_theory: np.ndarray


@demonstration
def parabola_mirror(
    focal_length: Annotated[float, positive_length("focal length of both mirrors", slider=(50, 2000))] = 100.0,
    aperture: Annotated[
        float, Option("radius of the beam in focal lengths", least=1e-3, most=HIGHEST, slider=(0.01, 1))
    ] = 0.5,
    heights: Annotated[
        tuple[float, ...], Option("rays in the table: height in focal lengths", least=1e-3, most=HIGHEST)
    ] = (0.1, 0.3, 0.5),
) -> ParabolaMirror:
    """A parabolic mirror and a spherical one: the spot of a star."""
    f, radius = focal_length, 2 * focal_length
    apertures = aperture * np.geomspace(10.0**-DECADES, 1, APERTURES)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    # nodes over the area, in radii of the beam
    inside = np.sqrt((1 + nodes) / 2)
    table, drawn = f * np.array(heights), f * aperture * np.linspace(0, 1, DRAWN + 1)[1:]
    parts = [table, drawn, f * apertures, np.outer(f * apertures, inside).ravel()]
    mirror = lens(
        [{"radius": -radius, "conic": -1.0, "mirror": True, "thickness": -f, "stop": True}],
        {"entrance_pupil_diameter": 2 * f * aperture},
        [0.0],
        [0.5876],
    )
    near = jax.device_get(_through(mirror, CONICS, np.concatenate(parts)))
    bounds = np.cumsum([len(part) for part in parts])[:-1]
    y, z, slope, landed, moving = (
        np.split(a, bounds, axis=1)
        for a in (
            near.path.y[:, 1],
            near.path.z[:, 1],
            near.path.m[:, 1] / near.path.n[:, 1],
            near.path.y[:, 2],
            near.y[:, 2],
        )
    )
    crossing = y[0] / slope[0] - z[0]
    rms = np.sqrt((landed[3].reshape(2, APERTURES, NODES) ** 2) @ weights / 2)

    sine = table / radius
    cosine = np.sqrt(1 - sine * sine)
    # what rounding of a direction does in the focal plane, and along the axis to a ray that crosses it at 2 i
    across = ROUNDING * radius / (2 * cosine**2 - 1) ** 2
    along = across / (2 * sine * cosine)
    rows = []
    for i, height in enumerate(heights):
        at = f"ray at {height:g} f"
        rows += [
            Comparison(f"{at}: parabola, crosses the axis", "mm", crossing[0, i], f, along[i]),
            Comparison(f"{at}: sphere, crosses the axis", "mm", crossing[1, i], radius - f / cosine[i], along[i]),
            Comparison(f"{at}: parabola, height in the focal plane", "mm", landed[0][0, i], 0.0, across[i]),
            Comparison(
                f"{at}: sphere, height in the focal plane", "mm", landed[0][1, i], -_height(radius, sine)[i], across[i]
            ),
        ]
    edge = aperture / 2  # sin i
    most = ROUNDING * radius / (1 - 2 * edge * edge) ** 2
    cosine_edge = np.sqrt(1 - edge * edge)
    growth = 3 + edge**2 / (cosine_edge * (1 + cosine_edge)) + 4 * edge**2 / (1 - 2 * edge**2)
    exponent = f * aperture * moving[2][1, -1] / landed[2][1, -1]
    rms_theory = np.array([_rms(radius, f * each) for each in apertures])
    rows += [
        Comparison(f"beam of radius {aperture:g} f: parabola, RMS spot", "mm", rms[0, -1], 0.0, most),
        Comparison(f"beam of radius {aperture:g} f: sphere, RMS spot", "mm", rms[1, -1], rms_theory[-1], most),
        Comparison(
            "sphere: the miss grows with this power of the height there", "", exponent, growth, most / radius / edge**2
        ),
    ]
    profile_heights = 1.05 * f * aperture * np.linspace(-1, 1, 101)
    sphere = -(profile_heights**2) / radius / (1 + np.sqrt(1 - (profile_heights / radius) ** 2))
    return ParabolaMirror(
        setting=f"a beam of radius {f * aperture:g} mm along the axis meets mirrors of focal length {f:g} mm, a "
        "parabola and a sphere; distances along the axis count from the vertex toward the light",
        rows=tuple(rows),
        focal_length=f,
        heights=drawn,
        met=z[1],
        slopes=slope[1],
        profiles=np.array([-(profile_heights**2) / (4 * f), sphere]),
        profile_heights=profile_heights,
        apertures=apertures,
        largest=abs(landed[2]),
        rms=rms,
        largest_theory=_height(radius, apertures / 2),
        rms_theory=rms_theory,
    )


@jax.jit
def _through(mirror: Lens, conics: jax.Array, heights: jax.Array) -> Neighbours:
    """Rays at the heights, mm, and their neighbours, on mirrors of several conics."""
    ones = jnp.ones_like(heights)
    return jax.vmap(lambda conic: neighbours(mirror.replace(surface=1, conic=conic), ones, 0 * ones, heights))(conics)


def _height(radius: float, sine: np.ndarray) -> np.ndarray:
    """H of the sphere, see the docstring of this file."""
    return radius * sine**3 / ((1 + np.sqrt(1 - sine * sine)) * (1 - 2 * sine * sine))


def _rms(radius: float, beam: float) -> float:
    """sqrt(2 / b^2 integral of H^2 h dh from 0 to b), over the angle i."""
    nodes, weights = np.polynomial.legendre.leggauss(2 * NODES)
    last = np.arcsin(beam / radius)
    angle = last * (1 + nodes) / 2
    integrand = _height(radius, np.sin(angle)) ** 2 * radius**2 * np.sin(angle) * np.cos(angle)
    return float(np.sqrt(2 / beam**2 * (integrand @ weights) * last / 2))
