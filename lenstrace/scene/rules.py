"""What a scene must obey to be one: every broken rule is one clear line."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from lenstrace.compute.pytree import is_traced
from lenstrace.errors import SceneError
from lenstrace.optics.glasses import glass
from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.asphere_cap import AsphereCap
from lenstrace.optics.shapes.box import Box
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.shapes.conic_cap import ConicCap
from lenstrace.optics.shapes.cylinder import Cylinder
from lenstrace.optics.shapes.disk import Disk
from lenstrace.optics.shapes.implicit import Implicit
from lenstrace.optics.shapes.plane import Plane
from lenstrace.optics.shapes.rectangle import Rectangle
from lenstrace.optics.shapes.sphere import Sphere
from lenstrace.optics.shapes.torus import Torus
from lenstrace.optics.shapes.triangle import Triangle
from lenstrace.scene.cameras.simple import Orthographic, Pinhole, ThinLens
from lenstrace.scene.cameras.through_lens import LensCamera
from lenstrace.scene.cameras.view import View
from lenstrace.scene.dispersion import Dispersion
from lenstrace.scene.lights.delta import DistantLight, PointLight
from lenstrace.scene.materials.blinn_phong import BlinnPhong
from lenstrace.scene.materials.dielectric import Dielectric
from lenstrace.scene.materials.diffuse import Diffuse
from lenstrace.scene.materials.index import FlatIndex, index_of
from lenstrace.scene.materials.mirror import Mirror
from lenstrace.scene.materials.rough_conductor import RoughConductor
from lenstrace.scene.materials.rough_dielectric import RoughDielectric
from lenstrace.scene.materials.texture import Checker
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.number_rules import (
    Rule,
    angle,
    bound,
    colour,
    extent,
    not_negative,
    number,
    numbers,
    obeyed,
    positive,
    roughness,
    share,
    three,
    vector,
)

# Of decimal fractions that add up to 1.
ROUNDING = 1e-12

SHAPES = (Sphere, Plane, Rectangle, Disk, Box, Cylinder, Torus, ConicCap, AsphereCap, Triangle, Implicit, Mesh)
# Those of which every part of the area is as likely as another to be taken for a light.
SHINING = (Sphere, Rectangle, Disk, Triangle, Mesh)
MATERIALS = (Diffuse, Mirror, Dielectric, RoughConductor, RoughDielectric, BlinnPhong)
LIGHTS = (PointLight, DistantLight)
CAMERAS = (Pinhole, ThinLens, Orthographic, LensCamera)


def index(value: Any) -> Any:
    """A refractive index: a number, the name of a glass, or a medium."""
    if isinstance(value, str):
        return index_of(glass(value))
    if isinstance(value, FlatIndex | Dispersion):
        return value
    if not isinstance(value, bool | int | float | np.floating | np.integer):
        return index_of(value)
    if not number(value) >= 1:
        raise SceneError(f"must be at least 1 in a scene, got {value}")
    return FlatIndex(float(value))


def coating(value: Any) -> Any:
    """What part of the light goes on: RGB from 0 to 1, one number for grey, or a texture."""
    return checked(value) if isinstance(value, Checker) else three(value, share)


def _surface(kind: type) -> Rule:
    """A shape of the sequential tracer within another."""
    return lambda value: checked(value, (kind,))


def _view(value: Any) -> View:
    if not isinstance(value, View):
        raise SceneError(f"must be a View(position, target, up), got {value!r}")
    view = checked(value)
    view.require_axes()
    return view


def _ring(disk: Disk) -> None:
    if not disk.hole < disk.radius:
        raise SceneError(f"Disk: hole must be less than the radius, {disk.radius:g}, got {disk.hole:g}")


def _tube(torus: Torus) -> None:
    if not torus.minor < torus.major:
        raise SceneError(f"Torus: minor must be less than the major radius, {torus.major:g}, got {torus.minor:g}")


def _sharp(lens: ThinLens) -> None:
    if not lens.focus > lens.focal_length:
        raise SceneError(
            f"ThinLens: focus must be farther than the focal length, {lens.focal_length:g}, got {lens.focus:g}"
        )


def _balanced(material: BlinnPhong) -> None:
    total = np.max(np.add(_most(material.diffuse), _most(material.specular)))
    if total > 1 + ROUNDING:
        raise SceneError(f"BlinnPhong: diffuse and specular must be at most 1 together, got {total:g}")


def _most(coat: Any) -> np.ndarray:
    return np.maximum(coat.even, coat.odd) if isinstance(coat, Checker) else np.asarray(coat)


RULES: Mapping[type, Mapping[str, Rule]] = {
    Sphere: {"radius": positive},
    Rectangle: {"half_x": extent, "half_y": extent},
    Disk: {"radius": extent, "hole": not_negative},
    Box: {"half_x": positive, "half_y": positive, "half_z": positive},
    Cylinder: {"radius": positive, "half_length": positive},
    Plane: {},
    Torus: {"major": positive, "minor": positive},
    Triangle: {"a": vector, "b": vector, "c": vector},
    Mesh: {},
    Conic: {"curvature": number, "conic": number},
    Asphere: {"curvature": number, "conic": number, "coefficients": numbers, "norm_radius": positive},
    ConicCap: {"surface": _surface(Conic), "semi_diameter": extent},
    AsphereCap: {"surface": _surface(Asphere), "semi_diameter": positive},
    Implicit: {"reach": positive, "steepness": positive, "bending": bound},
    Diffuse: {"albedo": coating},
    Mirror: {"reflectance": coating},
    BlinnPhong: {"diffuse": coating, "specular": coating, "exponent": not_negative},
    Dielectric: {"index": index, "outside": index},
    RoughDielectric: {"index": index, "outside": index, "roughness": roughness},
    RoughConductor: {"eta": colour, "k": colour, "roughness": roughness},
    Checker: {"even": coating, "odd": coating, "size": positive, "origin": vector},
    PointLight: {"position": vector, "intensity": colour},
    DistantLight: {"direction": vector, "irradiance": colour},
    View: {"position": vector, "target": vector, "up": vector},
    Pinhole: {"view": _view, "field_of_view": angle},
    ThinLens: {"view": _view, "focal_length": positive, "f_number": positive, "focus": positive, "film": positive},
    Orthographic: {"view": _view, "height": positive},
    LensCamera: {"view": _view},
}
# Of several numbers of one thing.
TOGETHER: Mapping[type, Callable[[Any], None]] = {Disk: _ring, Torus: _tube, ThinLens: _sharp, BlinnPhong: _balanced}


def checked(thing: Any, of: tuple[type, ...] = ()) -> Any:
    """The thing with its numbers checked, and made those of a program. SceneError: which number, what it must be.

    of: the kinds that are meant here, where only some are. Numbers that JAX traces have no value that could be checked.
    """
    kinds = of or tuple(RULES)
    if type(thing) not in kinds or type(thing) not in RULES:
        raise SceneError(f"must be one of {', '.join(kind.__name__ for kind in kinds)}; got {thing!r}")
    kind = type(thing).__name__
    known = {name: rule for name, rule in RULES[type(thing)].items() if not is_traced(getattr(thing, name))}
    made = {name: obeyed(f"{kind}: {name}", rule, getattr(thing, name)) for name, rule in known.items()}
    thing = dataclasses.replace(thing, **made)
    if type(thing) in TOGETHER and not is_traced(thing):
        TOGETHER[type(thing)](thing)
    return thing
