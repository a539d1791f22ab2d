"""A prism of negative index: light leaves it on the other side of the normal, bent toward its edge.

The base is up. With angles from the normal of a face, positive where the ray goes up from it, apex angle A and
N = n / n0, a ray of incidence i goes on inside at r and leaves the back face at e,

    sin r = sin i / N,      sin e = N sin(r + A),      deviation D = e - i - A (up is positive),

    dD/dn = sin A / (n0 cos r cos e),      dD/dA = N - 1 where A and i are 0.

They hold for either sign of n. By default it is the wedge in which negative refraction was first seen, by microwaves.
Source: M. Born and E. Wolf, Principles of Optics, section 4.7.2, where n0 = 1 and angles count otherwise; V.
G. Veselago, Sov. Phys. Usp. 10, 509 (1968) for n < 0; R. A. Shelby, D. R. Smith and S. Schultz, Science 292, 77 (2001).
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.compute.compiled import compiled
from lenstrace.errors import OptionError
from lenstrace.optics.rays import living
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration, negative_index, positive_index
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

SIDE = 10.0  # mm from the edge to where the ray enters, along the front face
ROUNDING = 1e-15  # rad, or relative: what a few roundings do before the faces magnify it
GRAZING = 1e-10  # of the sine of an angle below 1: light that goes along a face is counted as reflected totally
CURVE = np.radians(np.arange(-88.0, 89.0, 4.0))  # incidences of the second picture


@result
class NegativePrism(Demonstration):
    """A ray through the prism of index n, and through one of |n| if that lets it pass; lengths in mm.

    ray_z, ray_y:      (4, R), start, both faces and end of R = 1 or 2 rays.
    face_z, face_y:    (3,), upper end of the front face, edge, upper end of the back face.
    normal:            slope dy/dz of the normal of the back face.
    indices:           n and |n|.        incidence: of the rays, deg.
    incidences:        (C,), deg.
    deviations, deviations_theory:  (2, C), deg, for n and |n|; nan where no light passes.
    """

    ray_z: np.ndarray
    ray_y: np.ndarray
    face_z: np.ndarray
    face_y: np.ndarray
    normal: float
    indices: tuple[float, float]
    incidence: float
    incidences: np.ndarray
    deviations: np.ndarray
    deviations_theory: np.ndarray


class _Angles(NamedTuple):
    """From the normals of the faces, inside and behind, and the deviation; radians, up is positive."""

    inside: Any
    behind: Any
    deviation: Any


@demonstration
def negative_prism(
    index: Annotated[float, negative_index("refractive index of the prism", (-3, -1))] = -2.7,
    apex: Annotated[float, Option("angle between its faces", "deg", above=0, most=90, slider=(2, 60))] = 18.43,
    incidence: Annotated[float, Option("from the normal, up is positive", "deg", least=-60, most=60)] = 5.0,
    surroundings: Annotated[float, positive_index("refractive index around it", (1, 2))] = 1.0,
) -> NegativePrism:
    """A prism of negative index bends light toward its edge, away from its base.

    OptionError where the ray is reflected totally, or does not come to the back face.
    """
    edge, i, indices = math.radians(apex), math.radians(incidence), (index, -index)
    _check(index, surroundings, edge, i)
    passing = [n for n in indices if np.isfinite(_theory(n / surroundings, edge, i).deviation)]
    wedge = lens(
        [
            {"thickness": 2 * SIDE * math.sin(edge / 2), "index": index, "tilt": [-apex / 2, 0, 0], "stop": True},
            {"index": surroundings, "tilt": [apex / 2, 0, 0]},
        ],
        {"entrance_pupil_diameter": SIDE},
        [0.0],
        [0.5876],
        object_index=surroundings,
    )
    # rays of the picture, differentiated by n, thin prisms, by the apex angle, and the curves: one program for all
    asked = [(n, edge, i, 1.0, 0.0) for n in passing] + [(n, 0.0, 0.0, 0.0, 1.0) for n in indices]
    asked += [(n, edge, angle, 0.0, 0.0) for n in indices for angle in CURVE]
    moves, angles, height = jax.device_get(_through(wedge, *np.array(asked).T))

    # of the cosine of an angle before a face, the face makes the square of the ratio of the indices
    roundings = ROUNDING * (abs(index) / surroundings + surroundings / abs(index)) ** 2
    rows = []
    for place, n in enumerate(passing):
        theory = _theory(n / surroundings, edge, i)
        cosines = math.cos(theory.inside) * math.cos(theory.behind)
        within = math.degrees(roundings / cosines)
        words = ("inside, from the normal", "behind, from the normal", "deviation, up")
        for what, measured, expected in zip(words, angles, theory, strict=True):
            label = f"n = {n:g}: {what}"
            rows.append(Comparison(label, "deg", math.degrees(measured[place]), math.degrees(expected), within))
        label, moving = f"n = {n:g}: how fast that moves with n", math.degrees(math.sin(edge) / cosines / surroundings)
        rows.append(Comparison(label, "deg", math.degrees(moves[place]), moving, within / cosines**2 / surroundings))
    for place, n in enumerate(indices, len(passing)):
        label = f"n = {n:g}: deviation of a thin prism by its apex angle"
        rows.append(Comparison(label, "", moves[place], n / surroundings - 1, roundings * (1 + abs(n) / surroundings)))

    drawn = slice(len(passing))
    deviations = np.degrees(angles.deviation[-2 * len(CURVE) :].reshape(2, -1))
    curves = np.degrees([_theory(n / surroundings, edge, CURVE).deviation for n in indices])
    return NegativePrism(
        setting=f"a prism of index {index:g} with an apex angle of {apex:g} deg, base up, in a medium of index "
        f"{surroundings:g}; light at {incidence:g} deg from the normal"
        + ("" if len(passing) == 2 else f", which a prism of index {-index:g} does not let through"),
        rows=tuple(rows),
        **_drawing(edge, i, angles.behind[drawn], height[drawn]),
        normal=-math.tan(edge / 2),
        indices=indices,
        incidence=incidence,
        incidences=np.degrees(CURVE),
        deviations=np.where(np.isfinite(curves), deviations, np.nan),
        deviations_theory=curves,
    )


@compiled
def _through(
    wedge: Lens, index: jax.Array, edge: jax.Array, incidence: jax.Array, by_index: jax.Array, by_edge: jax.Array
) -> tuple[jax.Array, _Angles, jax.Array]:
    """How fast the deviation moves with by_index times the index and by_edge times the apex angle; the angles, and how
    far up the back face the ray meets it from where that crosses the axis, mm. All (R,)."""

    def passage(index: jax.Array, edge: jax.Array, incidence: jax.Array) -> tuple[jax.Array, Any]:
        tilt = jnp.degrees(edge / 2)
        placed = wedge.replace(surface=1, index=index, tilt=(-tilt, 0.0, 0.0)).replace(surface=2, tilt=(tilt, 0.0, 0.0))
        start, zero = incidence + edge / 2, jnp.zeros_like(index)
        path = trace(placed, rays=living(zero, zero, zero, zero, jnp.sin(start), jnp.cos(start)), opl=False)
        # each in the frame of its face: from the normal
        inside, behind = jnp.unstack(jnp.arctan2(path.m[1:3], path.n[1:3]))
        angles = _Angles(inside, behind, jnp.arctan2(path.m[3], path.n[3]) - start)
        return angles.deviation, (angles, path.y[2])

    def deviation(index: jax.Array, edge: jax.Array) -> tuple[jax.Array, Any]:
        return jax.vmap(passage)(index, edge, incidence)

    _, moves, (angles, height) = jax.jvp(deviation, (index, edge), (by_index, by_edge), has_aux=True)
    return moves, angles, height


def _theory(ratio: float, edge: float, incidence: Any) -> _Angles:
    """See the docstring of this file; nan where a face reflects totally, or the ray does not come to the back face."""
    inside = _arcsine(np.sin(incidence) / ratio)
    onto = np.where(abs(inside + edge) < math.pi / 2, inside + edge, np.nan)
    behind = _arcsine(ratio * np.sin(onto))
    return _Angles(inside, behind, behind - incidence - edge)


def _arcsine(sine: Any) -> Any:
    """nan where there is none."""
    return np.arcsin(np.where(abs(sine) < 1 - GRAZING, sine, np.nan))


def _check(index: float, surroundings: float, edge: float, incidence: float) -> None:
    """OptionError where no light passes."""
    angles = _theory(index / surroundings, edge, incidence)
    if np.isfinite(angles.deviation):
        return
    if not np.isfinite(angles.inside):
        where = f"the front face reflects it totally at {math.degrees(incidence):g} deg; bring incidence nearer to 0"
    elif angles.inside + edge >= math.pi / 2:
        where = "inside it runs away from the back face; make apex smaller, or change incidence"
    else:
        where = (
            f"the back face reflects it totally at {math.degrees(angles.inside + edge):.4g} deg; make apex smaller, "
            "or change incidence"
        )
    raise OptionError(f"negative-prism: no light passes at the index {index:g}: {where}")


def _drawing(edge: float, incidence: float, behind: np.ndarray, height: np.ndarray) -> dict[str, np.ndarray]:
    """The course of the rays and the faces, drawn as far as the rays need; see `NegativePrism`."""
    reach = 1.2 * max(SIDE, *height)
    sine, cosine = math.sin(edge / 2), math.cos(edge / 2)
    thickness, length = 2 * SIDE * sine, SIDE + reach
    start, end, zero = incidence + edge / 2, behind - edge / 2, 0 * height
    z, y = thickness + height * sine, height * cosine
    return {
        "ray_z": np.array([zero - length * math.cos(start), zero, z, z + length * np.cos(end)]),
        "ray_y": np.array([zero - length * math.sin(start), zero, y, y + length * np.sin(end)]),
        "face_z": np.array([-reach * sine, SIDE * sine, thickness + reach * sine]),
        "face_y": np.array([reach * cosine, -SIDE * cosine, reach * cosine]),
    }
