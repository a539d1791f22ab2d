"""What the tables of a scene file may be: classes of `lenstrace.scene` by their names, and what is said otherwise."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from lenstrace.errors import CameraError, LensTraceError, SceneError
from lenstrace.io.kinds import Kinds, named
from lenstrace.io.native import load
from lenstrace.optics.shapes.asphere_cap import AsphereCap
from lenstrace.optics.shapes.conic_cap import ConicCap
from lenstrace.optics.shapes.implicit import Implicit
from lenstrace.scene.cameras.lens_camera import FULL_FRAME, lens_camera
from lenstrace.scene.cameras.simple import Orthographic, Pinhole, ThinLens
from lenstrace.scene.cameras.through_lens import LensCamera
from lenstrace.scene.cameras.view import View
from lenstrace.scene.materials.texture import Checker
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.mesh_file import load_mesh
from lenstrace.scene.mesh_formula import formula_mesh
from lenstrace.scene.number_rules import not_negative, obeyed, positive, vector
from lenstrace.scene.objects import Three
from lenstrace.scene.rules import LIGHTS, MATERIALS, SHAPES
from lenstrace.scene.surfaces import asphere, conic, implicit

UP = (0.0, 1.0, 0.0)
AS_DESIGNED = "as designed"

MATERIAL_KINDS, LIGHT_KINDS, TEXTURE_KINDS = named(MATERIALS), named(LIGHTS), named([Checker])


def shape_kinds(folder: str) -> Kinds:
    """Shapes; files that they name are looked for in a folder."""

    def mesh(
        file: str = "",
        formula: str = "",
        steps: tuple[int, int] = (200, 100),
        constants: Mapping[str, float] | None = None,
        vertices: tuple[Three, ...] = (),
        faces: tuple[tuple[int, int, int], ...] = (),
        scale: float = 1.0,
        reversed: bool = False,
    ) -> Mesh:
        if [bool(file), bool(formula), bool(vertices)].count(True) != 1:
            raise SceneError('mesh: give one of file = "a.ply", formula = "torus knot", or vertices and faces')
        if vertices:
            given = _written(vertices, faces)
        else:
            given = load_mesh(_beside(folder, "file", file)) if file else formula_mesh(formula, *_two(steps), constants)
        made = given.scaled(obeyed("scale", positive, scale))
        return made.reversed() if reversed else made

    said_otherwise = (Mesh, ConicCap, AsphereCap, Implicit)
    plain = named(kind for kind in SHAPES if kind not in said_otherwise)
    return {**plain, "conic": conic, "asphere": asphere, "implicit": implicit, "mesh": mesh}


def camera_kinds(folder: str) -> Kinds:
    """Cameras: the keys of their view stand beside their own."""

    def pinhole(position: Three, target: Three, field_of_view: float, up: Three = UP) -> Pinhole:
        return Pinhole(View(position, target, up), field_of_view)  # type: ignore[arg-type]

    def thin_lens(
        position: Three,
        target: Three,
        focal_length: float,
        f_number: float,
        focus: float,
        film: float,
        up: Three = UP,
    ) -> ThinLens:
        return ThinLens(View(position, target, up), focal_length, f_number, focus, film)  # type: ignore[arg-type]

    def orthographic(position: Three, target: Three, height: float, up: Three = UP) -> Orthographic:
        return Orthographic(View(position, target, up), height)  # type: ignore[arg-type]

    def lens(
        position: Three,
        target: Three,
        file: str,
        up: Three = UP,
        film: float = FULL_FRAME,
        focus: float | str = math.inf,
        f_number: float | None = None,
        unit_mm: float = 1.0,
        aspect: float = 2.0,
        rims: bool = True,
        irradiance: bool = False,
        colour: bool = True,
        fresnel: bool = False,
        absorption: Mapping[str, float] | None = None,
    ) -> LensCamera:
        try:
            prescription = load(_beside(folder, "file", file))
        except LensTraceError as error:
            raise CameraError(f"file: {error}") from None
        if isinstance(focus, str) and focus != AS_DESIGNED:
            raise CameraError(f"focus must be a distance from the film, inf, or {AS_DESIGNED!r}; got {focus!r}")
        far = focus if isinstance(focus, float) and math.isinf(focus) else None
        return lens_camera(
            prescription,
            obeyed("position", vector, position),
            obeyed("target", vector, target),
            obeyed("up", vector, up),
            film=obeyed("film", positive, film),
            focus=None if focus == AS_DESIGNED else far or obeyed("focus", positive, focus),
            f_number=None if f_number is None else obeyed("f_number", positive, f_number),
            unit_mm=obeyed("unit_mm", positive, unit_mm),
            aspect=obeyed("aspect", positive, aspect),
            rims=_flag("rims", rims),
            irradiance=_flag("irradiance", irradiance),
            colour=_flag("colour", colour),
            fresnel=_flag("fresnel", fresnel),
            absorption=_absorption(absorption),
        )

    return {"pinhole": pinhole, "thin_lens": thin_lens, "orthographic": orthographic, "lens": lens}


def _beside(folder: str, key: str, name: Any) -> str:
    if not isinstance(name, str):
        raise SceneError(f"{key} must be the name of a file, got {name!r}")
    return os.path.join(folder, name)


def _written(vertices: Any, faces: Any) -> Mesh:
    """A mesh whose corners stand in the file."""
    try:
        return Mesh(np.array(vertices), np.array(faces))
    except ValueError:
        raise SceneError("mesh: vertices and faces must be lists of three numbers each") from None


def _flag(key: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise SceneError(f"{key} must be true or false, got {value!r}")
    return value


def _two(steps: Any) -> tuple[int, int]:
    whole = isinstance(steps, tuple) and len(steps) == 2 and all(type(each) is int for each in steps)
    if not whole:
        raise SceneError(f"steps must be two whole numbers, such as [200, 100], got {steps!r}")
    return steps


def _absorption(given: Any) -> dict[int, float] | None:
    """By the numbers of surfaces, which are words in a file."""
    if given is None:
        return None
    if not isinstance(given, Mapping) or not all(str(key).isdigit() for key in given):
        raise SceneError(f"absorption must be a table of surfaces and 1/mm, {{ 3 = 0.001 }}, got {given!r}")
    return {int(key): obeyed(f"absorption: {key}", not_negative, value) for key, value in given.items()}
