"""Rays that start on a shape, from places as they are rounded: none meets its own shape again where it starts."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
import pytest

from tests.optics.shapes.cases import CASES, aimed, first_ahead, found, normals, shape_of, units

# A million has been run: LENSTRACE_SPAWNED_RAYS=1000000.
COUNT = int(os.environ.get("LENSTRACE_SPAWNED_RAYS", "16384"))
SLOW = ("bowl", "wing", "torus", "implicit ball", "peanut")
# Below this cosine the rounded place decides what a ray meets; above it the geometry does.
GRAZING = {jnp.float32: 0.02, jnp.float64: 1e-5}


class Start(NamedTuple):
    """Rounded places on a shape, directions evenly to both sides, the cosine with the normal there, and how far it is
    to what the shape says is met: inf for nothing."""

    place: np.ndarray
    ways: np.ndarray
    cosine: np.ndarray
    got: np.ndarray


def spawned(name: str, scale: float, dtype: Any) -> Start:
    """Rays that start on a shape."""
    shape = shape_of(name, scale, dtype)
    point, direction = aimed(11, 2 * COUNT if name not in SLOW else COUNT // 4)
    t = first_ahead(*found(shape, scale * point, direction))
    met = np.isfinite(t)
    place = (scale * point[:, met] + t[met] * direction[:, met]).astype(dtype)
    ways = units(12, met.sum()).astype(dtype)
    normal = normals(shape, place)
    cosine = (normal * ways).sum(0) / np.linalg.norm(normal, axis=0)
    return Start(place, ways, cosine, first_ahead(*found(shape, place, ways, True)))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("dtype", GRAZING)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e6])
def test_what_starts_on_a_shape_meets_what_any_ray_meets(name: str, dtype: Any, scale: float) -> None:
    start = spawned(name, scale, dtype)
    if CASES[name].convex:
        what_leaves_a_convex_shape_never_meets_it_again(name, dtype, start)
    what_is_met_is_what_any_ray_meets(name, dtype, scale, start)


def what_leaves_a_convex_shape_never_meets_it_again(name: str, dtype: Any, start: Start) -> None:
    ahead, cosine = np.isfinite(start.got), start.cosine
    solid = CASES[name].solid
    assert not ahead[(cosine > 0) | (not solid)].any()
    if solid:
        # an edge may be left at once; elsewhere what goes in comes out, at the other end of its way through
        inward = (cosine < 0) & (np.abs(cosine) > GRAZING[dtype])
        assert ahead[inward].mean() > (1 if name in ("sphere", "implicit ball") else 0.9999) - 1e-12


def what_is_met_is_what_any_ray_meets(name: str, dtype: Any, scale: float, start: Start) -> None:
    """Judged in float64 from the same rounded places, without the knowledge that they are on the shape."""
    place, ways, cosine, got = start
    steep = np.abs(cosine) > GRAZING[dtype]
    # a march has no bound of steps that begins on a surface, and does not know it: a ball is judged as a sphere
    exact = shape_of("sphere" if name == "implicit ball" else name, scale)
    # the crossing at the start is within the rounding of the place
    near = 32 * float(jnp.finfo(dtype).eps) * scale / np.abs(np.where(steep, cosine, 1))
    unit = ways.astype(float) / np.linalg.norm(ways.astype(float), axis=0)
    if name == "peanut":
        # only one crossing is found: the march begins well behind the start
        begin = near * 64
        expected = begin + first_ahead(*found(exact, place + begin * unit, unit))
    else:
        distance, real = found(exact, place.astype(float), unit)
        expected = first_ahead(distance, real & (distance > near))
    both = steep & np.isfinite(expected) & np.isfinite(got)
    assert both.any() or (CASES[name].convex and not CASES[name].solid)
    # an edge of a face or a rim, or a tangent: the rounded place decides
    assert (np.isfinite(got) != np.isfinite(expected))[steep].mean() <= 4e-4
    off = np.abs(got[both] - expected[both]) / scale
    grazes = 1e-3 if dtype == jnp.float32 else 1e-9
    assert (off > grazes).mean() <= 4e-4 if both.any() else True


@pytest.mark.parametrize("dtype", GRAZING)
@pytest.mark.parametrize("outward", [True, False])
def test_a_grazing_ray_on_a_sphere_goes_where_its_normal_says(dtype: Any, outward: bool) -> None:
    shape = shape_of("sphere", 1.0, dtype)
    place = (1.3 * units(13, 20000)).astype(dtype)
    across = np.cross(place, units(14, 20000), axis=0)
    across /= np.linalg.norm(across, axis=0)
    turn = 10.0 ** -np.random.default_rng(15).uniform(3, 12, 20000)
    ways = (across + (1 if outward else -1) * turn * place / 1.3).astype(dtype)
    cosine = (place.astype(float) * ways).sum(0)
    clear = np.abs(cosine) > 2 * float(jnp.finfo(dtype).eps)
    t = first_ahead(*found(shape, place, ways, True))
    assert clear.sum() > 4000
    assert (np.isfinite(t) == (not outward))[clear].all()
    if not outward:
        assert np.abs(t + 2 * cosine)[clear].max() < 4 * jnp.finfo(dtype).eps
