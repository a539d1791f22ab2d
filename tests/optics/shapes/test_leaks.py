"""No ray goes through a closed surface of triangles, least of all through its edges and corners."""

from __future__ import annotations

import os
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lenstrace.compute.blocks import each
from lenstrace.optics.shapes.triangle import Triangle

# Ten million have been run: LENSTRACE_EDGE_RAYS=10000000.
COUNT = int(os.environ.get("LENSTRACE_EDGE_RAYS", "200000"))


def icosahedron() -> tuple[np.ndarray, np.ndarray]:
    """Corners (12, 3) and triangles (20, 3), outward."""
    g = (1 + 5**0.5) / 2
    corners = np.array([[s, t * g, 0] for s in (-1, 1) for t in (-1, 1)])
    corners = np.concatenate([np.roll(corners, i, 1) for i in range(3)])
    faces = []
    for i in range(12):
        for j in range(i):
            for k in range(j):
                p, q, r = corners[[i, j, k]]
                if all(abs(np.linalg.norm(a - b) - 2) < 1e-9 for a, b in ((p, q), (q, r), (r, p))):
                    faces.append((i, j, k) if np.linalg.det([p, q, r]) > 0 else (i, k, j))
    return corners / np.linalg.norm(corners[0]), np.array(faces)


def icosphere() -> tuple[np.ndarray, np.ndarray]:
    """Its triangles cut into four each: corners (42, 3) and triangles (80, 3)."""
    corners, faces = icosahedron()
    new, cut = list(corners), []
    middles: dict[tuple[int, int], int] = {}
    for face in faces:
        between = []
        for a, b in zip(face, np.roll(face, -1), strict=True):
            edge = (min(a, b), max(a, b))
            if edge not in middles:
                middles[edge] = len(new)
                middle = corners[a] + corners[b]
                new.append(middle / np.linalg.norm(middle))
            between.append(middles[edge])
        (a, b, c), (ab, bc, ca) = face, between
        cut += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.array(new), np.array(cut)


def triangles(corners: np.ndarray, faces: np.ndarray) -> Triangle:
    """All of them, stacked, in float32."""
    a, b, c = (tuple(jnp.asarray(corners[faces[:, i], j], jnp.float32) for j in range(3)) for i in range(3))
    return Triangle(a, b, c)  # type: ignore[arg-type]


def hits(shapes: Triangle, rays: Any) -> jax.Array:
    """How many triangles each ray meets ahead."""
    point, direction = rays[:3], rays[3:]
    off = jnp.zeros(point[0].shape, bool)

    def add(count: jax.Array, shape: Triangle) -> tuple[jax.Array, None]:
        ((t, real),) = shape.roots(point, direction, off)
        return count + (real & (t > 0)).astype(jnp.int32), None

    return jax.lax.scan(add, jnp.zeros(point[0].shape, jnp.int32), shapes)[0]


def at_edges(generator: np.random.Generator, corners: np.ndarray, faces: np.ndarray, count: int) -> np.ndarray:
    """Places on edges, a fifth of them corners, (N, 3)."""
    face = faces[generator.integers(0, len(faces), count)]
    side = generator.integers(0, 3, count)
    a, b = corners[face[np.arange(count), side]], corners[face[np.arange(count), (side + 1) % 3]]
    part = np.where(generator.uniform(size=count) < 0.2, 0, generator.uniform(size=count))[:, None]
    return a + part * (b - a)


def rays_to(target: np.ndarray, start: np.ndarray) -> tuple[jax.Array, ...]:
    way = target - start
    way /= np.linalg.norm(way, axis=1)[:, None]
    return tuple(jnp.asarray(np.float32(a)) for a in (*start.T, *way.T))


@pytest.mark.parametrize("shift", [0.0, 100.0])
def test_no_ray_from_inside_leaves_a_closed_surface(shift: float) -> None:
    corners, faces = icosphere()
    generator = np.random.default_rng(1)
    shapes = triangles(corners + shift, faces)
    for _ in range(-(-COUNT // 1_000_000)):
        count = min(COUNT, 1_000_000)
        start = generator.uniform(-0.4, 0.4, (count, 3))
        # along an axis, in a plane of symmetry, and anywhere
        start[: count // 8] = 0
        start[count // 8 : count // 4, 0] = 0
        target = at_edges(generator, corners, faces, count)
        met = np.asarray(each(hits, shapes, rays_to(target + shift, start + shift)))
        assert (met >= 1).all(), f"{(met == 0).sum()} of {count} leak"


def test_no_ray_goes_through_the_diagonals_of_a_square() -> None:
    """A square of two triangles, and one of four around its middle; rays down the axis among them."""
    generator = np.random.default_rng(2)
    square = np.array([[-1.0, -1, 0.3], [1, -1, 0.3], [1, 1, 0.3], [-1, 1, 0.3], [0.1, -0.2, 0.3]])
    for faces, inner in (([(0, 1, 2), (0, 2, 3)], (0, 2)), ([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], (0, 4))):
        part = generator.uniform(1e-3, 1 - 1e-3, (COUNT // 2, 1))
        target = square[inner[0]] + part * (square[inner[1]] - square[inner[0]])
        start = np.concatenate([generator.normal(size=(COUNT // 2, 2)), np.full((COUNT // 2, 1), 3.0)], 1)
        start[::3, :2] = target[::3, :2]
        met = np.asarray(each(hits, triangles(square, np.array(faces)), rays_to(target, start)))
        assert (met >= 1).all()


def test_the_count_of_crossings_of_a_closed_surface_is_even_from_outside() -> None:
    corners, faces = icosphere()
    generator = np.random.default_rng(3)
    start = 3 * generator.normal(size=(COUNT // 2, 3))
    start = start[np.linalg.norm(start, axis=1) > 1.1]
    met = np.asarray(each(hits, triangles(corners, faces), rays_to(generator.uniform(-1, 1, start.shape), start)))
    assert (met % 2 == 0).all()


def test_a_triangle_seen_along_its_plane_is_not_met() -> None:
    one = Triangle(*(tuple(map(jnp.float32, p)) for p in ((0.1, 0.2, 0), (1.3, 0.1, 0), (0.4, 1.7, 0))))  # type: ignore[arg-type]
    angle = np.linspace(0, 2 * np.pi, 1001)
    zero = np.zeros_like(angle)
    way = tuple(jnp.asarray(np.float32(a)) for a in (np.cos(angle), np.sin(angle), zero))
    start = tuple(jnp.asarray(np.float32(0.5 - 3 * np.asarray(a))) for a in way[:2])
    ((_, real),) = one.roots((*start, jnp.asarray(np.float32(zero))), way, jnp.zeros(1001, bool))  # type: ignore[arg-type]
    assert not real.any()
