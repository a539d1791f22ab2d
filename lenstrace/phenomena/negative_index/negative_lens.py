"""A lens of negative index: hollow, it focuses.

A plano-concave lens of index n in the medium n0, its plane face toward the beam, bends light at the concave face alone,
of radius R. Its focal length, by the lensmaker's equation, is

    f = n0 R / (n0 - n):      half the radius at n = -1.

The ray at the height h meets that face at sin i = h / R, goes on at sin r = n sin i / n0 from its normal, and crosses
the axis, counted from the vertex of the face, at

    R - sqrt(R^2 - h^2) + h / tan(i - r).

The same holds with R < 0 for the plano-convex lens of positive index with the same focal length.
Source: Born & Wolf, Principles of Optics (7th ed.), section 4.4; Veselago, Sov. Phys. Usp. 10, 509 (1968).
"""

from __future__ import annotations

from typing import Annotated

import jax
import numpy as np

from lenstrace.errors import OptionError
from lenstrace.phenomena.axis import Fan, beam
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration, negative_index, positive_index, positive_length
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

RAYS = 20  # drawn, of each lens; none of them on the axis
THIN = 0.3  # of the height: a drawn lens where it is thinnest
HIGHEST = 0.98  # of the largest height that is not reflected totally or beyond the rim


@result
class NegativeLens(Demonstration):
    """The hollow lens of negative index and the convex one of positive index, by turns; mm, z from the curved vertex.

    indices:        (2,).            radii: (2,), of the curved faces.            focal_length: of both.
    thicknesses:    (2,), on the axis.
    heights:        (2, N).          faces: (2, N), z where the rays leave the lenses.
    crossings, theory:  (2, N), where they cross the axis.
    """

    indices: np.ndarray
    radii: np.ndarray
    focal_length: float
    thicknesses: np.ndarray
    heights: np.ndarray
    faces: np.ndarray
    crossings: np.ndarray
    theory: np.ndarray


@demonstration
def negative_lens(
    index: Annotated[float, negative_index("refractive index of the hollow lens", (-3, -0.5))] = -1.0,
    radius: Annotated[float, positive_length("radius of its concave face", slider=(10, 200))] = 100.0,
    surroundings: Annotated[float, positive_index("refractive index around it", (1, 2))] = 1.0,
    height: Annotated[float, Option("outermost ray, of the radius", above=0, most=0.999, slider=(0.05, 0.7))] = 0.4,
    positive: Annotated[float, positive_index("index of the lens it is compared with")] = 1.5,
) -> NegativeLens:
    """A hollow lens of negative index focuses, as the lensmaker's equation says.

    OptionError where the outermost ray is reflected totally, or the other lens has no power.
    """
    if positive == surroundings:
        raise OptionError(
            "negative-lens: a lens of the index around it has no power; choose another index for positive"
        )
    if height >= surroundings / abs(index):
        raise OptionError(
            f"negative-lens: at index {index:g} in {surroundings:g} rays beyond {surroundings / -index:.4g} of the "
            "radius are reflected totally; choose a smaller height"
        )
    focal_length = surroundings * radius / (surroundings - index)
    indices = np.array([index, positive])
    radii = focal_length * (surroundings - indices) / surroundings
    # the other lens may be too small for all rays
    limits = np.abs(radii) * np.minimum(1, surroundings / np.abs(indices)) * HIGHEST
    heights = np.minimum(height * radius, [height * radius, limits[1]])[:, None] * np.linspace(-1, 1, RAYS)
    found = jax.device_get(_beams(_lens(surroundings), indices, radii, np.append(heights, np.zeros((2, 1)), 1)))
    theory = np.array([_crossing(*each, surroundings) for each in zip(heights, radii, indices, strict=True)])
    rows = []
    for place, n in enumerate(indices):
        focus = found.crossing[place, -1]
        rows.append(Comparison(f"n = {n:g}: focal length", "mm", focus, focal_length))
        for at in (RAYS // 2 + RAYS // 4, RAYS - 1):
            quantity = f"n = {n:g}: ray at {heights[place, at]:.4g} mm crosses at"
            rows.append(Comparison(quantity, "mm", found.crossing[place, at], theory[place, at]))
    depth = np.abs(radii) - np.sqrt(radii**2 - np.abs(heights).max(1) ** 2)
    return NegativeLens(
        setting=f"a plano-concave lens of index {index:g}, radius {radius:g} mm, in an index of {surroundings:g}; and "
        f"a plano-convex one of index {positive:g} with the same focal length",
        rows=tuple(rows),
        indices=indices,
        radii=radii,
        focal_length=focal_length,
        # as thin as can be on the axis where it is hollow, at the rim where it bulges
        thicknesses=np.where(radii > 0, 0, depth) + THIN * np.abs(heights).max(),
        heights=heights,
        faces=found.path.z[:, 2, :-1],
        crossings=found.crossing[:, :-1],
        theory=theory,
    )


def _lens(surroundings: float) -> Lens:
    """Of no thickness, since its plane face bends nothing: two planes, to be given a radius and an index."""
    rows = [{"index": -1.0, "stop": True}, {"radius": 1.0, "index": surroundings}]
    return lens(rows, {"entrance_pupil_diameter": 1.0}, [0.0], [0.5876], object_index=surroundings)


@jax.jit
def _beams(thin: Lens, indices: jax.Array, radii: jax.Array, heights: jax.Array) -> Fan:
    """Beams along the axis through two lenses, (2, N)."""

    def through(index: jax.Array, radius: jax.Array, heights: jax.Array) -> Fan:
        return beam(thin.replace(surface=1, index=index).replace(surface=2, curvature=1 / radius), heights)

    return jax.vmap(through)(indices, radii, heights)


def _crossing(heights: np.ndarray, radius: float, index: float, around: float) -> np.ndarray:
    """See the docstring of this file."""
    sine = heights / radius
    sag = heights * sine / (1 + np.sqrt(1 - sine**2))
    return sag + heights / np.tan(np.arcsin(sine) - np.arcsin(index * sine / around))
