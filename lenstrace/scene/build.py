"""From what a person writes to the numbers that are traced."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np

from lenstrace.scene.frame import frame_at
from lenstrace.scene.lights.area import AreaLight
from lenstrace.scene.lights.delta import DistantLight, PointLight
from lenstrace.scene.lights.environment import environment
from lenstrace.scene.objects import Object, Scene
from lenstrace.scene.stacks import stack
from lenstrace.scene.world import Primitive, World

# The radius of a scene, by which the power of light from far away is weighed against that of near ones.
RADIUS = 1.0


def world_of(scene: Scene, dtype: Any = np.float32) -> World:
    """The numbers of a scene in a precision."""
    primitives, materials, numbers, lights, shining = [], [], [], [], []
    for item in scene.objects:
        number = np.int32(len(primitives))
        frame = frame_at(item.position, item.rotation, item.motion)
        primitives.append(Primitive(item.shape, frame, number))
        if not any(item.material is each for each in materials):
            materials.append(item.material)
        numbers.append(next(i for i, each in enumerate(materials) if each is item.material))
        shining.append(-1 if item.emission is None else len(lights))
        if item.emission is not None:
            lights.append(AreaLight(item.shape, frame, item.emission, number))
    lights.extend(scene.lights)
    around = None
    if scene.environment is not None:
        around = environment(
            np.broadcast_to(np.asarray(scene.environment, float), (1, 1, 3))
            if np.ndim(scene.environment) == 1
            else np.asarray(scene.environment),
            np.dtype(dtype),
        )
    powers = [_power(light) for light in lights]
    if around is not None:
        powers.append(float(np.mean(np.asarray(around.radiance))) * 4 * np.pi**2 * RADIUS**2)
    total = sum(powers)
    chosen = np.cumsum(powers) / total if total > 0 else np.arange(1, len(powers) + 1) / max(len(powers), 1)
    return World(
        stack(primitives, dtype),
        jnp.asarray(np.array(numbers, np.int32)),
        stack(materials, dtype),
        jnp.asarray(np.array(shining, np.int32)) if max(shining, default=-1) >= 0 else None,
        stack(lights, dtype) if lights else None,
        jnp.asarray(chosen, dtype),
        around,
    )


def _power(light: Any) -> float:
    """Of a light, weighed alike over its colours."""
    if isinstance(light, PointLight):
        return 4 * np.pi * float(np.mean(light.intensity))
    if isinstance(light, DistantLight):
        return np.pi * RADIUS**2 * float(np.mean(light.irradiance))
    return np.pi * float(light.shape.area()) * float(np.mean(light.radiance))
