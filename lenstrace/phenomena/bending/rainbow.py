"""The rainbow: light that enters a round drop, is reflected k times inside, and leaves, piles up at one angle.

A ray at the impact parameter b = sin i (in radii of the drop, sin i = n sin r) is turned by

    T = 2 (i - r) + k (180 deg - 2 r),

which is least where cos^2 i = (n^2 - 1) / (k (k + 2)). There neighbouring rays leave alike: the primary bow, k = 1,
lies at 180 deg - T from the point opposite the sun, the secondary at T - 180 deg, and between them is Alexander's dark
band. Per solid angle the drop sends back the cross section

    ds/dO = b / (sin T |dT/db|)  times  (1 - R)^2 R^k,

without bound at the bow itself; the sun's disc, half a degree wide, blurs that. R is Fresnel's reflectance, for each
polarization the same at every surface. What the outside of a drop reflects, R / 4, is seen in the dark band. Waves, and
with them the bows inside the primary, are left out, and light that is reflected more than twice.
Source: H. C. van de Hulst, Light Scattering by Small Particles (1957), chapters 12 and 13; the angles are Descartes'.
"""

from __future__ import annotations

import math
from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.colour import encoded, srgb_of_xyz, within_gamut, xyz_of_wavelength
from lenstrace.optics.fresnel import reflectances
from lenstrace.optics.glasses import glass
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.drop import ORDERS, DropRays, spread, through_drop
from lenstrace.phenomena.edge import edge
from lenstrace.phenomena.options import Option, demonstration

WAVELENGTHS = np.linspace(0.40, 0.70, 61)  # of white light, um
PROBE = 0.3  # impact parameter at which the intensity is compared: away from every bow
FAN = np.linspace(0.06, 0.98, 16)  # impact parameters of the rays that are drawn
APPROACH = np.linspace(0, 0.999, 121) ** 2  # from a bow to either end of the impact parameters, closer at the bow
BIN = math.radians(0.02)  # of the sky
EDGES = np.arange(math.radians(30), math.radians(62), BIN)  # from the point opposite the sun
ROUNDING = 1e-13  # of angles and impact parameters


@result
class Rainbow(Demonstration):
    """Rays through a drop of radius 1 at the origin, and the sky of many drops of water.

    points, ways:    (4, 2, N) and (2, N), y and z of the points where rays of the primary bow meet the drop, the first
                     three of which count, and of their directions behind it; the first is Descartes' ray.
    second, second_way:  (4, 2) and (2,), the same of Descartes' ray of the secondary bow.
    angles:          (A,), from the point opposite the sun, radians.
    luminance:       (A,), of the sky there; 1 if drops sent the light that meets them evenly to all sides.
    colours:         (A, 3), sRGB, 0 to 1.
    bows:            (2, W), primary and secondary of water, from 0.40 to 0.70 um, radians.
    index:           of the drop.
    """

    points: np.ndarray
    ways: np.ndarray
    second: np.ndarray
    second_way: np.ndarray
    angles: np.ndarray
    luminance: np.ndarray
    colours: np.ndarray
    bows: np.ndarray
    index: float


@demonstration
def rainbow(
    index: Annotated[float, Option("refractive index of the drop", least=1.25, most=1.9)] = 1.333,
    sun: Annotated[float, Option("diameter of the sun's disc", "deg", least=0.05, most=5)] = 0.53,
) -> Rainbow:
    """The rainbow: Descartes' rays through a drop, both bows and the dark band in true colours."""
    indices = np.array([index, *glass("WATER").index(WAVELENGTHS)])
    impacts, rays, slopes, outside, observer = jax.device_get(_measured(indices, WAVELENGTHS))
    # from the point opposite the sun; rays of the two orders come from opposite sides of it
    angles = np.arctan2(rays.way[0] * (2 * ORDERS - 3), -rays.way[1])
    left = rays.left.mean(0)
    rows = []
    for order, name in ((0, "primary"), (1, "secondary")):
        i, r, angle = _bow(order + 1, index)
        (s, p), (s_theory, p_theory) = rays.left[:, order, 0, 0], _left(order + 1, i, r)
        polarized = (s_theory - p_theory) / (s_theory + p_theory)
        sent = PROBE * left[order, 1, 0] / (math.sin(angles[order, 1, 0]) * abs(slopes[order, 1, 0]))
        rows += [
            _in_degrees(f"{name} bow", angles[order, 0, 0], angle),
            Comparison(f"{name}: impact parameter", "", impacts[order, 0, 0], math.sin(i), ROUNDING),
            Comparison(f"{name}: degree of polarization", "", (s - p) / (s + p), polarized),
            Comparison(f"{name}: ds/dO of rays at b = {PROBE:g}", "", sent, _cross_section(order + 1, index)),
        ]
    bows, theory = angles[:, 0, 1:], np.array([[_bow(k, n)[2] for n in indices[1:]] for k in (1, 2)])
    for order, name in ((0, "primary"), (1, "secondary")):
        (violet, *_, red), (violet_theory, *_, red_theory) = bows[order], theory[order]
        rows += [
            _in_degrees(f"water: {name} bow, 0.70 µm", red, red_theory),
            _in_degrees(f"water: {name} bow, 0.40 µm", violet, violet_theory),
            _in_degrees(f"water: {name}, width", abs(red - violet), abs(red_theory - violet_theory)),
        ]
    rows.append(_in_degrees("water: dark band", bows[1].min() - bows[0].max(), theory[1, -1] - theory[0, -1]))
    curves = (np.moveaxis(each[:, 2 + len(FAN) :, 1:], 2, 0) for each in (angles, left, impacts))
    by_wavelength = outside[:, 1:].T + np.array([spread(EDGES, *each) for each in zip(*curves, strict=True)])
    sky, white = observer.T @ by_wavelength / observer[:, 1].sum(), observer.sum(0) / observer[:, 1].sum()
    xyz, seen = _blurred(sky, math.radians(sun)), (EDGES[1:] + EDGES[:-1]) / 2
    hidden = (len(seen) - len(xyz)) // 2
    return Rainbow(
        setting=f"round drops of the index {index:g}, and of water at 20 °C; a sun of {sun:g} deg",
        rows=tuple(rows),
        points=rays.points[:, :, 0, [0, *range(2, 2 + len(FAN))], 0],
        ways=rays.way[:, 0, [0, *range(2, 2 + len(FAN))], 0],
        second=rays.points[:, :, 1, 0, 0],
        second_way=rays.way[:, 1, 0, 0],
        angles=seen[hidden : len(seen) - hidden],
        luminance=xyz[:, 1],
        colours=np.asarray(_shown(xyz, white)),
        bows=bows,
        index=index,
    )


@jax.jit
def _measured(indices: jax.Array, um: jax.Array) -> tuple[jax.Array, DropRays, jax.Array, jax.Array, jax.Array]:
    """Impact parameters, (2, K, N), of the bows, the probe, the fan, and from the bows to 0 and to 1; the rays, and how
    fast they turn with them; what the outside of a drop reflects, (A, N); the observer, (W, 3)."""

    def turn(b: jax.Array) -> tuple[jax.Array, jax.Array, DropRays]:
        def turned(b: jax.Array) -> tuple[jax.Array, DropRays]:
            rays = through_drop(b, jnp.broadcast_to(indices, b.shape))
            return jnp.arctan2(-rays.way[0], rays.way[1]), rays

        return jax.jvp(turned, (b,), (jnp.ones_like(b),), has_aux=True)

    zero = jnp.zeros((2, 1, len(indices)))
    bow = edge(lambda b: turn(b)[1] < 0, zero, zero + 1)
    approach = jnp.asarray(APPROACH)[:, None]
    fixed = jnp.asarray([PROBE, *FAN])[:, None] + zero
    b = jnp.concatenate([bow, fixed, bow * (1 - approach), bow + (1 - bow) * approach], 1)
    _, slopes, rays = turn(b)
    halves = jnp.cos(jnp.asarray(EDGES[1:] + EDGES[:-1])[:, None] / 4 + 0 * indices)
    s, p = reflectances(halves, jnp.ones_like(indices), indices)
    return b, rays, slopes, (s + p) / 2, xyz_of_wavelength(um)


@jax.jit
def _shown(xyz: jax.Array, white: jax.Array) -> jax.Array:
    """Colours of a picture in which white light is white and the brightest colour as bright as can be."""
    rgb = within_gamut(srgb_of_xyz(xyz) / srgb_of_xyz(white))
    return encoded(rgb / rgb.max())


def _blurred(sky: np.ndarray, sun: float) -> np.ndarray:
    """(A, 3), the sky (3, A') of a point, averaged over the disc of the sun; bins near the ends are left out."""
    half = int(sun / 2 / BIN)
    disc = np.sqrt(1 - (np.arange(-half, half + 1) / (half + 1)) ** 2)
    return np.array([np.convolve(each, disc / disc.sum(), "valid") for each in sky]).T


def _bow(order: int, n: float) -> tuple[float, float, float]:
    """Incidence, angle inside, and angle from the point opposite the sun; see the docstring of this file."""
    i = math.acos(math.sqrt((n * n - 1) / (order * (order + 2))))
    r = math.asin(math.sin(i) / n)
    turned = 2 * (i - r) + order * (math.pi - 2 * r)
    return i, r, math.pi - turned if order == 1 else turned - math.pi


def _left(order: int, i: float, r: float) -> tuple[float, float]:
    """What is left of light polarized across the plane, and in it, by Fresnel's sines and tangents."""
    s, p = (math.sin(i - r) / math.sin(i + r)) ** 2, (math.tan(i - r) / math.tan(i + r)) ** 2
    return (1 - s) ** 2 * s**order, (1 - p) ** 2 * p**order


def _cross_section(order: int, n: float) -> float:
    """ds/dO at the probe."""
    i = math.asin(PROBE)
    r = math.asin(PROBE / n)
    turned = 2 * (i - r) + order * (math.pi - 2 * r)
    change = (2 - 2 * (order + 1) * math.cos(i) / (n * math.cos(r))) / math.cos(i)
    return PROBE * sum(_left(order, i, r)) / 2 / abs(math.sin(turned) * change)


def _in_degrees(quantity: str, measured: float, theory: float) -> Comparison:
    """Angles given in radians."""
    return Comparison(quantity, "deg", *(math.degrees(each) for each in (measured, theory, ROUNDING)))
