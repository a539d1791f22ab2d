"""Sections forward, asphere and gradient: a million rays, and what each costs at each surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import lenstrace
from lenstrace import Lens, Ray
from tests.benchmarks import launched, peers, yardstick
from tests.benchmarks.paired import interleaved
from tests.benchmarks.table import Table

MILLION = 1_000_000
OPTILAND_RAYS = 100_000  # its rate is that of a million
ROUNDS = 9
RINGS = 500  # the most that the library allows: 751,501 rays
AGREEMENT = 1e-9  # mm, of two tracers' mean image height for the same rays
UNIT = "ns / ray-surface"


def forward() -> Table:
    """The whole call from launch arrays to the image, against the bare kernel, batoid and Optiland."""
    lens = launched.double_gauss()
    rays = launched.filling(lens, MILLION)
    table = Table("forward: double Gauss, 11 surfaces, a million rays of the 10 degree field, launch arrays to image")
    _forward(table, lens, rays, "float64", peers.absent("batoid", "optiland"))
    _forward(table, lens.astype("float32"), _rounded(rays), "float32", ["batoid", "optiland"])
    table.notes.append("the bare kernel always carries the optical path and knows neither conics nor failures")
    return table


def asphere() -> Table:
    """Two mild aspheres, conic + r^4, r^6, r^8, against the spherical lens."""
    spherical = launched.double_gauss()
    lens = spherical.replace(surface=2, conic=0.3, asphere={4: 1e-7, 6: -2e-10, 8: 1e-13})
    lens = lens.replace(surface=9, conic=-0.2, asphere={4: -2e-7, 6: 1e-10, 8: 1e-13})
    rays = launched.filling(spherical, MILLION)
    calls = {"spherical": _image(spherical, rays), "aspheric": _image(lens, rays)}
    seconds = interleaved(calls, ROUNDS)
    table = Table("asphere: the double Gauss with two aspheres, a million rays, float64")
    for name, values in seconds.items():
        table.time(name, values * _per_ray_surface(spherical, rays), UNIT)
    table.compare("aspheric / spherical", seconds["aspheric"], seconds["spherical"], at_most=2.0)
    table.notes += _losses(calls["aspheric"]())
    return table


def gradient() -> Table:
    """The mean square spot of one field and wavelength and its gradient by all curvatures."""
    lens = launched.one_colour(launched.double_gauss())
    rays = launched.filling(lens, 1 + 3 * RINGS * (RINGS + 1))

    def merit(curvature: jax.Array) -> jax.Array:
        return lenstrace.mean_square_spot(lens.replace(curvature=curvature), rings=RINGS).sum()

    slope = jax.value_and_grad(merit)
    curvature = jnp.asarray(lens.curvature)
    calls = {
        "trace": _image(lens, rays),
        "value": lambda: jax.block_until_ready(merit(curvature)),
        "value and gradient": lambda: jax.block_until_ready(slope(curvature)),
    }
    seconds = interleaved(calls, ROUNDS)
    table = Table(f"gradient: mean square spot by {lens.curvature.size} curvatures, {rays.x.size:,} rays, float64")
    for name, values in seconds.items():
        table.time(name, values * _per_ray_surface(lens, rays), UNIT)
    table.compare("value and gradient / trace", seconds["value and gradient"], seconds["trace"], at_most=8.0)
    table.notes.append("peak memory of the gradient: section memory")
    return table


def _forward(table: Table, lens: Lens, rays: Ray, precision: str, left_out: list[str]) -> None:
    """Lines of one precision; `left_out` are the peers without it, or lines that say that they are not installed."""
    scale = {name: _per_ray_surface(lens, rays) for name in ("kernel", "trace", "trace, opl")}
    kernel = yardstick.traced(lens, rays, precision)
    calls = {"kernel": kernel, "trace": _image(lens, rays), "trace, opl": _image(lens, rays, opl=True)}
    table.notes += _losses(calls["trace"]())
    expected = float(jnp.mean(_image(lens, rays)().y))
    found = np.concatenate([part[1] for part in kernel()])[: rays.x.size]  # its last rays are repeated ones
    _check(
        "the bare kernel", float(np.mean(found, dtype=float)), expected, 1e-4 if precision == "float32" else AGREEMENT
    )
    points, directions = _arrays(rays)
    if not any(line.startswith("batoid") for line in left_out):
        optic = peers.batoid_double_gauss()
        # it traces in place: a copy for every call, made beforehand
        copies = [peers.batoid_rays(points, directions) for _ in range(ROUNDS + 2)]
        _check("batoid", float(np.mean(optic.trace(copies.pop()).y)), expected, AGREEMENT)
        calls["batoid"] = lambda: optic.trace(copies.pop())
        scale["batoid"] = scale["trace"]
    if not any(line.startswith("optiland") for line in left_out):
        some = tuple(tuple(a[:OPTILAND_RAYS] for a in arrays) for arrays in (points, directions))
        calls["Optiland"] = peers.optiland_traced(peers.optiland_double_gauss(), *some)
        same = float(jnp.mean(_image(lens, jax.tree.map(lambda a: a[:OPTILAND_RAYS], rays))().y))
        _check("Optiland", float(np.mean(calls["Optiland"]().y)), same, AGREEMENT)
        scale["Optiland"] = scale["trace"] * rays.x.size / OPTILAND_RAYS
    seconds = interleaved(calls, ROUNDS)
    per = {name: values * scale[name] for name, values in seconds.items()}
    for name, values in per.items():
        table.time(f"{precision}: {name}", values, UNIT)
    for name in ("trace", "trace, opl"):
        table.compare(f"{precision}: {name} / kernel", per[name], per["kernel"], at_most=1.5)
        for peer, least in (("batoid", 12.0), ("Optiland", 30.0)):
            if peer in per:
                table.compare(f"{precision}: {peer} / {name}", per[peer], per[name], at_least=least)
    for peer in ("batoid", "Optiland"):
        if peer in per:
            table.compare(f"{precision}: {peer} / kernel", per[peer], per["kernel"])
            table.notes.append(f"{peer} / kernel: what a trace as quick as the bare kernel would reach on this machine")
    table.notes += [line for line in left_out if "not installed" in line]


def _image(lens: Lens, rays: Ray, *, opl: bool = False) -> Callable[[], Ray]:
    return lambda: jax.block_until_ready(lenstrace.trace(lens, rays, path=False, opl=opl))


def _rounded(rays: Ray) -> Ray:
    """In float32 from the start, so that no call has to convert them."""
    return jax.tree.map(lambda a: a.astype(np.float32) if a.dtype == np.float64 else a, rays)


def _per_ray_surface(lens: Lens, rays: Ray) -> float:
    """Nanoseconds per ray and surface for a second per call."""
    return 1e9 / rays.x.size / len(lens)


def _arrays(rays: Ray) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
    """Points and directions."""
    x, y, z, l, m, n = (np.asarray(a) for a in (rays.x, rays.y, rays.z, rays.l, rays.m, rays.n))
    return (x, y, z), (l, m, n)


def _check(who: str, height: float, expected: float, tolerance: float) -> None:
    """Stop where another tracer's mean image height differs: then another thing would be timed."""
    if not abs(height - expected) <= tolerance:
        raise SystemExit(
            f"{who}: mean image height {height!r} mm, lenstrace {expected!r} mm: not the same lens or rays"
        )


def _losses(image: Any) -> list[str]:
    lost = int(jnp.sum(image.failure != 0))
    return [f"{lost:,} rays of {image.x.size:,} fail"] if lost else []
