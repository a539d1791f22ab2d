"""Meshes made by formulas: x, y and z of two numbers u and v."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np

from lenstrace.errors import SceneError
from lenstrace.scene.formula import formula
from lenstrace.scene.mesh import Mesh

# Vertices of a first or last row that lie so near to each other, for the size of the mesh, are one: a pole.
POLE = 1e-6


@dataclasses.dataclass(frozen=True)
class Parametric:
    """A surface of two numbers, each from 0 to 1.

    x, y, z:  formulas of u, v, the constants, and what is defined.
    define:   formulas by name, of u, v, the constants, and those defined before; for what is used more than once.
    constants: numbers by name.
    closed_u, closed_v: whether the surface at 1 goes on with that at 0.
    """

    x: str
    y: str
    z: str
    define: Mapping[str, str] = dataclasses.field(default_factory=dict)
    constants: Mapping[str, float] = dataclasses.field(default_factory=dict)
    closed_u: bool = False
    closed_v: bool = False

    def mesh(self, steps_u: int, steps_v: int) -> Mesh:
        """2 steps_u steps_v triangles, less those at poles; counterclockwise where u goes to the right and v up.

        A side along which all points are one is closed by a pole. SceneError for formulas that are none, or not finite.
        """
        for name, steps, closed in (("steps_u", steps_u, self.closed_u), ("steps_v", steps_v, self.closed_v)):
            if steps < (3 if closed else 1):
                raise SceneError(f"mesh: {name} must be at least {3 if closed else 1}, got {steps}")
        points = self._points(
            np.arange(steps_u + 1 - self.closed_u) / steps_u, np.arange(steps_v + 1 - self.closed_v) / steps_v
        )
        if not np.isfinite(points).all():
            i, j = np.argwhere(~np.isfinite(points).all(-1))[0]
            raise SceneError(f"mesh: its formula is not finite at u = {i / steps_u:g}, v = {j / steps_v:g}")
        _join_poles(points, self.closed_u, self.closed_v)
        number = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
        rows = (np.arange(steps_u + 1) % len(number))[:, None]
        corner = number[rows, np.arange(steps_v + 1) % number.shape[1]]
        a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
        faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
        return Mesh(points.reshape(-1, 3), faces)

    def _points(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """(len(u), len(v), 3)."""
        values = {"u": u[:, None] + 0 * v, "v": v + 0 * u[:, None]}
        with np.errstate(all="ignore"):
            for name, text in self.define.items():
                values[name] = formula(text, tuple(values), self.constants)(*values.values())
            parts = [
                formula(text, tuple(values), self.constants)(*values.values()) for text in (self.x, self.y, self.z)
            ]
        return np.stack([np.broadcast_to(part, values["u"].shape) for part in parts], -1).astype(float)


# Outward of their solids; lengths of order 1.
RIPPLED_SPHERE = Parametric(
    "r * sin(theta) * cos(phi)",
    "r * cos(theta)",
    "-r * sin(theta) * sin(phi)",
    {
        "phi": "2 * pi * u",
        "theta": "pi * (1 - v)",
        "r": "1 + height * cos(waves * phi) * sin(waves * theta) * sin(theta)^2",
    },
    {"height": 0.1, "waves": 12},
    closed_u=True,
)
# A. Barr, IEEE Computer Graphics and Applications 1 (1), 11 (1981); exponents 1 and 1 are the sphere.
SUPERQUADRIC = Parametric(
    "power_c * sign(cos(phi)) * abs(cos(phi))^east",
    "sign(sin(theta)) * abs(sin(theta))^north",
    "-power_c * sign(sin(phi)) * abs(sin(phi))^east",
    {"phi": "2 * pi * u", "theta": "pi * (v - 0.5)", "power_c": "abs(cos(theta))^north"},
    {"north": 0.4, "east": 0.4},
    closed_u=True,
)
# A tube about a curve that winds p times about the axis of a torus and q times through its hole: the torus's normal
# (n) and its product with the curve's tangent (t) stand across the curve.
TORUS_KNOT = Parametric(
    "across * cos(p * a) + tube * (cos(b) * nx + sin(b) * (ty * nz - tz * ny) / t)",
    "sin(q * a) + tube * (cos(b) * nz + sin(b) * (tx * ny - ty * nx) / t)",
    "-(across * sin(p * a) + tube * (cos(b) * ny + sin(b) * (tz * nx - tx * nz) / t))",
    {
        "a": "2 * pi * u",
        "b": "-2 * pi * v",
        "across": "ring + cos(q * a)",
        "nx": "cos(q * a) * cos(p * a)",
        "ny": "cos(q * a) * sin(p * a)",
        "nz": "sin(q * a)",
        "tx": "-q * sin(q * a) * cos(p * a) - p * across * sin(p * a)",
        "ty": "-q * sin(q * a) * sin(p * a) + p * across * cos(p * a)",
        "tz": "q * cos(q * a)",
        "t": "sqrt(q^2 + (p * across)^2)",
    },
    {"p": 2, "q": 3, "ring": 2, "tube": 0.4},
    closed_u=True,
    closed_v=True,
)
SURFACES: Mapping[str, Parametric] = {
    "rippled sphere": RIPPLED_SPHERE,
    "superquadric": SUPERQUADRIC,
    "torus knot": TORUS_KNOT,
}


def formula_mesh(name: str, steps_u: int, steps_v: int, constants: Mapping[str, float] | None = None) -> Mesh:
    """One of SURFACES, with constants in place of its own."""
    if name not in SURFACES:
        raise SceneError(f"mesh: unknown surface {name!r}; one of {', '.join(SURFACES)}, or write a Parametric")
    surface = SURFACES[name]
    for each in constants or {}:
        if each not in surface.constants:
            raise SceneError(f"mesh: {name} has no constant {each!r}; it has {', '.join(surface.constants)}")
    return dataclasses.replace(surface, constants={**surface.constants, **(constants or {})}).mesh(steps_u, steps_v)


def _join_poles(points: np.ndarray, closed_u: bool, closed_v: bool) -> None:
    """Make the points of a side one where they are nearly."""
    size = np.ptp(points.reshape(-1, 3), axis=0).max()
    sides = ([] if closed_v else [points[:, 0], points[:, -1]]) + ([] if closed_u else [points[0], points[-1]])
    for side in sides:
        if np.ptp(side, axis=0).max() <= POLE * size:
            side[:] = side.mean(0)
