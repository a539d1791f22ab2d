"""A prism: its deviation has a minimum, where light passes symmetrically; a real glass spreads white light.

With the apex angle A, the incidence i and the index n, counted toward the base,

    D(i) = i - A + arcsin(sin A sqrt(n^2 - sin^2 i) - cos A sin i).

At its minimum the ray inside makes A/2 with both faces, and

    sin i = n sin(A/2),     D = 2 i - A,     n = sin((A + D)/2) / sin(A/2),     dD/dn = 2 sin(A/2) / cos i,

the third of which is how Fraunhofer measured indices. No ray passes if n sin(A/2) > 1, and none whose incidence is less
than sin i = n sin(A - arcsin(1/n)). The minimum is found as the place where the derivative of the traced deviation
ceases to be negative.
Source: Born & Wolf, Principles of Optics (7th ed.), section 4.7.2.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import is_traced
from lenstrace.errors import OptionError
from lenstrace.optics.colour import encoded, srgb_of_xyz, within_gamut, xyz_of_wavelength
from lenstrace.optics.glasses import glass as glass_of
from lenstrace.optics.media import LINE_C, LINE_D, LINE_F
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.edge import edge
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.phenomena.surface import refracted

WAVELENGTHS = np.linspace(0.40, 0.70, 61)  # of the spectrum, um
STEPS = np.linspace(0.01, 0.999, 80) ** 2  # from the least incidence to 90 degrees: closer where the curve is steep
GLASSES = ("N-BK7", "F2", "N-SF11", "SILICA", "CAF2", "WATER", "DIAMOND")
ENTRANCE = 0.5  # from the apex, in sides of the prism
SOURCE, SCREEN = 0.7, 1.2  # from where the light enters and leaves, in sides
FADING = 0.3  # light that is brighter, in a screen's units, is shown as bright as can be; the ends of the spectrum fade
NEAREST = 0.9999  # n sin(A/2): beyond it what passes, if any, all but grazes both faces
ROUNDING = 1e-14  # of sines, and of slopes
# Rows of the rays: each index at its least deviation, white light as the d line is then, and steps.
LEAST, WHITE, REST = 0, 1, 2


@result
class Prism(Demonstration):
    """White light through a prism of glass, and how far rays are bent; in sides of the prism, the apex at 0, y up.

    corners:               (2, 4), y and z of the outline.
    course:                (2, 4, W), of the rays of W colours.       colours: (W, 3), sRGB, 0 to 1.
    glass, index:          what is compared.
    incidence, deviation:  (A, 1 + W), radians, for the index and then for all colours.
    least:                 incidence and least deviation for the index.        white: incidence of the white light.
    """

    corners: np.ndarray
    course: np.ndarray
    colours: np.ndarray
    glass: str
    index: float
    incidence: np.ndarray
    deviation: np.ndarray
    least: tuple[float, float]
    white: float


class _Rays(NamedTuple):
    """Rays through a prism: y and z of their directions, (2, K, N); whether they pass, (K, N)."""

    before: jax.Array
    inside: jax.Array
    behind: jax.Array
    passes: jax.Array


@demonstration
def prism(
    apex: Annotated[float, Option("apex angle", "deg", least=1, most=140, slider=(5, 80))] = 60.0,
    index: Annotated[float, Option("refractive index", least=1.05, most=5, slider=(1.05, 1.9))] = 1.5,
    glass: Annotated[str, Option("glass whose spectrum is shown", choices=GLASSES)] = "F2",
) -> Prism:
    """A prism at minimum deviation, and the spectrum of a real glass in true colours.

    OptionError where no light passes.
    """
    a = math.radians(apex)
    medium = glass_of(glass)
    lines = medium.index(np.array([LINE_D, LINE_F, LINE_C]))
    for name, n in ((f"the index {index:g}", index), (glass, lines[0])):
        if n * math.sin(a / 2) > NEAREST:
            largest = math.degrees(2 * math.asin(NEAREST / n))
            raise OptionError(
                f"prism: no ray passes a prism of {name} with the apex angle {apex:g} deg; keep it below {largest:.4g}"
            )
    indices = np.array([index, *medium.index(WAVELENGTHS), *lines])
    (smallest, *incidence), rays, faster, colours = jax.device_get(_measured(a, indices, WAVELENGTHS))
    if not rays.passes[WHITE, 1:].all():
        raise OptionError(
            f"prism: of the white light on {glass} at the apex angle {apex:g} deg some colours are reflected totally; "
            "make the apex angle smaller"
        )
    deviation = np.arctan2(*_turn(rays.before, rays.behind))
    (found, *_, of_d, _, _), (*_, of_f, of_c) = deviation[LEAST], deviation[WHITE]
    first, second = _normals(a)
    inside = np.arctan2(*_turn(rays.inside[:, LEAST, 0], first))
    behind = np.arctan2(*_turn(second, rays.behind[:, LEAST, 0]))
    i, i_of_d = (math.asin(n * math.sin(a / 2)) for n in (index, lines[0]))
    starting = math.asin(index * math.sin(a - math.asin(1 / index)))
    apart = _deviation(i_of_d, a, lines[1]) - _deviation(i_of_d, a, lines[2])
    near, near_d = _nearness(i, a), _nearness(i_of_d, a)
    first_near = ROUNDING * index**2 / math.cos(starting)
    fraunhofer, power = math.sin((a + found) / 2) / math.sin(a / 2), 2 * math.sin(a / 2) / math.cos(i)
    return Prism(
        setting=f"a prism of the apex angle {apex:g} deg in air, of the index {index:g} and of {glass}",
        rows=(
            _in_degrees("least deviation", found, 2 * i - a, ROUNDING / math.cos(i)),
            _in_degrees("incidence there", incidence[LEAST][0], i, near),
            _in_degrees("angle there inside, to the first normal", inside, a / 2, near),
            _in_degrees("angle there behind, to the second normal", behind, i, near),
            Comparison("index from the least deviation", "", fraunhofer, index, ROUNDING / a),
            Comparison("change of it with the index", "", faster[LEAST, 0], power, ROUNDING / math.cos(i) ** 3),
            _in_degrees("least incidence that passes", smallest[0], starting, first_near),
            _in_degrees(f"{glass}: least deviation of the d line", of_d, 2 * i_of_d - a, ROUNDING / math.cos(i_of_d)),
            _in_degrees(f"{glass}: lines F and C apart, there", of_f - of_c, apart, near_d),
        ),
        corners=np.array([[0, -math.cos(a / 2), -math.cos(a / 2), 0], [0, -math.sin(a / 2), math.sin(a / 2), 0]]),
        course=_course(a, *(each[:, WHITE, 1:-3] for each in (rays.before, rays.inside, rays.behind))),
        colours=colours,
        glass=glass,
        index=index,
        incidence=np.array(incidence[REST:])[:, :-3],
        deviation=deviation[REST:, :-3],
        least=(float(incidence[LEAST][0]), float(found)),
        white=float(incidence[WHITE][0]),
    )


@jax.jit
def _measured(apex: jax.Array, indices: jax.Array, um: jax.Array) -> tuple[jax.Array, _Rays, jax.Array, jax.Array]:
    """Incidences, (1 + K, N): the least that pass, those of the least deviation, that of the third index from the end,
    and steps up to 90 degrees; of all but the first the rays, and the change of their deviation with the index; the
    colours of `um`."""

    def before(incidence: jax.Array) -> jax.Array:
        """(2, N), True up to where rays begin to pass, and up to the least deviation."""
        one = jnp.ones_like(incidence)
        _, slope, rays = jax.jvp(lambda i: _through(i, indices, apex), (incidence,), (one,), has_aux=True)
        return ~rays.passes | (jnp.array([[False], [True]]) & (slope < 0))

    right = jnp.full_like(indices, math.pi / 2)
    smallest, least = edge(before, jnp.stack([-right, -right]), jnp.stack([right, right]))
    steps = smallest + (right - smallest) * jnp.asarray(STEPS)[:, None]
    asked = jnp.concatenate([jnp.stack([least, jnp.full_like(least, least[-3])]), steps])
    n = jnp.broadcast_to(indices, asked.shape)
    _, faster, rays = jax.jvp(lambda n: _through(asked, n, apex), (n,), (jnp.ones_like(n),), has_aux=True)
    rgb = within_gamut(srgb_of_xyz(xyz_of_wavelength(um)))
    brightest = rgb.max(-1, keepdims=True)
    return jnp.concatenate([smallest[None], asked]), rays, faster, encoded(rgb / jnp.maximum(brightest, FADING))


def _through(incidence: jax.Array, index: jax.Array, apex: jax.Array) -> tuple[jax.Array, _Rays]:
    """Deviation, toward the base, of rays refracted at the first face and at the second; and the rays."""
    zero, one = jnp.zeros_like(incidence), jnp.ones_like(incidence)
    (first_y, first_z), (second_y, second_z) = _normals(apex)
    before = zero, jnp.sin(incidence - apex / 2), jnp.cos(incidence - apex / 2)
    inside, enters = refracted(before, (zero, first_y * one, first_z * one), one, index)
    # a ray may run along the prism and never meet the second face
    meets = inside[1] * second_y + inside[2] * second_z > 0
    behind, leaves = refracted(inside, (zero, second_y * one, second_z * one), index, one)
    courses = (jnp.stack(each[1:]) for each in (before, inside, behind))
    rays = _Rays(*courses, passes=enters & meets & leaves)
    return jnp.arctan2(*_turn(rays.before, rays.behind)), rays


def _normals(apex: Any) -> tuple[Any, Any]:
    """y and z of the normals of both faces, along the light."""
    xp = jnp if is_traced(apex) else np
    return (-xp.sin(apex / 2), xp.cos(apex / 2)), (xp.sin(apex / 2), xp.cos(apex / 2))


def _turn(one: Any, other: Any) -> tuple[Any, Any]:
    """Sine and cosine of the angle from one direction to another, toward the base; y and z of each."""
    return one[0] * other[1] - one[1] * other[0], one[0] * other[0] + one[1] * other[1]


def _course(apex: float, before: np.ndarray, inside: np.ndarray, behind: np.ndarray) -> np.ndarray:
    """(2, 4, W), y and z: a start, the points on both faces, and a screen; from directions, (2, W)."""
    second = np.array(_normals(apex)[1])
    entrance = -ENTRANCE * np.array([[math.cos(apex / 2)], [math.sin(apex / 2)]])
    leaving = entrance - (second @ entrance) / (second @ inside) * inside
    return np.stack([entrance - SOURCE * before, entrance + 0 * before, leaving, leaving + SCREEN * behind], 1)


def _deviation(incidence: float, apex: float, n: float) -> float:
    """See the docstring of this file."""
    sine = math.sin(incidence)
    return incidence - apex + math.asin(math.sin(apex) * math.sqrt(n * n - sine * sine) - math.cos(apex) * sine)


def _nearness(i: float, apex: float) -> float:
    """How near a minimum at the incidence i is found: where its slope, D'' times the distance, rises above rounding."""
    curvature = 2 * (math.tan(i) - math.tan(apex / 2) ** 2 / math.tan(i))
    return ROUNDING / (curvature * math.cos(i) ** 2)


def _in_degrees(quantity: str, measured: float, theory: float, within: float) -> Comparison:
    """Angles given in radians."""
    return Comparison(quantity, "deg", *(math.degrees(each) for each in (measured, theory, within)))
