"""From what a person writes to the numbers that are traced."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np

from lenstrace.errors import LensTraceError, SceneError
from lenstrace.scene.frame import frame_at
from lenstrace.scene.lights.area import AreaLight
from lenstrace.scene.lights.delta import DistantLight, PointLight
from lenstrace.scene.lights.environment import Environment, environment
from lenstrace.scene.objects import Object, Scene
from lenstrace.scene.rules import LIGHTS, MATERIALS, SHAPES, SHINING, checked, colour, vector
from lenstrace.scene.stacks import stack
from lenstrace.scene.world import Primitive, World

# The radius of a scene, by which the power of light from far away is weighed against that of near ones.
RADIUS = 1.0


def world_of(scene: Scene, dtype: Any = np.float32) -> World:
    """The numbers of a scene in a precision. SceneError for the first rule that the scene breaks."""
    if not scene.objects:
        raise SceneError("objects: a scene needs at least one, got none")
    items = [_checked(item, f"object {i}") for i, item in enumerate(scene.objects, 1)]
    primitives = [
        Primitive(item.shape, frame_at(item.position, item.rotation, item.motion), np.int32(number))
        for number, item in enumerate(items)
    ]
    # what was written once is one material, however many objects are of it
    of_id = {id(raw.material): item.material for raw, item in zip(scene.objects, items, strict=True)}
    order = list(of_id)
    lights = [_said(f"light {i}", checked, light, LIGHTS) for i, light in enumerate(scene.lights, 1)]
    shining = np.full(len(items), -1, np.int32)
    for number, item in enumerate(items):
        if item.emission is not None:
            shining[number] = len(lights)
            lights.append(AreaLight(item.shape, primitives[number].frame, item.emission, np.int32(number)))
    around = None if scene.environment is None else _said("environment", _around, scene.environment, dtype)
    powers = [_power(light) for light in lights] + ([] if around is None else [_power_around(around)])
    return World(
        stack(primitives, dtype),
        jnp.asarray(np.array([order.index(id(raw.material)) for raw in scene.objects], np.int32)),
        stack(list(of_id.values()), dtype),
        jnp.asarray(shining) if np.any(shining >= 0) else None,
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
    return Object(
        _said(f"{where}: shape", checked, item.shape, SHAPES),
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
    return np.cumsum(weights) / max(weights.sum(), 1e-300)


def _power(light: Any) -> float:
    """Of a light, its colours taken alike."""
    if isinstance(light, PointLight):
        return 4 * np.pi * float(np.mean(light.intensity))
    if isinstance(light, DistantLight):
        return np.pi * RADIUS**2 * float(np.mean(light.irradiance))
    return np.pi * float(light.shape.area()) * float(np.mean(light.radiance))


def _power_around(around: Environment) -> float:
    return 4 * np.pi**2 * RADIUS**2 * float(np.mean(np.asarray(around.radiance)))
