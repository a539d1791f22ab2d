"""Waves in a medium of negative index: energy goes forward, phase goes back.

The phase of light is its optical path S, whose gradient is n d by the eikonal equation, |grad S| = |n|: with n < 0 it
points against the ray d. Waves of the wavelength L stand L / |n| apart there, and run toward the source. Along the
surface they are as far apart as outside, L / (n0 sin t), which is Snell's law.
Source: Born & Wolf, Principles of Optics (7th ed.), section 3.1.1; Veselago, Sov. Phys. Usp. 10, 509 (1968).
"""

from __future__ import annotations

import math
from typing import Annotated

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import trace
from lenstrace.optics.rays import Ray, living
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.negative_index.total_reflection import refuse_total_reflection
from lenstrace.phenomena.options import Option, demonstration, index_of_either_sign, positive_index
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

RAYS = 13  # of the beam
WAVES = 80  # wavefronts on either side of that through the origin
THICKNESS = 10.0  # mm
WIDE = 8.0  # mm, of the beam along the plate
BESIDE = 8.0  # mm, of the beam before and behind the plate
SMALL = 1e-10  # degrees, and mm: what should be 0 or 180
WAVE = 1.0  # mm, the wavelength that is drawn: of microwaves


@result
class NegativeWaves(Demonstration):
    """A beam through a plate; mm, z from the front face.

    thickness; index.
    ray_z, ray_y:     (4, N): start, both faces, end.
    front_z, front_y: (P, W, N), of each of the three parts, wavefronts a wavelength apart; nan outside the part.
    back:             (2,), z and y of the direction in which the waves run inside.
    """

    thickness: float
    index: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    front_z: np.ndarray
    front_y: np.ndarray
    back: np.ndarray


@demonstration
def negative_waves(
    index: Annotated[float, index_of_either_sign("refractive index of the plate", (-3, -0.6))] = -1.5,
    angle: Annotated[float, Option("angle of the beam", "deg", least=0, most=89.9, slider=(0, 80))] = 30.0,
    surroundings: Annotated[float, positive_index("refractive index around it", (1, 2))] = 1.0,
) -> NegativeWaves:
    """Waves in a negative index: energy goes forward, phase goes back.

    OptionError where the beam is reflected totally.
    """
    sine = math.sin(math.radians(angle))
    refuse_total_reflection("negative-waves", math.radians(angle), index, surroundings, "angle")
    plate = lens(
        [{"thickness": THICKNESS, "index": index, "stop": True}, {"index": surroundings}],
        {"entrance_pupil_diameter": 1.0},
        [0.0],
        [0.5876],
        object_index=surroundings,
    )
    inner = surroundings * sine / index
    cosine, inner_cosine = math.sqrt(1 - sine**2), math.sqrt(1 - inner**2)
    # so that the beam is in the middle of the picture half way through the plate
    starts = WIDE * np.linspace(-0.5, 0.5, RAYS) - THICKNESS / 2 * inner / inner_cosine
    path, gradient = jax.device_get(_phase(plate, np.append(starts, 0.0), np.array(sine)))
    direction, slopes = np.array([path.n[1, -1], path.m[1, -1]]), gradient[:, -1]
    across = slopes[0] * direction[1] - slopes[1] * direction[0]
    turned = math.degrees(math.atan2(abs(across), slopes @ direction))
    through = path.opl[2, -1] - path.opl[1, -1]
    rows = (
        Comparison("angle between ray and phase inside", "deg", turned, 180.0 if index < 0 else 0.0, SMALL),
        Comparison("path gained by going on a mm along the ray", "mm", slopes @ direction, index),
        Comparison("distance of waves inside", "wavelengths", 1 / math.hypot(*slopes), 1 / abs(index)),
        Comparison("path gained by going on a mm along the face", "mm", slopes[1], surroundings * sine, SMALL),
        Comparison("path through the plate", "mm", through, index * THICKNESS / inner_cosine),
    )
    way, out = np.array([[cosine], [sine]]), BESIDE / cosine
    faces = np.array([[0 * starts, starts], [0 * starts + THICKNESS, path.y[2, :-1]]])
    course = np.array([faces[0] - out * way, *faces, faces[1] + out * way])
    entry = surroundings * sine * starts
    leaving = entry + through
    phase = np.array([entry - surroundings * out, entry, leaving, leaving + surroundings * out])
    fronts = [_fronts(*(each[part : part + 2] for each in (course, phase))) for part in range(3)]
    return NegativeWaves(
        setting=f"a beam at {angle:g} deg from an index of {surroundings:g} through a plate of index {index:g}, "
        f"{THICKNESS:g} mm thick; waves {WAVE:g} mm long, as of microwaves",
        rows=rows,
        thickness=THICKNESS,
        index=index,
        ray_z=course[:, 0],
        ray_y=course[:, 1],
        front_z=np.array([each[0] for each in fronts]),
        front_y=np.array([each[1] for each in fronts]),
        back=slopes / math.hypot(*slopes),
    )


@jax.jit
def _phase(plate: Lens, heights: jax.Array, sine: jax.Array) -> tuple[Ray, jax.Array]:
    """Rays of a plane wave at heights on the front face, and (2, N) the gradient of their optical path inside the plate
    along z and y: by automatic differentiation of where they are and of their path there."""
    zero, one = jnp.zeros_like(heights), jnp.ones_like(heights)
    incoming = plate.object_medium.index(0.5876) * sine

    def at(height: jax.Array, depth: jax.Array) -> tuple[tuple[jax.Array, jax.Array], Ray]:
        start = living(zero, height, zero, zero, zero + sine, zero + jnp.sqrt(1 - sine * sine))
        path = trace(plate.replace(surface=1, thickness=depth), rays=start)
        assert path.opl is not None
        return (path.y[2], path.opl[2] + incoming * height), path

    depth = jnp.asarray(plate[1].thickness)
    _, (y_height, s_height) = jax.jvp(lambda y: at(y, depth)[0], (heights,), (one,))
    (_, _), (y_depth, s_depth), path = jax.jvp(
        lambda d: at(heights, d), (depth,), (jnp.ones_like(depth),), has_aux=True
    )
    along_y = s_height / y_height
    return path, jnp.stack([s_depth - along_y * y_depth, along_y])


def _fronts(course: np.ndarray, phase: np.ndarray) -> np.ndarray:
    """(2, W, N), z and y where rays have the phase of a whole number of waves; course: (2, 2, N), phase: (2, N), of the
    two ends of a part."""
    numbers = WAVE * np.arange(-WAVES, WAVES + 1)[:, None]
    share = (numbers - phase[0]) / (phase[1] - phase[0])
    share = np.where((share >= 0) & (share <= 1), share, np.nan)
    return course[0][:, None] + share * (course[1] - course[0])[:, None]
