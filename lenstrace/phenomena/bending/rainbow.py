"""The rainbow: sunlight that has been reflected once, or twice, inside a drop of water.

A ray that falls on a sphere at the angle i, runs inside at sin r = sin i / n and is reflected k times, is turned by

    D = 2 (i - r) + k (pi - 2 r),

which has an extremum where cos^2 i = (n^2 - 1) / (k (k + 2)). There rays crowd: the drop shines brightly at the angle
t = |pi - D| (from 0 to pi) about the point opposite to the sun. Light that falls in between b and b + db from the axis,
b = sin i, leaves between t and t + dt, so that the drop's intensity is

    I(t) = sum of (1 - R)^2 R^k b / (sin t |dt / db|),

the mean over both polarizations with Fresnel's reflectances R. Between the two bows none of it goes: Alexander's band.
Source: Descartes, Les Meteores (1637), discours 8; van de Hulst, Light Scattering by Small Particles (1957), 13.2.
"""

from __future__ import annotations

import functools
import math
from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.colour import encoded, srgb_of_xyz, within_gamut, xyz_of_wavelength
from lenstrace.optics.fresnel import reflectances
from lenstrace.optics.glasses import glass
from lenstrace.optics.vectors import Vector, dot
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.edge import edge
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.phenomena.surface import reflected, refracted

RED, VIOLET = 0.65, 0.42  # um: a bow is as wide as these are apart
COLOURS = np.linspace(0.40, 0.70, 31)  # um, of sunlight in the picture
SUN_KELVIN = 5772.0  # IAU 2015 resolution B3; as a black body
SECOND_RADIATION = 14387.768775  # um K, h c / k; CODATA 2018
SUN_WIDE = 0.533  # degrees, by which every bow is blurred
FLAT = 1e-7  # degrees: where an extremum is, and a small difference of two of them, is less certain than its height
STEP = 0.05  # degrees, of the sky in the picture
SKY = np.arange(33.0, 61.0, STEP)  # degrees from the point opposite to the sun
RAYS = 20_000  # through a drop, evenly spread from its middle to its rim, for the picture
DRAWN = np.sin(np.radians([15.0, 30.0, 40.0, 50.0, 67.0, 75.0, 83.0]))  # b of rays drawn through a drop


@result
class Rainbow(Demonstration):
    """A drop and the sky.

    course_z, course_y:  (4, N), rays through a drop of radius 1 that are reflected once, and (4,) the one at the bow.
    leaving:             (N,), (2,): z and y of the directions in which they leave.
    bow:                 place of the ray at the bow among them.
    sky:                 (P,), degrees from the point opposite to the sun.
    intensity:           (P,), luminance of the bows there, the brightest 1.     colours: (P, 3), sRGB, 0 to 1.
    bows:                (2,), degrees: primary and secondary, at the index asked for.
    """

    course_z: np.ndarray
    course_y: np.ndarray
    leaving: np.ndarray
    sky: np.ndarray
    intensity: np.ndarray
    colours: np.ndarray
    bows: np.ndarray


@demonstration
def rainbow(
    index: Annotated[float, Option("refractive index of the drop", above=1, below=2, slider=(1.3, 1.5))] = 1.333,
) -> Rainbow:
    """The rainbow: both bows and the dark band between them, by rays through a drop."""
    water = np.asarray(glass("WATER").index(np.array([*COLOURS, RED, VIOLET])))
    indices = np.array([index, *water[-2:]])
    rows, angles = [], {}
    for order, name in ((1, "primary"), (2, "secondary")):
        incidence, angle = (np.asarray(a) for a in _bow(indices, order))
        cosine = np.sqrt((indices**2 - 1) / (order * (order + 2)))
        theory = np.arccos(cosine)
        inside = np.arcsin(np.sin(theory) / indices)
        turned = 2 * (theory - inside) + order * (np.pi - 2 * inside)
        expected = np.abs(np.pi - turned % (2 * np.pi))
        angles[order] = np.degrees(angle), np.degrees(expected)
        (bow, red, violet), (bow_theory, red_theory, violet_theory) = angles[order]
        steepest = np.degrees(np.arcsin(incidence[0]))
        rows += [
            Comparison(f"{name} bow: angle from the antisolar point", "deg", bow, bow_theory),
            Comparison(f"{name} bow: its rays fall in at", "deg", steepest, np.degrees(theory[0]), FLAT),
            Comparison(f"{name} bow in water, red less violet", "deg", red - violet, red_theory - violet_theory, FLAT),
        ]
    dark, dark_theory = (angles[2][place][1] - angles[1][place][1] for place in (0, 1))
    rows.append(Comparison("dark band in water, between the red of both", "deg", dark, dark_theory, FLAT))
    drawn = np.append(DRAWN, np.sin(np.arccos(math.sqrt((index**2 - 1) / 3))))
    points, leaving = jax.device_get(_course(jnp.asarray(drawn), jnp.asarray(index), 1))
    luminance, colours = _sky(water[:-2])
    return Rainbow(
        setting=f"sunlight on a drop of index {index:g}, and of water at {RED:g} and {VIOLET:g} um",
        rows=tuple(rows),
        course_z=np.array([point[2] for point in points]),
        course_y=np.array([point[1] for point in points]),
        leaving=np.array([leaving[2], leaving[1]]).T,
        sky=SKY,
        intensity=luminance,
        colours=colours,
        bows=np.array([angles[1][0][0], angles[2][0][0]]),
    )


def _course(b: jax.Array, index: jax.Array, order: int) -> tuple[list[Vector], Vector]:
    """Rays along +z through a drop of radius 1 at the distance b from its axis, by the tracer's law: the points where
    they meet its surface, and the directions in which they leave."""
    zero, one = 0 * b, 0 * b + 1
    inside = index * one
    point: Vector = (zero, b, -jnp.sqrt((1 - b) * (1 + b)))
    direction, _ = refracted((zero, zero, one), point, one, inside)
    points = [point]
    for bounce in range(order + 1):
        chord = -2 * dot(direction, point)
        x, y, z = (p + chord * d for p, d in zip(point, direction, strict=True))
        point = (x, y, z)
        points.append(point)
        if bounce < order:
            direction = reflected(direction, point)
    return points, refracted(direction, point, inside, one)[0]


def _angle(b: jax.Array, index: jax.Array, order: int) -> jax.Array:
    """t, of rays that leave the drop, radians."""
    _, (x, y, z) = _course(b, index, order)
    return jnp.arctan2(jnp.hypot(x, y), -z)


@functools.partial(jax.jit, static_argnums=1)
def _bow(indices: jax.Array, order: int) -> tuple[jax.Array, jax.Array]:
    """b and t of the ray whose neighbours leave in its own direction, of each index."""
    low, high = jnp.full_like(indices, 0.01), jnp.full_like(indices, 1 - 1e-9)

    def rate(b: jax.Array) -> jax.Array:
        return jax.jvp(lambda b: _angle(b, indices, order), (b,), (jnp.ones_like(b),))[1]

    sense = jnp.sign(rate(low))
    b = edge(lambda b: sense * rate(b) > 0, low, high)
    return b, _angle(b, indices, order)


@functools.partial(jax.jit, static_argnums=2)
def _shining(b: jax.Array, index: jax.Array, order: int) -> tuple[jax.Array, jax.Array]:
    """t, and the light that goes there, of rays at b."""
    cosine = jnp.sqrt((1 - b) * (1 + b))
    both = [(1 - r) ** 2 * r**order for r in reflectances(cosine, jnp.ones_like(index), index)]
    return _angle(b, index, order), b * (both[0] + both[1]) / 2


def _sky(indices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Luminance and sRGB of the sky, for the index of water at the COLOURS."""
    b = (np.arange(RAYS) + 0.5) / RAYS
    edges = np.radians(np.append(SKY, SKY[-1] + STEP) - STEP / 2)
    light = np.zeros((len(COLOURS), len(SKY)))
    for place, n in enumerate(indices):
        for order in (1, 2):
            t, weight = map(np.asarray, _shining(b, np.array(n), order))
            light[place] += np.histogram(t, edges, weights=weight)[0]
    light /= np.sin(np.radians(SKY))
    # the sun is a disk: across it the light is that of its chords
    across = np.arange(-SUN_WIDE / 2, SUN_WIDE / 2 + STEP / 2, STEP)
    disk = np.sqrt(np.maximum(1 - (2 * across / SUN_WIDE) ** 2, 0))
    light = np.array([np.convolve(each, disk / disk.sum(), "same") for each in light])
    planck = 1 / (COLOURS**5 * (np.exp(SECOND_RADIATION / COLOURS / SUN_KELVIN) - 1))
    xyz = np.einsum("cp,c,cj->pj", light, planck / planck.max(), np.asarray(xyz_of_wavelength(jnp.asarray(COLOURS))))
    brightest = xyz[:, 1].max()
    return xyz[:, 1] / brightest, np.asarray(encoded(within_gamut(srgb_of_xyz(jnp.asarray(xyz / brightest)))))
