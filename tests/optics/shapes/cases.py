"""Every shape of a scene at any scale and precision, and a judge that knows only its equation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.asphere_cap import AsphereCap
from lenstrace.optics.shapes.box import Box
from lenstrace.optics.shapes.conic import Conic
from lenstrace.optics.shapes.conic_cap import ConicCap
from lenstrace.optics.shapes.cylinder import Cylinder
from lenstrace.optics.shapes.disk import Disk
from lenstrace.optics.shapes.implicit import Implicit
from lenstrace.optics.shapes.rectangle import Rectangle
from lenstrace.optics.shapes.shape import Roots, Shape
from lenstrace.optics.shapes.sphere import Sphere
from lenstrace.optics.shapes.torus import Torus
from lenstrace.optics.shapes.triangle import Triangle

FARTHEST = 8.0  # a judge looks for crossings so far along a ray


class Case(NamedTuple):
    """A shape about as large as 1.

    build:     the shape at a scale, of Python's numbers.
    equation:  F, zero on the surface, of numpy arrays.
    part:      where the surface of F = 0 belongs to the shape.
    solid:     whether it has an inside; convex: whether it is the rim of a convex solid, or flat.
    one:       whether only the first crossing ahead is asked for.
    """

    build: Callable[[float], Any]
    equation: Callable[..., np.ndarray]
    part: Callable[..., np.ndarray] = lambda x, _y, _z: np.isfinite(x)
    solid: bool = False
    convex: bool = False
    one: bool = False


def conic_sag(c: float, k: float, r2: np.ndarray) -> np.ndarray:
    return c * r2 / (1 + np.sqrt(np.maximum(1 - (1 + k) * c * c * r2, 0)))


def within(s: float) -> Callable[..., np.ndarray]:
    return lambda x, y, _: x * x + y * y <= s * s


def ball(x: jax.Array, y: jax.Array, z: jax.Array, radius: jax.Array) -> jax.Array:
    return (x * x + y * y + z * z - radius * radius) / (2 * radius)


def peanut(x: jax.Array, y: jax.Array, z: jax.Array, size: jax.Array) -> jax.Array:
    """Points whose distances from two foci have a product of 1.05: an oval of Cassini, turned about x."""
    a, b = (jnp.sqrt((x + s * size) ** 2 + y * y + z * z + 1e-3 * size * size) for s in (1, -1))
    return jnp.sqrt(a * b) - 1.05 * size


def peanut_equation(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    return ((x + 1) ** 2 + y * y + z * z + 1e-3) * ((x - 1) ** 2 + y * y + z * z + 1e-3) - 1.05**4


A, B, C = (0.9, -0.8, 0.3), (0.2, 1.1, -0.6), (-1.0, -0.4, 0.5)
N = np.cross(np.subtract(B, A), np.subtract(C, A))


def in_triangle(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    p = np.stack([x, y, z], -1)
    sides = [np.cross(np.subtract(b, a), p - a) @ N for a, b in ((A, B), (B, C), (C, A))]
    return np.min(sides, 0) >= 0


def bowl(s: float) -> AsphereCap:
    return AsphereCap(Asphere(0.3 / s, -0.5, np.array([0.05, -0.02]), s, (4, 6)), 1.2 * s)  # type: ignore[arg-type]


def wing(s: float) -> AsphereCap:
    return AsphereCap(Asphere(0.0, 0.0, np.array([-0.5, 0.2]), 1.0 * s, (2, 4)), 1.5 * s)  # type: ignore[arg-type]


CASES = {
    "sphere": Case(lambda s: Sphere(1.3 * s), lambda x, y, z: x * x + y * y + z * z - 1.69, solid=True, convex=True),
    "plane": Case(lambda _: Rectangle(np.inf, np.inf), lambda _x, _y, z: z, convex=True),
    "rectangle": Case(
        lambda s: Rectangle(1.5 * s, 0.7 * s),
        lambda _x, _y, z: z,
        lambda x, y, _: (abs(x) <= 1.5) & (abs(y) <= 0.7),
        convex=True,
    ),
    "disk": Case(
        lambda s: Disk(1.4 * s, 0.4 * s),
        lambda _x, _y, z: z,
        lambda x, y, _: (np.hypot(x, y) <= 1.4) & (np.hypot(x, y) >= 0.4),
        convex=True,
    ),
    "triangle": Case(
        lambda s: Triangle(*(tuple(s * p for p in q) for q in (A, B, C))),  # type: ignore[arg-type]
        lambda x, y, z: (x - A[0]) * N[0] + (y - A[1]) * N[1] + (z - A[2]) * N[2],
        in_triangle,
        convex=True,
    ),
    "box": Case(
        lambda s: Box(1.2 * s, 0.5 * s, 0.9 * s),
        lambda x, y, z: np.max([abs(x) - 1.2, abs(y) - 0.5, abs(z) - 0.9], 0),
        solid=True,
        convex=True,
    ),
    "cylinder": Case(
        lambda s: Cylinder(0.8 * s, 1.1 * s),
        lambda x, y, z: np.maximum(np.hypot(x, y) - 0.8, abs(z) - 1.1),
        solid=True,
        convex=True,
    ),
    "torus": Case(
        lambda s: Torus(1.1 * s, 0.4 * s), lambda x, y, z: (np.hypot(x, y) - 1.1) ** 2 + z * z - 0.16, solid=True
    ),
    "dome": Case(
        lambda s: ConicCap(Conic(0.6 / s, 0.0), 1.4 * s),
        lambda x, y, z: z - 0.3 * (x * x + y * y + z * z),
        lambda x, y, z: within(1.4)(x, y, z) & (z < 1 / 0.6),
    ),
    "dish": Case(
        lambda s: ConicCap(Conic(-0.8 / s, -1.0), 1.5 * s), lambda x, y, z: z + 0.4 * (x * x + y * y), within(1.5)
    ),
    "hyperbola": Case(
        lambda s: ConicCap(Conic(1.0 / s, -3.0), 1.3 * s),
        lambda x, y, z: z - 0.5 * (x * x + y * y - 2 * z * z),
        lambda x, y, z: within(1.3)(x, y, z) & (z > -0.5),
    ),
    "flat cap": Case(lambda s: ConicCap(Conic(0.0, 0.0), 1.5 * s), lambda _x, _y, z: z, within(1.5), convex=True),
    "bowl": Case(
        bowl,
        lambda x, y, z: z - conic_sag(0.3, -0.5, q := x * x + y * y) - 0.05 * q**2 + 0.02 * q**3,
        within(1.2),
    ),
    "wing": Case(wing, lambda x, y, z: z + 0.5 * (q := x * x + y * y) - 0.2 * q**2, within(1.5)),
    "implicit ball": Case(
        lambda s: Implicit(1.5 * s, 2.0, np.inf, (1.3 * s,), ball),  # type: ignore[arg-type]
        lambda x, y, z: x * x + y * y + z * z - 1.69,
        solid=True,
        convex=True,
        one=True,
    ),
    "peanut": Case(
        lambda s: Implicit(1.6 * s, 2.0, 20.0 / s, (1.0 * s,), peanut),  # type: ignore[arg-type]
        peanut_equation,
        solid=True,
        one=True,
    ),
}


def shape_of(name: str, scale: float = 1.0, dtype: Any = jnp.float64) -> Shape:
    """The shape, of arrays of one type."""
    return jax.tree.map(lambda a: jnp.asarray(a, dtype), CASES[name].build(scale))


@jax.jit
def roots_of(shape: Shape, point: Any, direction: Any, on: Any) -> Roots:
    """All candidates."""
    return shape.roots(point, direction, on)


@jax.jit
def _normal(shape: Shape, place: Any) -> Any:
    return shape.normal(place)


@jax.jit
def _value_normal_and_gradient(shape: Shape, place: Any) -> Any:
    return shape.value(place), shape.normal(place), jax.vmap(jax.grad(shape.value))(place)


def padding(count: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """What is added to arrays (3, N): few sizes, so that few programs are compiled."""
    return (0, 0), (0, (4096 if count <= 4096 else max(32768, 1 << (count - 1).bit_length())) - count)


def found(shape: Shape, point: Any, direction: Any, on: Any = False) -> tuple[np.ndarray, np.ndarray]:
    """Distances and masks of all candidates, (candidates, N), of arrays (3, N)."""
    dtype = jax.tree.leaves(shape)[0].dtype
    point, direction = np.asarray(point, dtype), np.asarray(direction, dtype)
    count = point.shape[1]
    more = padding(count)
    rays = (tuple(np.pad(a, more, "edge")) for a in (point, direction))
    starts_on = np.pad(np.broadcast_to(on, count), more[1], "edge")
    found = [tuple(map(np.asarray, each)) for each in roots_of(shape, *rays, starts_on)]
    assert all(t.dtype == dtype and np.isfinite(t).all() for t, _ in found)
    return np.stack([t for t, _ in found])[:, :count], np.stack([real for _, real in found])[:, :count]


def normals(shape: Shape, place: np.ndarray) -> np.ndarray:
    """Of places (3, N)."""
    padded = tuple(np.pad(place, padding(place.shape[1]), "edge"))
    return np.stack(_normal(shape, padded))[:, : place.shape[1]]


def value_normal_and_gradient(shape: Shape, place: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What the shape says of places (3, ...), and the derivatives of its value: (...), (3, ...) and (3, ...)."""
    flat = place.reshape(3, -1)
    told = _value_normal_and_gradient(shape, tuple(np.pad(flat, padding(flat.shape[1]), "edge")))
    value, normal, gradient = (np.asarray(each)[..., : flat.shape[1]] for each in told)
    return value.reshape(place.shape[1:]), normal.reshape(place.shape), gradient.reshape(place.shape)


def first_ahead(distance: np.ndarray, real: np.ndarray) -> np.ndarray:
    """The smallest root > 0, inf where there is none."""
    return np.where(real & (distance > 0), distance, np.inf).min(0)


def units(seed: int, count: int) -> np.ndarray:
    """Even directions, (3, N)."""
    d = np.random.default_rng(seed).normal(size=(3, count))
    return d / np.linalg.norm(d, axis=0)


def aimed(seed: int, count: int, away: float = 3.0) -> tuple[np.ndarray, np.ndarray]:
    """Rays from a sphere of radius `away` to points in the cube of half 1.3, (3, N)."""
    start = away * units(seed, count)
    way = np.random.default_rng(seed + 1).uniform(-1.3, 1.3, (3, count)) - start
    return start, way / np.linalg.norm(way, axis=0)


def crossings_by_sampling(case: Case, point: np.ndarray, direction: np.ndarray) -> list[float]:
    """All changes of sign of F ahead that belong to the shape, by bisection between 8,001 places, more at a touch."""
    t = np.linspace(0, FARTHEST, 8001)

    def f(t: np.ndarray) -> np.ndarray:
        return case.equation(*(p + t * d for p, d in zip(point, direction, strict=True)))

    values = f(t)
    # closer where F is about to change its sign and does not
    least = 1 + np.nonzero((abs(values[1:-1]) <= abs(values[:-2])) & (abs(values[1:-1]) <= abs(values[2:])))[0]
    t = np.sort(np.concatenate([t, (t[least, None] + (t[1] - t[0]) * np.linspace(-1, 1, 1001)).ravel()]))
    values = f(t)
    change = np.nonzero((values[1:] < 0) != (values[:-1] < 0))[0]
    low, high, sign = t[change], t[change + 1], values[change] < 0
    for _ in range(60):
        middle = (low + high) / 2
        same = (f(middle) < 0) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    kept = case.part(*(p + low * d for p, d in zip(point, direction, strict=True)))
    return sorted(low[kept])
