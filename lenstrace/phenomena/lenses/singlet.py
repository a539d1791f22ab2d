"""A lens of two spherical surfaces, by its radii: its powers, and the lens that is traced."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

# How wide it is drawn: of the shorter radius, and of the height at which its surfaces would meet.
WIDE, FILLED = 0.5, 0.85
POINTS = 81  # of each surface of the drawing


class Powers(NamedTuple):
    """1/mm: of the first surface, of the second, and of the thickness between them; their sum is that of the lens."""

    front: float
    rear: float
    between: float

    @property
    def total(self) -> float:
        """phi."""
        return sum(self)

    @property
    def noise(self) -> float:
        """Of what size the parts are, 1/mm: what of phi is rounding is in proportion to it."""
        return sum(map(abs, self))


def powers(radii: tuple[float, float], thickness: float, before: float, index: float, behind: float) -> Powers:
    """phi1 = (n - n0) / R1, phi2 = (n1 - n) / R2 and -phi1 phi2 d / n, of a lens of index n between n0 and n1.

    In one medium their sum is n0 / f with 1/f = (m - 1) (1/R1 - 1/R2 + (m - 1) d / (m R1 R2)), m = n / n0.
    Source: Born & Wolf, Principles of Optics, section 4.4.3.
    """
    front, rear = (index - before) / radii[0], (behind - index) / radii[1]
    return Powers(front, rear, -front * rear * thickness / index)


def half_height(radii: tuple[float, float], thickness: float) -> float:
    """Up to which the lens is drawn, mm."""
    bulge = 1 / radii[0] - 1 / radii[1]
    meeting = math.sqrt(2 * thickness / bulge) if bulge > 0 else math.inf
    return min(WIDE * abs(radii[0]), WIDE * abs(radii[1]), FILLED * meeting)


def outline(radii: tuple[float, float], thickness: float) -> np.ndarray:
    """(N, 2) of (z, y), closed: up the first surface and down the second, mm from the first vertex."""
    y = half_height(radii, thickness) * np.linspace(-1, 1, POINTS)
    front, rear = (y * y / radius / (1 + np.sqrt(1 - (y / radius) ** 2)) for radius in radii)
    return np.column_stack([np.append(front, thickness + rear[::-1]), np.append(y, y[::-1])])


def singlet(
    radii: tuple[float, float],
    thickness: float,
    before: float,
    index: float,
    behind: float,
    image: float = 0.0,
    name: str = "",
) -> Lens:
    """As wide as can be drawn; image: distance of the image surface behind it, mm."""
    wide = half_height(radii, thickness)
    return lens(
        [
            {"radius": radii[0], "thickness": thickness, "index": index, "stop": True, "semi_diameter": wide},
            {"radius": radii[1], "thickness": image, "index": behind, "semi_diameter": wide},
        ],
        {"entrance_pupil_diameter": wide},
        [0.0],
        [0.5876],
        object_index=before,
        name=name,
    )
