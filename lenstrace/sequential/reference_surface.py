"""What the judge knows of one surface: exact numbers, taken from a row of a lens or from its compiled system."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import mpmath
import numpy as np

from lenstrace.errors import LensTraceError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.interactions import Interaction
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import Placement, System

# mpmath makes its functions and its numbers' class at run time: no type of them can be named.
mp: Any = mpmath.mp
Number = Any
Vector = Any

TURNED = -1e-9  # below this cosine a tilt has turned the axis round; a right angle itself has not


@dataclasses.dataclass(frozen=True)
class ReferenceSurface:
    """One surface in mpmath numbers.

    curvature, conic, coefficients: as in `Row`, the last for each of the `powers`.
    gap:        mm, from the vertex before.
    before, behind:  indices; of a mirror, and of the image, the same.
    decenter, tilt:  mm and radians, two and three numbers; of a surface that is not posed all 0.
    aperture:   numbers of the aperture, mm.
    bends:      False for the image.
    """

    curvature: Number
    conic: Number
    coefficients: tuple[Number, ...]
    powers: tuple[int, ...]
    gap: Number
    before: Number
    behind: Number
    decenter: tuple[Number, ...]
    tilt: tuple[Number, ...]
    aperture: tuple[Number, ...]
    aperture_kind: ApertureKind
    mirror: bool
    placement: Placement
    bends: bool

    @property
    def turn(self) -> Any:
        """Rotation about z, then y, then x, each right-handed: turns a vector with the surface."""
        (cx, sx), (cy, sy), (cz, sz) = ((mp.cos(angle), mp.sin(angle)) for angle in self.tilt)
        about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]], object)
        about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]], object)
        about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]], object)
        return about_x @ about_y @ about_z


def surfaces_of(lens: Lens, wavelength_place: int | None) -> list[ReferenceSurface]:
    """Surfaces 1 ... S + 1 as the rows of a lens say; see `indices_of`."""
    n = indices_of(lens, wavelength_place)
    surfaces = []
    gap = mp.zero
    for number, row in enumerate((*lens.rows, lens.image), 1):
        if row.screen is not None:
            raise LensTraceError(f"surface {number}: the judge in 50 digits knows no phase screens")
        is_image = number > len(lens.rows)
        kind, sizes = (ApertureKind.NONE, ()) if is_image else lens.opening(row)
        placement = Placement.POSED if row.is_posed else Placement.CENTRED
        surfaces.append(
            ReferenceSurface(
                curvature=exact(row.curvature),
                conic=exact(row.conic),
                coefficients=_exactly(row.coefficients),
                powers=row.powers,
                gap=gap,
                before=n[number - 1],
                behind=n[number - 1 if is_image else number],
                decenter=_exactly(row.decenter or (0, 0)),
                tilt=tuple(mp.radians(exact(degrees)) for degrees in row.tilt or (0, 0, 0)),
                aperture=_exactly(sizes),
                aperture_kind=kind,
                mirror=row.mirror,
                placement=Placement.BREAK if row.is_break else placement,
                bends=not is_image,
            )
        )
        gap = exact(row.thickness)
    return surfaces


def surfaces_of_system(system: System) -> list[ReferenceSurface]:
    """Surfaces 1 ... S + 1 of a system at one wavelength, its numbers exactly as they are traced."""
    curvature, conic, index = (np.asarray(a) for a in (system.curvature, system.conic, system.index))
    gaps = [0.0, *np.asarray(system.thickness)]
    before = [*index, index[-1]]
    surfaces = []
    for i, kind in enumerate(system.kinds):
        centred = kind.placement is Placement.CENTRED
        surfaces.append(
            ReferenceSurface(
                curvature=exact(curvature[i]),
                conic=exact(conic[i]),
                coefficients=_plain(np.asarray(system.coefficients)[i], np.asarray(system.norm_radius)[i], kind.powers),
                powers=kind.powers,
                gap=exact(gaps[i]),
                before=exact(before[i]),
                behind=exact(before[i + 1]),
                decenter=_exactly((0, 0) if centred else np.asarray(system.decenter)[i]),
                tilt=_exactly((0, 0, 0) if centred else np.asarray(system.tilt)[i]),
                aperture=_exactly(np.asarray(system.aperture)[i]),
                aperture_kind=kind.aperture,
                mirror=kind.interaction is Interaction.REFLECT,
                placement=kind.placement,
                bends=i < system.surfaces,
            )
        )
    return surfaces


def indices_of(lens: Lens, wavelength_place: int | None) -> list[Number]:
    """Of the object space and behind each surface; a mirror keeps what is before it.

    wavelength_place: place in lens.wavelengths.um, the primary one by default.
    """
    um = lens.wavelengths.um[lens.wavelengths.primary if wavelength_place is None else wavelength_place]
    indices = [exact(lens.object_medium.index(um))]
    for row in lens.rows:
        indices.append(indices[-1] if row.mirror else exact(row.medium.index(um)))
    return indices


def exact(value: Any) -> Number:
    """An mpmath number as it is; any other to its last bit."""
    return value if isinstance(value, mp.mpf) else mp.mpf(float(value))


def vector(*numbers: Any) -> Vector:
    """A vector of mpmath numbers."""
    return np.array([exact(x) for x in numbers], object)


def unit(v: Vector) -> Vector:
    """The unit vector along v."""
    return v / mp.sqrt(v @ v)


def _plain(normalized: Sequence[Any], norm_radius: Any, powers: Sequence[int]) -> tuple[Number, ...]:
    """Coefficients a_p of r^p, of those in r / norm_radius; exact, for that is a power of two."""
    return tuple(exact(b) * exact(norm_radius) ** (1 - p) for b, p in zip(normalized, powers, strict=False))


def _exactly(values: Sequence[Any]) -> tuple[Number, ...]:
    return tuple(map(exact, values))
