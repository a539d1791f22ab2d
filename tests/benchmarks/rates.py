"""Sections asphere and gradient: Newton's steps, and the mean square spot with its gradient, against C."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import lenstrace
from lenstrace import Lens
from lenstrace.sequential.sampling import pupil_points
from tests.benchmarks import launched, limit
from tests.benchmarks.launched import arrays, check, image, losses, per_ray_surface
from tests.benchmarks.paired import interleaved
from tests.benchmarks.table import Table

MILLION = 1_000_000
ROUNDS = 9
RINGS = 500  # the most that the library allows: 751,501 rays
AGREEMENT = 1e-9  # mm, of two tracers' mean image height for the same rays
SPOT_AGREEMENT = 1e-9  # relative, of two mean square spots; of their derivatives to the largest
UNIT = "ns / ray-surface"


def asphere() -> Table:
    """Two mild aspheres against the spherical lens, and against C."""
    spherical = launched.double_gauss()
    lens = launched.with_aspheres(spherical)
    rays = launched.filling(spherical, MILLION)
    calls: dict[str, Callable[[], Any]] = {"spherical": image(spherical, rays), "aspheric": image(lens, rays)}
    missing = limit.absent()
    if not missing:
        points, directions = arrays(rays)
        calls["C, spherical"] = limit.traced(spherical, (*points, *directions))
        calls["C, aspheric"] = limit.traced(lens, (*points, *directions))
        expected = float(jnp.mean(calls["aspheric"]().y))
        check("C, aspheric", float(np.mean(calls["C, aspheric"]()[1])), expected, AGREEMENT)
    seconds = interleaved(calls, ROUNDS)
    table = Table("asphere: the double Gauss with two aspheres, a million rays, float64", notes=missing)
    for name, values in seconds.items():
        table.time(name, values * per_ray_surface(spherical, rays), UNIT)
    table.compare("aspheric / spherical", seconds["aspheric"], seconds["spherical"], at_most=2.0)
    if not missing:
        table.compare("aspheric / C, aspheric", seconds["aspheric"], seconds["C, aspheric"], at_most=2.0)
    table.notes += losses(calls["aspheric"]())
    return table


def gradient() -> Table:
    """The mean square spot of one field and wavelength and its gradient by all curvatures."""
    lens = launched.one_colour(launched.double_gauss())
    rays = launched.filling(lens, 1 + 3 * RINGS * (RINGS + 1))

    def merit(curvature: jax.Array) -> jax.Array:
        return lenstrace.mean_square_spot(lens.replace(curvature=curvature), rings=RINGS).sum()

    slope = jax.value_and_grad(merit)
    curvature = jnp.asarray(lens.curvature)
    calls: dict[str, Callable[[], Any]] = {
        "trace": image(lens, rays),
        "value": lambda: jax.block_until_ready(merit(curvature)),
        "value and gradient": lambda: jax.block_until_ready(slope(curvature)),
    }
    missing = limit.absent()
    if not missing:
        points, directions = arrays(rays)
        calls["C, trace"] = limit.traced(lens, (*points, *directions))
        calls["C, value"], calls["C, value and gradient"] = _in_c(lens)
        _check_slopes(lens, calls["value and gradient"](), calls["C, value and gradient"]())
        value, found = calls["value"]().item(), calls["C, value"]()
        check("C, mean square spot", found / value, 1.0, SPOT_AGREEMENT)
    seconds = interleaved(calls, ROUNDS)
    table = Table(f"gradient: mean square spot by {lens.curvature.size} curvatures, {rays.x.size:,} rays, float64")
    for name, values in seconds.items():
        table.time(name, values * per_ray_surface(lens, rays), UNIT)
    ours = seconds["value and gradient"]
    table.compare("value and gradient / trace", ours, seconds["trace"], at_most=8.0)
    table.compare("value / trace", seconds["value"], seconds["trace"])
    if not missing:
        table.compare("value and gradient / C", ours, seconds["C, value and gradient"], at_most=2.5)
        table.compare("value / C", seconds["value"], seconds["C, value"])
        table.compare("C, value / C, trace", seconds["C, value"], seconds["C, trace"])
        table.notes.append(
            "C, value: one pass of sums; with the gradient a second one, there and back, about the centroid"
        )
    table.notes += ["value: one pass of moments; no ray is written", *missing]
    table.notes.append("peak memory of the gradient: section memory")
    return table


def _in_c(lens: Lens) -> tuple[Callable[[], float], Callable[[], tuple[float, np.ndarray]]]:
    """Calls for the mean square spot, and for it with its derivatives by the curvatures and by the shift at launch."""
    limited = limit.limit(lens, "float64")
    pupil = [np.array(a) for a in pupil_points("hexapolar", RINGS)[:2]]
    count = pupil[0].size
    entrance, angle = lenstrace.overview(lens).entrance_pupil, np.deg2rad(launched.FIELD)
    shift = -float(entrance.position) * np.tan(angle)
    field = np.array([float(entrance.diameter) / 2, shift, np.sin(angle), np.cos(angle)])
    near = limited.sums([a[:64].copy() for a in pupil], field, np.zeros(2))[:2] / 64  # so that no digits are lost

    def centred() -> tuple[np.ndarray, float]:
        sums = limited.sums(pupil, field, near) / count
        return near + sums[:2], float(sums[2] - sums[0] ** 2 - sums[1] ** 2)

    def slopes() -> tuple[float, np.ndarray]:
        found = limited.slopes(pupil, field, centred()[0]) / count
        return float(found[0]), found[1:]

    return lambda: centred()[1], slopes


def _check_slopes(lens: Lens, ours: tuple[Any, Any], in_c: tuple[float, np.ndarray]) -> None:
    """The shift of the rays at launch follows the entrance pupil, and with it the curvatures."""

    def shift(curvature: Any) -> Any:
        place = lenstrace.overview(lens.replace(curvature=curvature)).entrance_pupil.position
        return -place * np.tan(np.deg2rad(launched.FIELD))

    moves = np.asarray(jax.grad(shift)(jnp.asarray(lens.curvature)))
    expected, found = np.asarray(ours[1]), in_c[1][:-1] + moves * in_c[1][-1]
    check("C, value", in_c[0] / float(ours[0]), 1.0, SPOT_AGREEMENT)
    check(
        "C, gradient",
        float(np.abs(found / np.abs(expected).max() - expected / np.abs(expected).max()).max()),
        0.0,
        SPOT_AGREEMENT,
    )
