"""The lensmaker's equation: the focal length of a lens from its radii, its thickness and its index.

With N the index of the glass over that of what is around it,

    1 / f' = (N - 1) (1 / R1 - 1 / R2 + (N - 1) d / (N R1 R2)),      BFL = f' (1 - (N - 1) d / (N R1)),

and, counted from the last vertex, H' at BFL - f'. Without thickness only the first two terms are left.
Source: Born & Wolf, Principles of Optics (7th ed.), section 4.4.
"""

from __future__ import annotations

from typing import Annotated, Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.layout import Layout, layout
from lenstrace.errors import OptionError
from lenstrace.phenomena.axis import beam
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

SHARES = np.linspace(0, 3, 31)  # of the thickness, for the plot
AFOCAL = 1e-9  # of the larger of its parts: a smaller power is none
BEAM = 0.25  # of the smaller radius: the half width of the drawn beam
FLATTEST = 1e4  # mm: the radius of a plane, when the beam is chosen
FARTHEST = 12.0  # widths of the beam: where a distant focus is no longer drawn
NEAR = 1e-12  # of the focal length: rounding of what is measured from a vertex


@result
class Lensmaker(Demonstration):
    """A lens and its focal length against thickness; mm.

    drawing:        of the lens with a beam, up to its focal plane.
    thicknesses:    (K,).      focal_lengths, theory: (K,), traced and by the equation.
    thin:           the focal length without thickness.
    """

    drawing: Layout
    thicknesses: np.ndarray
    focal_lengths: np.ndarray
    theory: np.ndarray
    thin: float


@demonstration
def lensmaker(
    radius_front: Annotated[float, Option("radius of the first surface", "mm", not_zero=True, infinite=True)] = 60.0,
    radius_back: Annotated[float, Option("radius of the second surface", "mm", not_zero=True, infinite=True)] = -90.0,
    thickness: Annotated[float, Option("thickness", "mm", above=0, most=1e4, slider=(0.5, 40))] = 12.0,
    index: Annotated[float, Option("refractive index of the lens", above=0, most=10, slider=(1.3, 2))] = 1.5168,
    surroundings: Annotated[float, Option("index around it", above=0, most=10, slider=(1, 1.6))] = 1.0,
) -> Lensmaker:
    """The lensmaker's equation, thick and thin, against rays near the axis.

    OptionError for a lens without power.
    """
    ratio = index / surroundings
    front, back = 1 / radius_front, 1 / radius_back

    def power(thickness: Any) -> Any:
        return (ratio - 1) * (front - back + (ratio - 1) * thickness * front * back / ratio)

    whole, parts = power(thickness), abs(ratio - 1) * max(abs(front), abs(back))
    if abs(whole) <= AFOCAL * parts or whole == 0:
        raise OptionError(
            "lensmaker: a lens of these radii and indices has no power, and so no focal length; change one of them"
        )
    glass = lens(
        [
            {"radius": radius_front, "thickness": thickness, "index": index, "stop": True},
            {"radius": radius_back, "index": surroundings},
        ],
        {"entrance_pupil_diameter": 2 * BEAM * min(abs(radius_front), abs(radius_back), FLATTEST)},
        [0.0],
        [0.5876],
        object_index=surroundings,
    )
    thicknesses = thickness * SHARES
    focal, rear = jax.device_get(_focal(glass, np.append(thicknesses, [0.0, thickness])))
    expected = 1 / whole
    focus = expected * (1 - (ratio - 1) * thickness * front / ratio)
    with np.errstate(divide="ignore"):
        theory = 1 / np.asarray(power(thicknesses))
    thin = 1 / power(0.0) if power(0.0) else np.inf
    rows = [
        Comparison("focal length", "mm", focal[-1], expected),
        Comparison("back focal length", "mm", rear[-1], focus, NEAR * abs(expected)),
        Comparison("last vertex to H'", "mm", rear[-1] - focal[-1], focus - expected, NEAR * abs(expected)),
    ]
    if np.isfinite(thin):
        rows.append(Comparison("focal length without thickness", "mm", focal[-2], thin))
    found = focus if focus > 0 else 0.0
    drawn = glass.replace(surface=2, thickness=float(np.clip(found, 0, FARTHEST * glass.aperture.value)))
    return Lensmaker(
        setting=f"a lens of radii {radius_front:g} and {radius_back:g} mm, {thickness:g} mm thick, index {index:g} in "
        f"{surroundings:g}",
        rows=tuple(rows),
        drawing=layout(drawn, rays_per_field=7),
        thicknesses=thicknesses,
        focal_lengths=focal[:-2],
        theory=theory,
        thin=thin,
    )


@jax.jit
def _focal(glass: Lens, thicknesses: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Focal lengths, and F' from the last vertex, of the lens in several thicknesses: by rays near the axis."""

    def near(thickness: jax.Array) -> tuple[jax.Array, jax.Array]:
        rays = beam(glass.replace(surface=1, thickness=thickness), jnp.zeros(1))
        return -1 / rays.slope_rate[0], rays.crossing[0]

    return jax.vmap(near)(thicknesses)
