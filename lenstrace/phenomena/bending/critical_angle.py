"""Total internal reflection: from the denser medium light leaves only within the critical angle,

    sin t_c = n2 / n1.

The tracer says of every ray whether it goes on; the angle between the last that does and the first that does not is
halved until the two are neighbouring numbers. Up to it the reflectances rise to 1 as

    R_s = (sin(t1 - t2) / sin(t1 + t2))^2,      R_p = (tan(t1 - t2) / tan(t1 + t2))^2,

with R_p = 0 on the way, at tan t1 = n2 / n1.
Source: Born & Wolf, Principles of Optics (7th ed.), sections 1.5.3, Eq. (35), and 1.5.4.
"""

from __future__ import annotations

import math
from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.errors import OptionError
from lenstrace.optics.fresnel import reflectances
from lenstrace.optics.rays import Ray, living
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.edge import edge
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

DEPTH = 1.0  # of the source below the surface, mm
DRAWN = np.radians(np.linspace(-72, 72, 25))
# Inside: parts of the critical angle, closer where the curves are steep, and of what is beyond it.
BELOW, BEYOND = 1 - np.linspace(1, 0.001, 121) ** 2, np.linspace(0.01, 1, 31)
IN_TABLE = (0.0, 0.5, 0.9, 0.999)  # parts of the critical angle
ROUNDING = 1e-14  # of sines and reflectances
# The last angle that goes on is some 1e-16 below the critical one; what follows from it by a square root is this near.
NEAREST = 1e-6
LEAST_STEP = 1.01  # of the indices: nearer to 1 the critical angle is 90 degrees, all but rounding


@result
class CriticalAngle(Demonstration):
    """Rays from a point below a surface, and the reflectances; lengths in mm, angles in radians.

    ray_y, ray_z:    (3, N), source, surface, and 1 mm on from there; z is up, 0 at the surface.
    totally:         (N,), which are reflected totally.
    critical:        the angle measured.
    angles:          (A,), inside, up to 90 degrees.
    curves, theory:  (2, A), R_s and R_p at the angles of the traced rays, and by the closed forms.
    indices:         inside and outside.
    """

    ray_y: np.ndarray
    ray_z: np.ndarray
    totally: np.ndarray
    critical: float
    angles: np.ndarray
    curves: np.ndarray
    theory: np.ndarray
    indices: tuple[float, float]


@demonstration
def critical_angle(
    index: Annotated[float, Option("refractive index inside", least=1.01, most=5, slider=(1.05, 3))] = 1.5,
    index_outside: Annotated[float, Option("refractive index outside", least=1, most=5, slider=(1, 2))] = 1.0,
) -> CriticalAngle:
    """Total internal reflection: the angle beyond which no light leaves a denser medium."""
    if index < LEAST_STEP * index_outside:
        raise OptionError(
            f"critical-angle: light is reflected totally only inside the denser medium; make index at least "
            f"{LEAST_STEP:g} times index_outside, got {index:g} and {index_outside:g}"
        )
    face = lens(
        [{"index": index_outside, "stop": True}],
        {"object_na": index / 2},
        [0.0],
        [0.5876],
        object_distance=DEPTH,
        object_index=index,
    )
    theory = math.asin(index_outside / index)
    polarizing = math.atan(index_outside / index)
    curve = np.concatenate([BELOW * theory, theory + BEYOND * (math.pi / 2 - theory)])
    angles = np.array([*(part * theory for part in IN_TABLE), polarizing, *curve])
    (critical,), rays, (last_s, *s), (_, *p) = jax.device_get(_measured(face, index, index_outside, angles))
    s, p = np.array([s, p])
    expected = _reflectances(angles, index, index_outside)
    near = math.degrees(ROUNDING / math.cos(theory))
    grazing = math.degrees(math.atan2(rays.m[0], rays.n[0]))
    rows = [
        Comparison("critical angle", "deg", math.degrees(critical), math.degrees(theory), near),
        Comparison("the last ray that goes on leaves at", "deg", grazing, 90.0, math.degrees(NEAREST)),
        Comparison("of it is reflected: R_s", "", last_s, 1.0, 10 * NEAREST),
    ]
    for i, part in enumerate(IN_TABLE):
        at = f"at {math.degrees(angles[i]):.4g} deg"
        # at the critical angle the reflectances rise without bound
        within = ROUNDING / math.sqrt(1 - part)
        rows += [
            Comparison(f"{at}: R_s", "", s[i], expected[0, i], within),
            Comparison(f"{at}: R_p", "", p[i], expected[1, i], within),
        ]
    i = len(IN_TABLE)
    beyond = angles > theory
    rows += [
        Comparison(f"at {math.degrees(polarizing):.4g} deg, the polarizing angle inside: R_p", "", p[i], 0.0, ROUNDING),
        Comparison("beyond the critical angle: least R", "", min(s[beyond].min(), p[beyond].min()), 1.0, 0.0),
    ]
    y, m, n, totally = rays.y[1:], rays.m[1:], rays.n[1:], ~rays.ok[1:]
    z = np.zeros_like(y)
    return CriticalAngle(
        setting=f"light in a medium of index {index:g}, below its plane surface to one of index {index_outside:g}",
        rows=tuple(rows),
        ray_y=np.array([z, y, y + m]),
        ray_z=np.array([z - DEPTH, z, np.where(totally, -n, n)]),
        totally=totally,
        critical=float(critical),
        angles=curve,
        curves=np.array([s, p])[:, i + 1 :],
        theory=expected[:, i + 1 :],
        indices=(index, index_outside),
    )


@jax.jit
def _measured(
    face: Lens, index: jax.Array, outside: jax.Array, angles: jax.Array
) -> tuple[jax.Array, Ray, jax.Array, jax.Array]:
    """The last angle that goes on, (1,); its ray and those to draw behind the surface; R_s, R_p at it and `angles`."""

    def behind(angle: jax.Array) -> Ray:
        zero = jnp.zeros_like(angle)
        start = living(zero, zero, zero - DEPTH, zero, jnp.sin(angle), jnp.cos(angle))
        return jax.tree.map(lambda a: a[1], trace(face, rays=start, opl=False))

    def goes_on(angle: jax.Array) -> jax.Array:
        return behind(angle).ok

    zero = jnp.zeros((1,))
    critical = edge(goes_on, zero, zero + math.pi / 2)
    every = behind(jnp.concatenate([critical, DRAWN, angles]))
    # a surface reflects as much of the light that comes back the way of a ray; of one that does not go on, its own way
    on = every.ok
    s, p = reflectances(jnp.abs(every.n), jnp.where(on, outside, index), jnp.where(on, index, outside))
    count = 1 + len(DRAWN)
    drawn = jax.tree.map(lambda a: a[:count], every)
    return critical, drawn, jnp.append(s[:1], s[count:]), jnp.append(p[:1], p[count:])


def _reflectances(angles: np.ndarray, index: float, outside: float) -> np.ndarray:
    """(2, A), R_s and R_p by sines and tangents; at the normal by their limit."""
    sine = np.minimum(index / outside * np.sin(angles), 1)
    bent = np.arcsin(sine)
    straight = ((index - outside) / (index + outside)) ** 2
    with np.errstate(invalid="ignore"):
        s = (np.sin(angles - bent) / np.sin(angles + bent)) ** 2
        p = (np.tan(angles - bent) / np.tan(angles + bent)) ** 2
    return np.where(angles > 0, np.where(sine < 1, [s, p], 1.0), straight)
