"""From what a person writes to the numbers that are traced."""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp
import numpy as np

from lenstrace.scene.frame import frame_at
from lenstrace.scene.lights.area import AreaLight
from lenstrace.scene.lights.delta import DistantLight, PointLight
from lenstrace.scene.lights.environment import environment
from lenstrace.scene.mesh import Mesh
from lenstrace.scene.objects import Scene
from lenstrace.scene.search.kind import Way
from lenstrace.scene.searched import mesh_primitives, searched
from lenstrace.scene.stacks import Many, stack
from lenstrace.scene.world import Primitive, World

# The radius of a scene, by which the power of light from far away is weighed against that of near ones.
RADIUS = 1.0


def world_of(scene: Scene, dtype: Any = np.float32, way: Way = Way.AUTO) -> World:
    """The numbers of a scene in a precision. way: how the nearest of many primitives is found."""
    primitives, materials, numbers, lights, shining = [], [], [], [], []
    # the triangles of all meshes follow each other
    for item in sorted(scene.objects, key=lambda item: isinstance(item.shape, Mesh)):
        if isinstance(item.shape, Mesh):
            if not any(item.material is each for each in materials):
                materials.append(item.material)
            shape = item.shape.triangles(item.position, item.rotation, np.dtype(dtype))
            triangles, light = mesh_primitives(item, shape, len(numbers))
            primitives.append(triangles)
            mine = next(i for i, each in enumerate(materials) if each is item.material)
            numbers.extend([mine] * triangles.count)
            count = sum(getattr(each, "count", 1) for each in lights)
            shining.extend([-1] * triangles.count if light is None else range(count, count + triangles.count))
            if light is not None:
                lights.append(light)
            continue
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
    powers = [power for light in lights for power in _powers(light)]
    if around is not None:
        powers.append(float(np.mean(np.asarray(around.radiance))) * 4 * np.pi**2 * RADIUS**2)
    total = sum(powers)
    chosen = np.cumsum(powers) / total if total > 0 else np.arange(1, len(powers) + 1) / max(len(powers), 1)
    standing, searches = searched(stack(primitives, dtype), way)
    return World(
        standing,
        searches,
        jnp.asarray(np.array(numbers, np.int32)),
        stack(materials, dtype),
        jnp.asarray(np.array(shining, np.int32)) if max(shining, default=-1) >= 0 else None,
        stack(lights, dtype) if lights else None,
        jnp.asarray(chosen, dtype),
        around,
    )


def _powers(light: Any) -> list[float]:
    """Of a light, or of many."""
    if isinstance(light, Many):
        area, radiance = np.asarray(light.things.shape.area()), np.mean(light.things.radiance, axis=0)
        return (np.pi * area * radiance).tolist()
    return [_power(light)]


def _power(light: Any) -> float:
    """Of a light, weighed alike over its colours."""
    if isinstance(light, PointLight):
        return 4 * np.pi * float(np.mean(light.intensity))
    if isinstance(light, DistantLight):
        return np.pi * RADIUS**2 * float(np.mean(light.irradiance))
    return np.pi * float(light.shape.area()) * float(np.mean(light.radiance))
