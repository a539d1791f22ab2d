"""What a scene must obey to be one: every broken rule is one clear line."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.errors import LensTraceError, SceneError
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
from lenstrace.scene.frame import frame_at
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
from lenstrace.scene.objects import Scene

# Below it the highlights of float32 would be lost to rounding.
SMOOTHEST = 1e-3

SHAPES = (Sphere, Plane, Rectangle, Disk, Box, Cylinder, Torus, ConicCap, AsphereCap, Triangle, Implicit, Mesh)
# Those of which every part of the area is as likely as another to be taken for a light.
SHINING = (Sphere, Rectangle, Disk, Triangle, Mesh)
SOLIDS = (Sphere, Box, Cylinder, Torus, Implicit)
MATERIALS = (Diffuse, Mirror, Dielectric, RoughConductor, RoughDielectric, BlinnPhong)
LIGHTS = (PointLight, DistantLight)
CAMERAS = (Pinhole, ThinLens, Orthographic, LensCamera)

Rule = Callable[[Any], Any]


def obeyed(name: str, rule: Rule, value: Any) -> Any:
    """What a rule makes of a value; its error names it."""
    try:
        return rule(value)
    except LensTraceError as error:
        raise type(error)(f"{name} {error}") from None


def number(value: Any) -> float:
    """A finite number."""
    if isinstance(value, np.ndarray | jax.Array) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, int | float | np.floating | np.integer):
        raise SceneError(f"must be a number, got {value!r}")
    if not math.isfinite(value):
        raise SceneError(f"must be finite, got {value}")
    return float(value)


def positive(value: Any) -> float:
    """A number above 0."""
    if not number(value) > 0:
        raise SceneError(f"must be positive, got {value}")
    return float(value)


def extent(value: Any) -> float:
    """A number above 0, or inf."""
    return _or_infinite(value, positive)


def bound(value: Any) -> float:
    """A number, 0 or above, or inf."""
    return _or_infinite(value, not_negative)


def not_negative(value: Any) -> float:
    """A number, 0 or above."""
    if number(value) < 0:
        raise SceneError(f"must not be negative, got {value}")
    return float(value)


def numbers(value: Any) -> np.ndarray:
    """Finite numbers, (N,)."""
    return np.array([number(each) for each in value], float)


def share(value: Any) -> float:
    """A number from 0 to 1."""
    if not 0 <= number(value) <= 1:
        raise SceneError(f"must be from 0 to 1, a surface gives back no more light than it gets; got {value}")
    return float(value)


def roughness(value: Any) -> float:
    """From SMOOTHEST to 1."""
    if not SMOOTHEST <= number(value) <= 1:
        raise SceneError(f"must be from {SMOOTHEST:g} (polished; below it take a smooth material) to 1, got {value}")
    return float(value)


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


def vector(value: Any) -> tuple[float, float, float]:
    """Three finite numbers."""
    return _three(value, number)


def colour(value: Any) -> tuple[float, float, float]:
    """Linear RGB, not negative; one number for grey."""
    return _three(value, not_negative)


def coating(value: Any) -> Any:
    """What part of the light goes on: RGB from 0 to 1, one number for grey, or a texture."""
    return checked(value) if isinstance(value, Checker) else _three(value, share)


def _three(value: Any, rule: Rule) -> tuple[float, float, float]:
    if np.ndim(value) == 0 and rule is not number:
        value = (value,) * 3
    if np.ndim(value) != 1 or len(value) != 3:
        raise SceneError(f"must be three numbers, got {value!r}")
    x, y, z = (rule(each) for each in value)
    return x, y, z


def _or_infinite(value: Any, rule: Rule) -> float:
    return math.inf if isinstance(value, float) and value == math.inf else rule(value)


def _surface(kind: type) -> Rule:
    """A shape of the sequential tracer within another."""
    return lambda value: checked(value, (kind,))


def _view(value: Any) -> View:
    if not isinstance(value, View):
        raise SceneError(f"must be a View(position, target, up), got {value!r}")
    return checked(value)


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
    Pinhole: {"view": _view, "field_of_view": positive},
    ThinLens: {"view": _view, "focal_length": positive, "f_number": positive, "focus": positive, "film": positive},
    Orthographic: {"view": _view, "height": positive},
    LensCamera: {"view": _view},
}


def check_outside(position: Any, scene: Scene) -> None:
    """SceneError where a place lies inside a solid object."""
    here = tuple(jnp.asarray(float(each)) for each in position)
    for number, item in enumerate(scene.objects, 1):
        frame = frame_at(item.position, item.rotation, None)
        local, _ = frame.local(here, here, None)  # type: ignore[arg-type]
        if _holds(item.shape, local):
            name = f" ({item.name})" if item.name else ""
            raise SceneError(
                f"camera: stands inside object {number}{name}, a {type(item.shape).__name__}; move it out, or make "
                "a room of rectangles"
            )


def _holds(shape: Any, point: Any) -> bool:
    """Whether a point in the axes of a shape lies inside the solid that it is."""
    if isinstance(shape, Mesh):
        return shape.is_watertight and shape.winding(np.array(point, float)) > 0.5
    if isinstance(shape, Implicit) and max(abs(float(each)) for each in point) > float(shape.reach):
        return False
    return isinstance(shape, SOLIDS) and float(shape.value(point)) < 0


def checked(thing: Any, of: tuple[type, ...] = ()) -> Any:
    """The thing with its numbers checked, and made those of a program. SceneError: which number, what it must be.

    of: the kinds that are meant here, where only some are.
    """
    kinds = of or tuple(RULES)
    if type(thing) not in kinds or type(thing) not in RULES:
        raise SceneError(f"must be one of {', '.join(kind.__name__ for kind in kinds)}; got {thing!r}")
    kind = type(thing).__name__
    made = {name: obeyed(f"{kind}: {name}", rule, getattr(thing, name)) for name, rule in RULES[type(thing)].items()}
    return dataclasses.replace(thing, **made)
