"""Section forward: the whole call from launch arrays to the image, against C and against the other tracers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace import Lens, Ray
from tests.benchmarks import launched, limit, peers, yardstick
from tests.benchmarks.launched import arrays, check, image, losses, per_ray_surface, rounded
from tests.benchmarks.paired import interleaved
from tests.benchmarks.table import Table

MILLION = 1_000_000
ROUNDS = {10_000: 41, 100_000: 15, MILLION: 7}
RAYOPTICS_RAYS = 200  # it traces ray by ray
AGREEMENT = {"float64": 1e-9, "float32": 1e-4}  # mm, of two tracers' mean image height for the same rays
UNIT = "ns / ray-surface"
# Targets, of a million rays.
TO_LIMIT = 1.4  # times C
TO_KERNEL = 1.5  # times the bare kernel
LEAST = {"batoid": 12.0, "Optiland numpy": 30.0}  # times the trace


def forward() -> Table:
    """Every tracer on the same lens, rays and outputs; 1e4, 1e5 and 1e6 rays."""
    lens = launched.double_gauss()
    table = Table("forward: double Gauss, 11 surfaces, rays of the 10 degree field, launch arrays to image")
    for count, rounds in ROUNDS.items():
        rays = launched.filling(lens, count)
        _forward(table, lens, rays, "float64", rounds)
        _forward(table, lens.astype("float32"), rounded(rays), "float32", rounds)
    table.notes += [
        "C: trace.c, its results into memory that it keeps; C, new memory: as a caller who keeps results needs",
        "the bare kernel always carries the optical path and knows neither conics nor failures",
        f"rayoptics traces ray by ray: its rate is that of {RAYOPTICS_RAYS} rays, extrapolated",
        *limit.absent(),
        *peers.absent("batoid", "optiland", "torch", "rayoptics"),
    ]
    return table


def _forward(table: Table, lens: Lens, rays: Ray, precision: str, rounds: int) -> None:
    """Lines of one precision and number of rays."""
    count = rays.x.size
    calls: dict[str, Callable[[], Any]] = {"trace": image(lens, rays), "trace, opl": image(lens, rays, opl=True)}
    table.notes += losses(calls["trace"]())
    share = dict.fromkeys(calls, 1.0)
    for name, call, mean_height, part in _others(lens, rays, precision, rounds):
        expected = float(jnp.mean(calls["trace"]().y[: round(part * count)], dtype=float))
        check(f"{name}, {precision}", mean_height(call()), expected, AGREEMENT[precision])
        calls[name], share[name] = call, part
    seconds = interleaved(calls, rounds)
    per = {name: values * per_ray_surface(lens, rays) / share[name] for name, values in seconds.items()}
    many = count == MILLION
    head = f"{count:.0e} {precision}".replace("e+0", "e")
    for name, values in per.items():
        table.time(f"{head}: {name}", values, UNIT)
    if "C" in per:
        table.compare(f"{head}: trace / C", per["trace"], per["C"], at_most=TO_LIMIT if many else None)
        table.compare(f"{head}: trace / C, new memory", per["trace"], per["C, new memory"])
        table.compare(f"{head}: bare kernel / C", per["bare kernel"], per["C"])
    table.compare(f"{head}: trace / bare kernel", per["trace"], per["bare kernel"], at_most=TO_KERNEL if many else None)
    for name, values in per.items():
        if name not in {"trace", "trace, opl", "C", "C, new memory", "bare kernel"}:
            table.compare(f"{head}: {name} / trace", values, per["trace"], at_least=LEAST.get(name) if many else None)


def _others(lens: Lens, rays: Ray, precision: str, rounds: int) -> list[tuple[str, Any, Any, float]]:
    """Name, call, what finds the mean image height in its result, and the share of the rays that it traces."""
    points, directions = arrays(rays)
    count = rays.x.size
    found: list[tuple[str, Any, Any, float]] = []
    if not limit.absent():
        for name, fresh in (("C", False), ("C, new memory", True)):
            call = limit.traced(lens, (*points, *directions), fresh=fresh)
            found.append((name, call, lambda result: _mean(result[1]), 1.0))
    # the last rays of its last chunk are repeated ones
    kernel = yardstick.traced(lens, rays, precision)
    found.append(
        (
            "bare kernel",
            kernel,
            lambda parts: _mean(np.concatenate([np.asarray(part[1]) for part in parts])[:count]),
            1.0,
        )
    )
    if not peers.absent("optiland", "torch"):
        torch = peers.optiland_traced(
            peers.optiland_double_gauss("torch", precision), points, directions, "torch", precision
        )
        found.append(("Optiland torch", torch, lambda result: _mean(result.y.numpy()), 1.0))
    if precision == "float32":
        return found
    if not peers.absent("optiland"):
        call = peers.optiland_traced(peers.optiland_double_gauss(), points, directions)
        found.append(("Optiland numpy", call, lambda result: _mean(result.y), 1.0))
    if not peers.absent("batoid"):
        optic = peers.batoid_double_gauss()
        # it traces in place: a copy for every call, made beforehand
        copies = [peers.batoid_rays(points, directions) for _ in range(rounds + 2)]
        found.append(("batoid", lambda: optic.trace(copies.pop()), lambda result: _mean(result.y), 1.0))
    if not peers.absent("rayoptics"):
        few = tuple(tuple(a[:RAYOPTICS_RAYS] for a in numbers) for numbers in (points, directions))
        call = peers.rayoptics_traced(peers.rayoptics_double_gauss(), *few)
        found.append(("rayoptics", call, lambda result: _mean(result[:, 1]), RAYOPTICS_RAYS / count))
    return found


def _mean(heights: Any) -> float:
    return float(np.mean(np.asarray(jax.device_get(heights)), dtype=float))
