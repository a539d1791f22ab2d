"""What the fresh processes of sections memory and compile do; each function is called in a process of its own."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.monitoring
import jax.numpy as jnp
import numpy as np

import lenstrace
from lenstrace import Lens
from tests.benchmarks import launched, yardstick
from tests.benchmarks.fresh import peak_mb

MILLION = 1_000_000
RINGS = 500  # 751,501 rays
MB = 1e6
XLA_COMPILED = "/jax/core/compile/backend_compile_duration"  # an event of jax.monitoring


def forward_memory() -> dict[str, float]:
    """A million rays through the double Gauss, the image alone."""
    before = peak_mb()
    lens = launched.double_gauss()
    rays = launched.filling(lens, MILLION)
    image = jax.block_until_ready(lenstrace.trace(lens, rays, path=False, opl=False))
    return {"rays": MILLION, "peak": peak_mb() - before, "arrays": _megabytes((rays, image))}


def gradient_memory() -> dict[str, float]:
    """The gradient of the mean square spot of one field and wavelength by all curvatures."""
    before = peak_mb()
    lens = launched.one_colour(launched.double_gauss())
    jax.block_until_ready(_slope(lens, RINGS)())
    count = 1 + 3 * RINGS * (RINGS + 1)
    return {"rays": count, "peak": peak_mb() - before, "arrays": 2 * 8 * count / MB}


def large_picture() -> dict[str, float]:
    """Cornell's box in 4,000 x 3,000 pixels, one sample each."""
    path = Path(__file__).parents[2] / "designs" / "scenes" / "cornell_box.toml"
    setup = lenstrace.load_scene(path)
    picture = lenstrace.render(setup.scene, setup.camera, size=(4000, 3000), samples=1, depth=8)
    return {"pixels": picture.samples.size, "peak": peak_mb()}


def kernel_compiles(count: int, copies: int) -> dict[str, float]:
    """Seconds the bare kernel takes to trace, lower and compile."""
    compiler = _compiler_seconds()
    return {"all": yardstick.compile_seconds(_lens(copies), count), "xla": sum(compiler), "programs": len(compiler)}


def forward_compiles(count: int, copies: int) -> dict[str, float]:
    """Seconds a first trace takes beyond a warm one."""
    lens = _lens(copies)
    rays = launched.filling(lens, count)
    return _beyond_warm(lambda: jax.block_until_ready(lenstrace.trace(lens, rays, path=False, opl=False)))


def gradient_compiles(count: int, copies: int) -> dict[str, float]:
    """Seconds a first gradient takes beyond a warm one."""
    rings = round(np.sqrt(count / 3))
    return _beyond_warm(_slope(launched.one_colour(_lens(copies)), rings))


def _lens(copies: int) -> Lens:
    lens = launched.double_gauss()
    return lens if copies == 1 else launched.thrice(lens)


def _slope(lens: Lens, rings: int) -> Callable[[], Any]:
    def merit(curvature: jax.Array) -> jax.Array:
        return lenstrace.mean_square_spot(lens.replace(curvature=curvature), rings=rings).sum()

    slope, curvature = jax.value_and_grad(merit), jnp.asarray(lens.curvature)
    return lambda: jax.block_until_ready(slope(curvature))


def _beyond_warm(call: Callable[[], Any]) -> dict[str, float]:
    """Seconds of the first call beyond a warm one, seconds that XLA had of them, and for how many programs."""
    compiler, seconds = _compiler_seconds(), []
    for _ in range(4):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return {"all": seconds[0] - float(np.median(seconds[1:])), "xla": sum(compiler), "programs": len(compiler)}


def _compiler_seconds() -> list[float]:
    """A list that every program compiled from now on adds its seconds in XLA to."""
    seconds: list[float] = []

    def heard(event: str, duration: float, **_: Any) -> None:
        if event == XLA_COMPILED:
            seconds.append(duration)

    jax.monitoring.register_event_duration_secs_listener(heard)
    return seconds


def _megabytes(tree: Any) -> float:
    return sum(leaf.nbytes for leaf in jax.tree.leaves(tree)) / MB
