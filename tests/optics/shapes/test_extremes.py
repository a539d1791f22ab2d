"""Grazing and tangent rays, rays along axes and faces, zeros of either sign, thin shapes, and rays from far away."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from mpmath import mp
from numpy.testing import assert_allclose

from lenstrace.optics.shapes.box import Box
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.shapes.conic_cap import ConicCap
from lenstrace.optics.shapes.cylinder import Cylinder
from lenstrace.optics.shapes.implicit import Implicit
from lenstrace.optics.shapes.rectangle import Rectangle
from lenstrace.optics.shapes.sphere import Sphere
from lenstrace.optics.shapes.torus import Torus
from tests.optics.shapes.cases import ball, first_ahead, found

DTYPES = [jnp.float32, jnp.float64]


def made(shape: Any, dtype: Any = jnp.float64) -> Any:
    return jax.tree.map(lambda a: jnp.asarray(a, dtype), shape)


def crossings(shape: Any, point: Any, direction: Any) -> list[float]:
    """Of one ray, all of them in order."""
    distance, real = found(shape, np.array(point, float)[:, None], np.array(direction, float)[:, None])
    return sorted(distance[real].tolist())


def balls(dtype: Any) -> dict[str, Any]:
    """The unit sphere in three ways."""
    return {
        "sphere": made(Sphere(1.0), dtype),  # type: ignore[arg-type]
        "implicit": made(Implicit(1.5, 2.7, np.inf, (1.0,), ball), dtype),  # type: ignore[arg-type]
        "implicit, bent": made(Implicit(1.5, 2.7, 1.0, (1.0,), ball), dtype),  # type: ignore[arg-type]
    }


@pytest.mark.parametrize("name", balls(jnp.float64))
@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("height", [1e-2, 1e-4, 1e-6])
def test_a_grazed_ball_is_not_jumped_over(name: str, dtype: Any, height: float) -> None:
    """A ray at b = 1 - h, of the height as it is rounded: the chord is 2 sqrt(h (2 - h)), 0.02828 at h = 1e-4."""
    b = np.asarray(1 - height, dtype)
    half = float(mp.sqrt(1 - mp.mpf(float(b)) ** 2))
    eps = float(jnp.finfo(dtype).eps)
    for start in (-3.0, -1e3):
        turns = np.linspace(0, 2 * np.pi, 65)[:-1]
        point = np.stack([b * np.cos(turns), b * np.sin(turns), start + 0 * turns])
        r = np.hypot(*point[:2].astype(dtype).astype(float))
        t = first_ahead(*found(balls(dtype)[name], point, np.stack([0 * turns, 0 * turns, 1 + 0 * turns])))
        expected = -start - np.sqrt(1 - r * r)
        # what rounding b moves the end of the chord by
        assert_allclose(t, expected, rtol=0, atol=8 * eps / half + 2 * eps * abs(start))


@pytest.mark.parametrize("name", balls(jnp.float64))
@pytest.mark.parametrize("dtype", DTYPES)
def test_a_ray_that_passes_a_ball_does_not_meet_it(name: str, dtype: Any) -> None:
    shape = balls(dtype)[name]
    for b in (1 + 1e-2, 1 + 1e-4, 1 + 1e-6):
        for x, y in ((b, 0.0), (0.0, b), (0.6 * b, -0.8 * b)):
            assert crossings(shape, (x, y, -3), (0, 0, 1)) == []


def test_a_sphere_from_far_away_against_numbers_of_40_digits() -> None:
    """The crossing is that of a ray whose start is moved by a rounding: 1e6 radii away, 1e-10 of a radius."""
    generator = np.random.default_rng(1)
    shape = made(Sphere(1.0))  # type: ignore[arg-type]
    for away, tolerance in ((3.0, 4e-15), (1e3, 1e-12), (1e6, 1e-9)):
        for _ in range(20):
            point = generator.normal(size=3)
            point *= away / np.linalg.norm(point)
            way = generator.uniform(-0.5, 0.5, 3) - point
            way /= np.linalg.norm(way)
            with mp.workdps(40):
                p, d = [mp.mpf(float(a)) for a in point], [mp.mpf(float(a)) for a in way]
                a, b, c = mp.fdot(d, d), mp.fdot(p, d), mp.fdot(p, p) - 1
                root = mp.sqrt(b * b - a * c)
                expected = [float((-b - root) / a), float((-b + root) / a)]
            assert_allclose(crossings(shape, point, way), expected, rtol=0, atol=tolerance)


@pytest.mark.parametrize("zero", [0.0, -0.0])
@pytest.mark.parametrize("dtype", DTYPES)
def test_rays_along_faces_and_axes(zero: float, dtype: Any) -> None:
    box, rod = made(Box(1.0, 2.0, 3.0), dtype), made(Cylinder(1.0, 2.0), dtype)  # type: ignore[arg-type]
    assert crossings(box, (0.5, -5, 2.5), (zero, 1, zero)) == [3, 7]
    assert crossings(box, (0.5, 0, 0), (zero, zero, -1)) == [-3, 3]
    # in the plane of a face, and beside it
    for x in (1.0, -1.0, 1.001):
        assert crossings(box, (x, -5, 0), (zero, 1, zero)) == []
        assert crossings(rod, (x, 0, -5), (zero, zero, 1)) == []
    assert crossings(rod, (0, -5, 2), (zero, 1, zero)) == []
    assert crossings(rod, (0, 0, -5), (zero, zero, 1)) == [3, 7]
    assert crossings(rod, (0.6, 0.7, 5), (zero, zero, -1)) == [3, 7]
    assert crossings(rod, (0, -5, 1.9), (zero, 1, zero)) == [4, 6]
    sheet = made(Rectangle(np.inf, np.inf), dtype)  # type: ignore[arg-type]
    assert crossings(sheet, (0, 0, 1), (1, 0, zero)) == []
    assert crossings(sheet, (0, 0, 0), (1, 0, zero)) == []
    assert crossings(sheet, (0, 0, 1), (1, 0, -float(jnp.finfo(dtype).tiny) / 8)) == []
    ring = made(Torus(2.0, 0.5), dtype)  # type: ignore[arg-type]
    assert crossings(ring, (0, 0, 5), (zero, zero, -1)) == []
    assert crossings(ring, (1, 0, 5), (zero, zero, -1)) == []
    eps = float(jnp.finfo(dtype).eps)
    assert_allclose(crossings(ring, (2, 0, 5), (zero, zero, -1)), [4.5, 5.5], rtol=2 * eps)
    assert_allclose(crossings(ring, (-5, 0, 0), (1, zero, zero)), [2.5, 3.5, 6.5, 7.5], rtol=2 * eps)
    assert_allclose(crossings(ring, (zero, 5, 0), (zero, -1, zero)), [2.5, 3.5, 6.5, 7.5], rtol=2 * eps)


@pytest.mark.parametrize("dtype", DTYPES)
def test_nearly_parallel_to_an_axis(dtype: Any) -> None:
    rod, ring = made(Cylinder(1.0, 2.0), dtype), made(Torus(2.0, 0.5), dtype)  # type: ignore[arg-type]
    for slope in (1e-3, 1e-7, 1e-12, 1e-18, 1e-25, 1e-39):
        assert_allclose(crossings(rod, (0.3, 0, -5), (slope, 0, 1)), [3, 7], rtol=1e-5)
        assert_allclose(crossings(ring, (2, 0, -5), (slope, -slope, 1)), [4.5, 5.5], rtol=1e-4)


@pytest.mark.parametrize("dtype", DTYPES)
def test_thin_plates_and_rings_are_met_from_afar(dtype: Any) -> None:
    plate = made(Box(1.0, 1.0, 1e-9), dtype)  # type: ignore[arg-type]
    generator = np.random.default_rng(2)
    point = np.stack([*generator.uniform(-0.9, 0.9, (2, 1000)), np.full(1000, 1e3)])
    way = np.stack([*generator.uniform(-5e-5, 5e-5, (2, 1000)), np.full(1000, -1.0)])
    assert_allclose(first_ahead(*found(plate, point, way)), 1e3, rtol=1e-6)
    ring = made(Torus(1.0, 1e-3), dtype)  # type: ignore[arg-type]
    angle = generator.uniform(0, 2 * np.pi, 1000)
    point = np.stack([np.cos(angle), np.sin(angle), np.full(1000, 5.0)])
    t = first_ahead(*found(ring, point, np.stack([0 * angle, 0 * angle, -1 + 0 * angle])))
    assert_allclose(t, 4.999, atol=8 * float(jnp.finfo(dtype).eps))


def test_a_torus_touched_along_its_inner_and_outer_circles() -> None:
    """Across the hole at a height of the tube's top less 1e-4 the ray enters twice; above it never."""
    ring = made(Torus(2.0, 0.5))  # type: ignore[arg-type]
    z = 0.5 - 1e-4
    half = np.sqrt(0.25 - z * z)
    expected = [8 - half, 8 + half, 12 - half, 12 + half]
    assert_allclose(crossings(ring, (-10, 0, z), (1, 0, 0)), expected, atol=1e-13)
    assert crossings(ring, (-10, 0, 0.5 + 1e-9), (1, 0, 0)) == []
    # along the inner wall: through the tube on both sides of the place where it is touched, and once from just outside
    for y, count in ((1.5 - 1e-6, 4), (1.5 + 1e-6, 2), (2.5 - 1e-6, 2), (2.5 + 1e-6, 0)):
        assert len(crossings(ring, (-10, y, 0), (1, 0, 0))) == count


def test_a_plane_and_a_parabola_are_conics_like_others() -> None:
    flat, dish = made(ConicCap(Conic(0.0, 0.0), 2.0)), made(ConicCap(Conic(0.5, -1.0), 2.0))  # type: ignore[arg-type]
    assert crossings(flat, (1, 0, 5), (0, 0, -1)) == [5]
    assert crossings(flat, (3, 0, 5), (0, 0, -1)) == []
    assert_allclose(crossings(dish, (1, 0, 5), (0, 0, -1)), [4.75], rtol=1e-15)
    assert_allclose(crossings(dish, (-5, 0, 0.25), (1, 0, 0)), [4, 6], rtol=1e-15)
    # from the surface: along the axis nothing more, across it the other side
    place = np.array([[1.0, 0, 0.25]]).T
    for way, expected in (((0, 0, 1), np.inf), ((-1, 0, 0), 2.0), ((1, 0, 0), np.inf)):
        assert first_ahead(*found(dish, place, np.array([way], float).T, True))[0] == expected


def test_a_search_that_runs_out_of_steps_says_so() -> None:
    shape = balls(jnp.float64)["implicit"]
    rays = [tuple(map(jnp.asarray, a)) for a in ((1.0 + 1e-13, 0.0, -3.0), (0.0, 0.0, 1.0))]
    tangent = shape.search(*rays, jnp.asarray(False))
    assert not bool(tangent.real)
    assert not bool(tangent.decided)
    away = shape.search((rays[0][0] + 0.1, *rays[0][1:]), rays[1], jnp.asarray(False))
    assert not bool(away.real)
    assert bool(away.decided)
