"""Principal planes, focal and nodal points, found with the rays that define them; Newton's and Gauss's equations.

With X and X' from F to the object and from F' to the image, s and s' from H and H', along +z,

    X X' = f f',        n'/s' - n/s = phi,        f = -n / phi,  f' = n' / phi,

and n' counts negative behind an odd number of mirrors. The object is moved so that the magnification -f / X is what
MAGNIFICATIONS says; where a real ray from it, infinitely near the axis, crosses the axis again is X' and s'.
Source: Welford, Aberrations of Optical Systems (1986), chapter 3; Born & Wolf, sections 4.3 and 4.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import jax
import numpy as np

from lenstrace.analysis.cardinal import first_order
from lenstrace.analysis.layout import Layout
from lenstrace.analysis.rays import ray, trace
from lenstrace.errors import OptionError
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.lenses.drawing import bare
from lenstrace.phenomena.lenses.near_axis import Neighbours, cardinal, neighbours
from lenstrace.phenomena.lenses.singlet import powers, singlet
from lenstrace.phenomena.options import demonstration, positive_index, positive_length, radius_of_surface
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.paraxial import FirstOrder, signed_index
from lenstrace.sequential.system import Placement

WHERE = "principal-planes"
MAGNIFICATIONS = np.array([-4.0, -2.0, -1.0, -0.5, -0.25, 0.25, 0.5, 0.8, 2.0, 4.0])  # real images, then virtual ones
ROUNDING = 1e-13  # of the lengths that are added up: what rounding may make of their sum
STRAIGHT = 1e-12  # a slope of the ray along the axis that is rounding
NO_POWER = 1e-9  # of the powers of its parts: a lens that has less is told nothing by rounding
WIDE = 0.8  # of the lens: how high the key rays are drawn
FAR = 3.0  # diagonals of the lens: a focal point farther away is left out of the picture


@result
class PrincipalPlanes(Demonstration):
    """The lens with its key rays, drawn as high as it is, and its conjugates; lengths in mm, z from the first vertex.

    layout, points, primary:  the lens, its cardinal points by the y-nu trace, and the place of the wavelength in them.
    rays:          (M, 2) of (z, y): the ray that comes in parallel to the axis, and the one that goes out parallel.
    constructions: (3, 2), the same rays as the principal planes bend them.
    shown:         z of the left and the right edge of the picture.
    objects, images:  (10,), X / f and X' / f', measured.
    """

    layout: Layout
    points: FirstOrder
    primary: int
    rays: tuple[np.ndarray, np.ndarray]
    constructions: tuple[np.ndarray, np.ndarray]
    shown: tuple[float, float]
    objects: np.ndarray
    images: np.ndarray


@demonstration
def principal_planes(
    lens: Lens | None = None,
    radius_1: Annotated[float, radius_of_surface("radius of the first surface")] = 40.0,
    radius_2: Annotated[float, radius_of_surface("radius of the second surface")] = -60.0,
    thickness: Annotated[float, positive_length("thickness of the lens", slider=(1, 60))] = 25.0,
    index: Annotated[float, positive_index("refractive index of the lens", (1, 2.5))] = 1.6,
    behind: Annotated[float, positive_index("refractive index behind the lens", (1, 2))] = 1.333,
) -> PrincipalPlanes:
    """Principal planes of a lens, by the rays that define them; Newton's and Gauss's equations.

    lens:  any centred lens that has power; by default one of two surfaces in air, with water behind it.
    OptionError for a lens without power, or with a tilted or decentred surface, or a screen that turns its axis.
    """
    if lens is None:
        radii = radius_1, radius_2
        parts = powers(radii, thickness, 1.0, index, behind)
        if abs(parts.total) <= NO_POWER * parts.noise:
            raise OptionError(f"{WHERE}: a lens of these radii has no power; change a radius, its thickness or index")
        back = behind * (1 - parts.front * thickness / index) / parts.total
        lens = singlet(radii, thickness, 1.0, index, behind, max(back, 0.0), "A lens between two media")
    if any(kind.placement is not Placement.CENTRED for kind in lens.system.kinds):
        raise OptionError(f"{WHERE}: a surface of this lens is tilted or decentred, or its axis is folded; centre it")
    if lens.system.screens and _leaves_the_axis(lens):
        raise OptionError(f"{WHERE}: a phase screen of this lens turns the axis itself; take one without tilt or coma")
    every, place = first_order(lens), lens.wavelengths.primary
    points = jax.tree.map(lambda a: float(np.asarray(a)[place]), every)
    if points.power == 0:
        raise OptionError(f"{WHERE}: this lens is afocal (power 0), so it has no focal points; take one with power")
    rear, f, f_object = points.rear_vertex, points.focal_length, points.object_focal_length
    objects = points.front_focal_point - f_object / MAGNIFICATIONS
    starts = np.array([[1.0, 0.0, *-objects], [0.0, 1.0, *np.ones(len(objects))]])
    near = jax.device_get(_neighbours(lens, *starts))
    vertices = np.append(0.0, np.cumsum(np.asarray(lens.thickness)))
    at_image = np.array([near.y[-1], near.slope[-1]])
    found = cardinal(at_image[:, 0], at_image[:, 1], vertices[-1])
    images = vertices[-1] - at_image[0, 2:] / at_image[1, 2:]

    within = ROUNDING * (abs(f) + abs(f_object) + np.ptp(vertices) + max(map(abs, found)))
    rows = [
        Comparison("f', focal length", "mm", found.focal_length, f),
        Comparison("F', from the last vertex", "mm", found.rear_focus - rear, points.rear_focal_point, within),
        Comparison("H', from the last vertex", "mm", found.rear_principal - rear, points.rear_principal_plane, within),
        Comparison("N', from the last vertex", "mm", found.rear_node - rear, points.rear_nodal_point, within),
        Comparison("F, from the first vertex", "mm", found.front_focus, points.front_focal_point, within),
        Comparison("H, from the first vertex", "mm", found.front_principal, points.front_principal_plane, within),
        Comparison("N, from the first vertex", "mm", found.front_node, points.front_nodal_point, within),
    ]
    before, after = np.asarray(signed_index(lens.system.at(place)))[[0, -1]]
    x, x_image = objects - found.front_focus, images - found.rear_focus
    s, s_image = objects - found.front_principal, images - found.rear_principal
    for i, m in enumerate(MAGNIFICATIONS):
        # what the rounding of the lengths does whose differences X, X', s and s' are
        newton = within * (abs(x[i]) + abs(x_image[i]))
        gauss = within * (abs(after) / s_image[i] ** 2 + abs(before) / s[i] ** 2)
        rows += [
            Comparison(f"m = {m:g}: Newton, X X'", "mm²", x[i] * x_image[i], f * f_object, newton),
            Comparison(
                f"m = {m:g}: Gauss, n'/s' - n/s", "1/mm", after / s_image[i] - before / s[i], points.power, gauss
            ),
        ]
    drawing = bare(lens)
    shown = _shown(drawing, found[1:])
    ends = shown if lens.system.orientation[-1] > 0 else shown[::-1]
    parallel = _key_ray(near, 1.0, 0.0, drawing, vertices, (shown[0], ends[1]))
    begin = found.front_focus if shown[0] < found.front_focus < 0 else shown[0]
    focal = _key_ray(near, -found.front_focus, 1.0, drawing, vertices, (begin, ends[1]))
    return PrincipalPlanes(
        setting=f"{lens.name or 'the lens'}, f' = {f:.6g} mm: the object is moved through ten conjugates",
        rows=tuple(rows),
        layout=drawing,
        points=every,
        primary=place,
        rays=(parallel, focal),
        constructions=(
            np.array([parallel[0], [found.rear_principal, parallel[0, 1]], [found.rear_focus, 0.0]]),
            np.array([[found.front_focus, 0.0], [found.front_principal, focal[-1, 1]], focal[-1]]),
        ),
        shown=shown,
        objects=x / f_object,
        images=x_image / f,
    )


_neighbours = jax.jit(neighbours)


def _shown(drawing: Layout, points: Sequence[float]) -> tuple[float, float]:
    """From the lens to the cardinal points that are not too far from it."""
    profiles = np.concatenate([surface.profile for surface in drawing.surfaces if surface.bends])
    low, high = np.nanmin(profiles[:, 0]), np.nanmax(profiles[:, 0])
    size = float(np.hypot(*np.ptp(profiles[np.isfinite(profiles[:, 0])], axis=0)))
    near = [z for z in points if low - FAR * size < z < high + FAR * size]
    return min(low, *near) - size / 4, max(high, *near) + size / 4


def _key_ray(
    near: Neighbours, height: float, slope: float, drawing: Layout, vertices: np.ndarray, ends: tuple[float, float]
) -> np.ndarray:
    """(M, 2) of (z, y): the ray of that height and slope on the first vertex plane, made as high as the lens allows.

    near: two rays at least, of height 1, and of slope 1.     ends: z where it begins and where it ends.
    """
    y, leaving = (height * a[:, 0] + slope * a[:, 1] for a in (near.y, near.slope))
    bending = [surface.number for surface in drawing.surfaces if surface.bends]
    sizes = np.array([surface.semi_diameter for surface in drawing.surfaces if surface.bends])
    scale = WIDE / max(abs(y[bending]) / sizes)
    last = bending[-1]
    begin = height + slope * ends[0]
    end = y[last] + leaving[last] * (ends[1] - vertices[last - 1])
    z = [ends[0], *vertices[np.array(bending) - 1], ends[1]]
    return np.column_stack([z, scale * np.array([begin, *y[bending], end])])


def _leaves_the_axis(lens: Lens) -> bool:
    """Whether the ray that enters along the axis is off it anywhere."""
    path = trace(lens, ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    return bool(np.max(np.abs([path.l, path.m])) > STRAIGHT)
