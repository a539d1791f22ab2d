"""Section required: what each thing costs that a scene may or may not require, on top of the plainest question."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp

import lenstrace
from lenstrace import Lens
from tests.benchmarks import launched
from tests.benchmarks.launched import image, losses, per_ray_surface
from tests.benchmarks.paired import interleaved
from tests.benchmarks.table import Table

MILLION = 1_000_000
ROUNDS = 7
RINGS = 300  # 270,901 rays
WIDE = 40.0  # mm, the radius of an aperture that stops no ray
TURN = 1e-3  # degrees
UNIT = "ns / ray-surface"


def required() -> Table:
    """A million rays through the double Gauss, launch arrays to image, in float64; and the mean square spot."""
    plain = launched.double_gauss()
    rays = launched.filling(plain, MILLION)
    tilted = plain.replace(surface=7, tilt=(TURN, 0.0, 0.0))
    waves = plain.wavelengths.um
    calls: dict[str, Callable[[], Any]] = {
        "plain": image(plain, rays),
        "two aspheres": image(launched.with_aspheres(plain), rays),
        "a tilt on one surface": image(tilted, rays),
        "apertures on all surfaces": image(_with_apertures(plain), rays),
        "optical path": image(plain, rays, opl=True),
        "three wavelengths": lambda: jax.block_until_ready(
            [lenstrace.trace(plain, rays, wavelength=um, path=False, opl=False) for um in waves]
        ),
        "record of all surfaces": lambda: jax.block_until_ready(lenstrace.trace(plain, rays, opl=False)),
    }
    table = Table(
        "required: a million rays, launch arrays to image, float64: each thing's cost on top of the plain one"
    )
    for name in ("two aspheres", "a tilt on one surface", "apertures on all surfaces"):
        table.notes += losses(calls[name]())
    _compare(table, calls, "plain", per_ray_surface(plain, rays))
    one = launched.one_colour(plain)
    per = 1e9 / (1 + 3 * RINGS * (RINGS + 1)) / len(plain)
    _compare(table, _spots(one, plain), "spot, plain", per)
    table.notes.append("spot: the mean square spot of the 10 degree field; its gradient by all curvatures")
    return table


def _compare(table: Table, calls: dict[str, Callable[[], Any]], plain: str, scale: float) -> None:
    seconds = interleaved(calls, ROUNDS)
    for name, values in seconds.items():
        table.time(name, values * scale, UNIT)
    for name, values in seconds.items():
        if name != plain:
            table.compare(f"{name} / {plain}", values, seconds[plain])


def _spots(lens: Lens, polychromatic: Lens) -> dict[str, Callable[[], Any]]:
    """Values, and a gradient, of the mean square spot of one field."""
    many = polychromatic.replace(fields=lens.fields)
    curvature = jnp.asarray(lens.curvature)

    def merit(curvature: jax.Array) -> jax.Array:
        return lenstrace.mean_square_spot(lens.replace(curvature=curvature), rings=RINGS).sum()

    slope = jax.value_and_grad(merit)

    def value(lens: Lens) -> Callable[[], Any]:
        return lambda: jax.block_until_ready(lenstrace.mean_square_spot(lens, rings=RINGS))

    return {
        "spot, plain": value(lens),
        "spot, two aspheres": value(launched.with_aspheres(lens)),
        "spot, apertures on all surfaces": value(_with_apertures(lens)),
        "spot, three wavelengths": value(many),
        "spot, gradient": lambda: jax.block_until_ready(slope(curvature)),
    }


def _with_apertures(lens: Lens) -> Lens:
    """A circle on every surface, wide enough for all rays."""
    return lens.replace(rows=tuple(row.replace(aperture={"circle": WIDE}) for row in lens.rows))
