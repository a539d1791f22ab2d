"""From what a person writes to the numbers that are traced."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import jax.numpy as jnp
import numpy as np

from lenstrace.errors import LensTraceError, SceneError
from lenstrace.scene.lights.delta import DistantLight, PointLight
from lenstrace.scene.lights.environment import Environment, environment
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.number_rules import colour, vector
from lenstrace.scene.objects import Object, Scene
from lenstrace.scene.rules import LIGHTS, MATERIALS, SHAPES, SHINING, checked
from lenstrace.scene.search.boxes import boxes
from lenstrace.scene.search.kind import Way
from lenstrace.scene.searched import check_object, lights_of, primitives_of, searched
from lenstrace.scene.stacks import Many, stack
from lenstrace.scene.world import World

# The radius of a scene that has none: planes without an end, and lights without a place.
RADIUS = 1.0


def world_of(scene: Scene, dtype: Any = np.float32, way: Way = Way.AUTO) -> World:
    """The numbers of a scene in a precision. SceneError for the first rule that the scene breaks.

    way: how the nearest of many primitives is found.
    """
    if not scene.objects:
        raise SceneError("objects: a scene needs at least one, got none")
    items = [_checked(item, f"object {i}") for i, item in enumerate(scene.objects, 1)]
    # what was written once is one material, however many objects are of it
    of_id = {id(raw.material): item.material for raw, item in zip(scene.objects, items, strict=True)}
    order = list(of_id)
    lights = [_said(f"light {i}", checked, light, LIGHTS) for i, light in enumerate(scene.lights, 1)]
    primitives, materials, shining, powers = [], [], [], []
    # the triangles of all meshes follow each other
    for raw, item in sorted(zip(scene.objects, items, strict=True), key=lambda pair: isinstance(pair[1].shape, Mesh)):
        some = _said(item.name or "object", primitives_of, item, len(materials), dtype)
        primitives.append(some)
        materials += [order.index(id(raw.material))] * some.count
        of_lights = len(scene.lights) + len(powers)
        shining += [-1] * some.count if item.emission is None else range(of_lights, of_lights + some.count)
        if item.emission is not None:
            lights.append(lights_of(some, item.emission))
            area = np.asarray(some.things.shape.area(), float)
            if not np.isfinite(area).all():
                raise SceneError(f"{item.name or 'object'}: emission needs a shape with an end, got {item.shape}")
            powers += (np.pi * np.mean(item.emission) * area).tolist()
    around = None if scene.environment is None else _said("environment", _around, scene.environment, dtype)
    radius = _radius(primitives, scene.lights)
    powers = [_power(light, radius) for light in lights[: len(scene.lights)]] + powers
    powers += [] if around is None else [4 * np.pi**2 * radius**2 * float(np.mean(np.asarray(around.radiance)))]
    standing, searches = searched(stack(primitives, dtype), way)
    return World(
        standing,
        searches,
        jnp.asarray(np.array(materials, np.int32)),
        stack(list(of_id.values()), dtype),
        jnp.asarray(np.array(shining, np.int32)) if max(shining) >= 0 else None,
        stack(lights, dtype) if lights else None,
        jnp.asarray(_cumulated(powers), dtype),
        around,
    )


def _checked(item: Object, where: str) -> Object:
    """An object whose numbers are those of a program."""
    where = f"{where} ({item.name})" if item.name else where
    emission = None if item.emission is None else _said(f"{where}: emission", colour, item.emission)
    if emission is not None and not isinstance(item.shape, SHINING):
        names = ", ".join(kind.__name__ for kind in SHINING)
        raise SceneError(f"{where}: emission of a {type(item.shape).__name__} is not known; one of {names} may shine")
    shape = _said(f"{where}: shape", checked, item.shape, SHAPES)
    _said(where, check_object, item)
    return Object(
        shape,
        _said(f"{where}: material", checked, item.material, MATERIALS),
        _said(f"{where}: position", vector, item.position),
        _said(f"{where}: rotation", vector, item.rotation),
        emission,
        None if item.motion is None else _said(f"{where}: motion", vector, item.motion),
        item.name,
    )


def _said(where: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """What a function gives; its errors name the place."""
    try:
        return function(*arguments)
    except LensTraceError as error:
        raise type(error)(f"{where}: {error}") from None


def _around(radiance: Any, dtype: Any) -> Environment:
    """The environment of one colour, or of a map."""
    cells = np.asarray(radiance, float)
    if cells.ndim < 2:
        cells = np.array(colour(radiance)).reshape(1, 1, 3)
    if cells.ndim != 3 or cells.shape[2] != 3 or cells.size == 0:
        raise SceneError(f"must be one colour, or a map (rows, columns, 3); got an array {cells.shape}")
    if not np.all(np.isfinite(cells) & (cells >= 0)):
        raise SceneError("must be finite and not negative everywhere")
    return environment(cells, np.dtype(dtype))


def _cumulated(powers: list[float]) -> np.ndarray:
    """Chances by power, each with all before it; alike where all are dark."""
    weights = np.array(powers) if sum(powers) > 0 else np.ones(len(powers))
    chosen = np.cumsum(weights) / max(weights.sum(), 1e-300)
    chosen[-1:] = 1  # not less by rounding: every number in [0, 1) chooses a light that has a chance
    return chosen


def _radius(primitives: list[Many], lights: Sequence[Any]) -> float:
    """Half the diagonal of the box around all that has an end, by which light from far away is weighed against near."""
    corners = [boxes(each.things.shape, each.things.frame) for each in primitives]
    places = [np.asarray([light.position], float) for light in lights if isinstance(light, PointLight)]
    ends = np.concatenate([np.zeros((0, 3)), *places, *(end for both in corners if both is not None for end in both)])
    return 0.5 * float(np.linalg.norm(np.ptp(ends, axis=0))) if len(ends) > 1 else RADIUS


def _power(light: Any, radius: float) -> float:
    """Of a light, its colours taken alike."""
    if isinstance(light, PointLight):
        return 4 * np.pi * float(np.mean(light.intensity))
    if isinstance(light, DistantLight):
        return np.pi * radius**2 * float(np.mean(light.irradiance))
    raise TypeError(f"no light: {light!r}")
