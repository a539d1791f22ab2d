"""The tracer's own derivatives of rays at the image, by all numbers that go in, as JAX gives them."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import with_pupil
from lenstrace.analysis.extremes.errors import BACKWARD
from lenstrace.optics.rays import Ray
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference_layout import Layout
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace

# These programs run once: what is not optimized compiles in a fraction of the time.
QUICKLY: dict[str, int | bool] = {"xla_backend_optimization_level": 0, "xla_cpu_use_fusion_emitters": False}
NAMES = ("index", "curvature", "conic", "coefficients", "thickness", "decenter", "tilt")
BLOCK = 8  # rays are filled up to a multiple of these, so that trials share a program


def slopes_by_numbers(system: System, starts: np.ndarray) -> np.ndarray:
    """(N, 7, I): derivatives of x, y, z, l, m, n and opl at the image by the six numbers of each ray (N, 6) and by
    those of the system, in the order of `Layout`; of asphere terms as the judge knows them, a_p of r^p."""
    by_start, by = jax.device_get(_by_numbers(_bare(system), _filled(starts)))
    count, powers = len(system.kinds), np.array(max((kind.powers for kind in system.kinds), key=len), int)
    layout = Layout(count, len(powers))
    slopes = np.zeros((len(by_start), 7, layout.size))
    slopes[..., layout.point], slopes[..., layout.direction] = by_start[..., :3], by_start[..., 3:]
    slopes[..., layout.indices] = by["index"]
    blocks = layout.blocks(slopes)
    blocks[..., layout.curvature], blocks[..., layout.conic] = by["curvature"], by["conic"]
    lengths = np.asarray(system.norm_radius, float)[:, None] ** (powers - 1)
    blocks[..., layout.coefficients] = by["coefficients"][..., : len(powers)] * lengths
    blocks[..., 1:, layout.gap] = by["thickness"]
    blocks[..., layout.decenter], blocks[..., layout.tilt] = by["decenter"], by["tilt"]
    return slopes[: len(starts)]


def slopes_by_launch(lens: Lens, launched: np.ndarray) -> np.ndarray:
    """(N, 7, 4): the same by field x and y (radians or mm) and pupil x and y, through the launch; launched: (N, 4), the
    field in the lens's unit."""
    system, front = with_pupil(lens)
    points = (launched * np.array([lens.fields.scale] * 2 + [1.0] * 2)).astype(np.asarray(system.curvature).dtype)
    return np.asarray(_by_launch(front, system.at(system.primary), _filled(points)), float)[: len(launched)]


def _filled(rays: np.ndarray) -> np.ndarray:
    """Up to a whole number of blocks, by the last one again."""
    return np.concatenate([rays, np.repeat(rays[-1:], -len(rays) % BLOCK, 0)])


def _results(system: System, ray: Ray) -> jax.Array:
    sense = jnp.where(ray.n < BACKWARD, -1.0, 1.0).astype(ray.n.dtype)
    end = trace(system, Ray(ray.x, ray.y, ray.z, ray.l, ray.m, ray.n, ray.failure, jnp.zeros_like(ray.x)), sense=sense)
    assert end.opl is not None
    return jnp.stack([end.x, end.y, end.z, end.l, end.m, end.n, end.opl])


def _numbers_slopes(system: System, starts: jax.Array) -> Any:
    numbers = {name: jnp.asarray(getattr(system, name)) for name in NAMES}

    def result(start: jax.Array, numbers: dict[str, jax.Array], weights: jax.Array) -> jax.Array:
        x, y, z, l, m, n = start
        ray = Ray(x, y, z, l, m, n, failure=jnp.zeros((), jnp.int32))
        return jnp.dot(weights, _results(system.replace(**numbers), ray))

    # one batch of all pairs compiles faster than one in the other
    count = len(starts)
    pairs = jnp.repeat(starts, 7, 0), jnp.tile(jnp.eye(7, dtype=starts.dtype), (count, 1))
    slopes = jax.vmap(jax.grad(result, (0, 1)), (0, None, 0))(pairs[0], numbers, pairs[1])
    return jax.tree.map(lambda a: a.reshape(count, 7, *a.shape[1:]), slopes)


def _launch_slopes(front: Front, system: System, points: jax.Array) -> jax.Array:
    def results(point: jax.Array) -> jax.Array:
        field_x, field_y, pupil_x, pupil_y = point
        return _results(system, launch(front, system.light, (field_x, field_y), (pupil_x, pupil_y)))

    return jax.vmap(jax.jacfwd(results))(points)


_by_numbers = jax.jit(_numbers_slopes, compiler_options=QUICKLY)
_by_launch = jax.jit(_launch_slopes, compiler_options=QUICKLY)


def _bare(system: System) -> System:
    """What a trace needs and nothing else, so that lenses that are launched differently share a program."""
    return system.replace(object_distance=None, stop=1, aperture_kind="", field_kind="", ray_aiming=False)
