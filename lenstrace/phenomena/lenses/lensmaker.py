"""The lensmaker's formula: the power of a lens out of its radii, its thickness and its index.

With m = n / n0, the index of the lens against that around it,

    1/f = (m - 1) (1/R1 - 1/R2 + (m - 1) d / (m R1 R2)),
    BFL = f (1 - (m - 1) d / (m R1)),      FFL = -f (1 + (m - 1) d / (m R2)),

from the last vertex and from the first one. Without the term in d it is the formula of the thin lens.
Source: Born & Wolf, Principles of Optics, section 4.4.3; Hecht, Optics, section 6.1.
"""

from __future__ import annotations

from typing import Annotated

import jax
import numpy as np

from lenstrace.errors import OptionError
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.lenses.drawing import course
from lenstrace.phenomena.lenses.near_axis import Neighbours, cardinal, neighbours
from lenstrace.phenomena.lenses.singlet import half_height, outline, powers, singlet
from lenstrace.phenomena.options import demonstration, positive_index, positive_length, radius_of_surface
from lenstrace.sequential.lens import Lens

NO_POWER = 1e-9  # of the powers of its parts: of a lens that has less, rounding leaves nothing
ROUNDING = 1e-12  # of the powers of its parts: what rounding may make of their sum
DRAWN = 9  # rays
THICKNESSES = 13  # in the picture, from 0 to twice that of the lens
OPEN = 0.8  # of the lens, for the rays
LONG = 12.0  # of the half height of the lens: a focal point farther away is left out of the picture


@result
class Lensmaker(Demonstration):
    """The lens with rays parallel to the axis, and its power with other thicknesses; lengths in mm.

    outline:       (M, 2) of (z, y).             rays: (2, 4, N), z and y of their course; see `course`.
    focus:         z of F' from the first vertex.      shown: z of the left and the right edge of the picture.
    thickness:     of the lens.
    thicknesses, traced, thick, thin:  (T,), and the power n0 / f by the trace, by the formula, and by that of the thin
                                       lens, in 1/m.
    """

    outline: np.ndarray
    rays: np.ndarray
    focus: float
    shown: tuple[float, float]
    thickness: float
    thicknesses: np.ndarray
    traced: np.ndarray
    thick: np.ndarray
    thin: np.ndarray


@demonstration
def lensmaker(
    radius_1: Annotated[float, radius_of_surface("radius of the first surface")] = 50.0,
    radius_2: Annotated[float, radius_of_surface("radius of the second surface")] = -50.0,
    thickness: Annotated[float, positive_length("thickness", slider=(0.5, 40))] = 12.0,
    index: Annotated[float, positive_index("refractive index of the lens", (1.3, 2.5))] = 1.5168,
    surroundings: Annotated[float, positive_index("refractive index around the lens", (1, 2))] = 1.0,
) -> Lensmaker:
    """The lensmaker's formula: the focal length of a lens from its radii.

    OptionError for a lens without power.
    """
    radii, n = (radius_1, radius_2), index / surroundings
    parts = powers(radii, thickness, surroundings, index, surroundings)
    if abs(parts.total) <= NO_POWER * parts.noise:
        raise OptionError(
            "lensmaker: this lens has no power; give it another index than its surroundings, or other radii"
        )
    f = 1 / ((n - 1) * (1 / radius_1 - 1 / radius_2 + (n - 1) * thickness / (n * radius_1 * radius_2)))
    back, front = f * (1 - (n - 1) * thickness / (n * radius_1)), -f * (1 + (n - 1) * thickness / (n * radius_2))
    thin = (index - surroundings) * (1 / radius_1 - 1 / radius_2)

    half = half_height(radii, thickness)
    thicknesses = np.linspace(0, 2 * thickness, THICKNESSES)
    around = np.append([0.0, 0.0], OPEN * half * np.linspace(-1, 1, DRAWN))
    start = np.zeros((2, len(around)))
    start[[0, 1], [0, 1]] = 1
    made = singlet(radii, thickness, surroundings, index, surroundings)
    near = jax.device_get(_through(made, thicknesses, *start, around))
    # of the lens itself, one of the THICKNESSES
    own = jax.tree.map(lambda a: a[THICKNESSES // 2], near)
    parallel, oblique = np.array([own.y[-1], own.slope[-1]])[:, :2].T
    found = cardinal(parallel, oblique, thickness)
    traced = -surroundings * near.slope[:, -1, 0]

    within = ROUNDING * f**2 * parts.noise / surroundings
    along = within * (1 + abs(parts.front) * thickness / index + abs(parts.rear) * thickness / index)
    thick = thin + parts.between / thickness * thicknesses
    rows = (
        Comparison("focal length", "mm", found.focal_length, f, within),
        Comparison("back focal length", "mm", found.rear_focus - thickness, back, along + ROUNDING * thickness),
        Comparison("front focal length", "mm", found.front_focus, front, along + ROUNDING * thickness),
        Comparison("power at the thickness 0", "1/m", 1e3 * traced[0], 1e3 * thin, 1e3 * ROUNDING * parts.noise),
        Comparison(
            "power at twice the thickness", "1/m", 1e3 * traced[-1], 1e3 * thick[-1], 2e3 * ROUNDING * parts.noise
        ),
    )
    focus, far = found.rear_focus, LONG * half
    near_enough = -far < focus < thickness + far
    end = max(1.2 * focus, thickness + half) if near_enough else thickness + far / 2
    path = jax.tree.map(lambda a: a[:, 2:], own.path)
    rays = course(made, path, 2 * (end - thickness))
    rays[:, :, path.failure[-1] != 0] = np.nan
    return Lensmaker(
        setting=f"a lens of radii {radius_1:g} and {radius_2:g} mm, {thickness:g} mm thick, of index {index:g} in a "
        f"medium of index {surroundings:g}",
        rows=rows,
        outline=outline(radii, thickness),
        rays=rays,
        focus=focus,
        shown=(min(focus if near_enough else 0.0, 0.0) - half, end),
        thickness=thickness,
        thicknesses=thicknesses,
        traced=1e3 * traced,
        thick=1e3 * thick,
        thin=np.full(THICKNESSES, 1e3 * thin),
    )


@jax.jit
def _through(made: Lens, thicknesses: jax.Array, *rays: jax.Array) -> Neighbours:
    """Of the lens with each of the thicknesses; rays: see `neighbours`."""
    return jax.vmap(lambda thickness: neighbours(made.replace(surface=1, thickness=thickness), *rays))(thicknesses)
