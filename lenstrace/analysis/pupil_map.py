"""From points of the pupil to directions of the light at the image, and back.

Diffraction sums plane waves: its variables are the direction cosines of the rays at the image, n' (l, m), counted from
the chief ray's. They are a smooth function of the pupil's coordinates, near to linear: a few rays and a polynomial of
seventh degree describe it. Newton's method inverts that at a few points, and a second polynomial is the inverse. On a
grid a
polynomial is known from as many rows and columns of it as it has degrees and one more: two products of matrices.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.image_rays import ImageRays
from lenstrace.sequential.sampling import pupil_points

DEGREE = 7
RINGS = 6
NEWTON_STEPS = 4
# The inverse is fitted out to here; beyond, there is no pupil.
FARTHEST = 1.15


class PupilMap(NamedTuple):
    """The polynomials of each field and wavelength.

    coefficients:  (F, W, 2, D, D), of the terms x^a y^b, a along the last axis but one; for n' l and for n' m.
    half_width:    (F, W), the largest of |n' l| and |n' m| of the rays it was made of.
    """

    coefficients: jax.Array
    half_width: jax.Array


@functools.cache
def _terms() -> tuple[np.ndarray, np.ndarray]:
    """a and b of the terms x^a y^b, without the constant."""
    a, b = np.array([(a, total - a) for total in range(1, DEGREE + 1) for a in range(total + 1)]).T
    return a, b


@functools.cache
def sampled() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of the pupil whose rays make the map, x and y (N,), and the matrix (D, D, N) that fits the polynomial."""
    x, y, _ = pupil_points("hexapolar", RINGS)
    a, b = _terms()
    fit = np.zeros((DEGREE + 1, DEGREE + 1, len(x)))
    fit[a, b] = np.linalg.pinv((x[:, None] ** a) * (y[:, None] ** b))
    return x, y, fit


@functools.cache
def _interpolation(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes (D,) between -1 and 1, and the matrices (n, D) from values at the nodes to those, and to the derivatives,
    at the n points -1, -1 + 2/n, ... 1 - 2/n."""
    nodes = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    points = np.arange(n) * 2 / n - 1
    inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(nodes, DEGREE))
    slopes = np.stack(
        [np.polynomial.chebyshev.chebval(points, np.polynomial.chebyshev.chebder(row)) for row in inverse.T]
    )
    return nodes, np.polynomial.chebyshev.chebvander(points, DEGREE) @ inverse, slopes.T


def pupil_map(arrived: ImageRays) -> PupilMap:
    """The map out of the rays through the points `sampled`; rays that have no course spoil it."""
    rays, fit = jax.tree.map(lambda a: jnp.swapaxes(a, 0, 1), arrived.rays), sampled()[2]
    index = jnp.asarray(arrived.index)[:, None]
    seen = [index * (a[..., 1:] - a[..., :1]) for a in (rays.l, rays.m)]
    matrix = jnp.asarray(fit, seen[0].dtype)
    coefficients = jnp.stack([jnp.einsum("abn,fwn->fwab", matrix, a, precision="highest") for a in seen], 2)
    widths = jnp.where(rays.has_course[..., 1:], jnp.maximum(*map(jnp.abs, seen)), 0)
    return PupilMap(coefficients, jnp.max(widths, -1))


def pupil_on_grid(coefficients: jax.Array, width: jax.Array, n: int) -> tuple[jax.Array, jax.Array, jax.Array]:
    """The points of the pupil whose light goes to the nodes of a grid of directions; of one field and wavelength.

    coefficients: (2, D, D).       width: of a cell, in n' times direction cosines; (n/2, n/2) is the chief ray's node.
    Returns x and y of the pupil and d(x, y) / d(column, row), (2, 2, n, n); and where the inverse is known, (n, n).
    """
    dtype = coefficients.dtype
    x, y, fit = (jnp.asarray(a, dtype) for a in sampled())
    inverse = jnp.array(_inverse(linear_part(coefficients)))
    # with l, m = the linear map of u: the inverse at points u, then as a polynomial of u
    u = FARTHEST * jnp.stack([x, y])
    target = jnp.array(linear_part(coefficients)) @ u

    def step(_: int, at: jax.Array) -> jax.Array:
        values, slopes = _values(coefficients, at[0], at[1])
        (a, b), (c, d) = _inverse(slopes)
        left, up = target[0] - values[0], target[1] - values[1]
        return at + jnp.stack([a * left + b * up, c * left + d * up])

    found = lax.fori_loop(0, NEWTON_STEPS, step, u)
    power = jnp.asarray(FARTHEST ** -np.add.outer(np.arange(DEGREE + 1), np.arange(DEGREE + 1.0)), dtype)
    inverted = jnp.einsum("abn,cn->cab", fit, found, precision="highest") * power
    nodes, values_at, slopes_at = (jnp.asarray(a, dtype) for a in _interpolation(n))
    across = width * (n / 2)
    l, m = jnp.meshgrid(nodes * across, nodes * across)
    seen = inverse @ jnp.stack([l.reshape(-1), m.reshape(-1)])
    few = jnp.stack(_values(inverted, seen[0], seen[1])[0]).reshape(2, *l.shape)

    def on_grid(rows: jax.Array, columns: jax.Array) -> jax.Array:
        return jnp.einsum("ia,cab,jb->cij", rows, few, columns, precision="highest")

    points, by_column, by_row = (
        on_grid(*both) for both in ((values_at, values_at), (values_at, slopes_at), (slopes_at, values_at))
    )
    step_l = (jnp.arange(n) - n // 2).astype(dtype) * width
    far = inverse[:, 0, None, None] * step_l + inverse[:, 1, None, None] * step_l[:, None]
    known = jnp.sum(far * far, 0) < FARTHEST**2
    return points, jnp.stack([by_column, by_row], 1) * (2 / n), known


def linear_part(coefficients: jax.Array) -> list[list[jax.Array]]:
    """The derivatives of n' l, and of n' m, by x and y at the centre of the pupil."""
    return [[row[1, 0], row[0, 1]] for row in coefficients]


def _values(coefficients: jax.Array, x: jax.Array, y: jax.Array) -> tuple[list[jax.Array], list[list[jax.Array]]]:
    """The two polynomials at points (N,), and their derivatives by x and by y."""
    power = np.arange(DEGREE + 1)
    xs, ys = (jnp.cumprod(jnp.stack([jnp.ones_like(a), *[a] * DEGREE]), 0) for a in (x, y))
    # d(x^a) = a x^(a - 1): the powers moved on by one
    dxs, dys = (jnp.roll(a, 1, 0) * power[:, None].astype(a.dtype) for a in (xs, ys))

    def summed(first: jax.Array, row: jax.Array, second: jax.Array) -> jax.Array:
        return jnp.sum(first * jnp.matmul(row, second, precision="highest"), 0)

    values = [summed(xs, row, ys) for row in coefficients]
    slopes = [[summed(dxs, row, ys), summed(xs, row, dys)] for row in coefficients]
    return values, slopes


def _inverse(matrix: list[list[jax.Array]]) -> list[list[jax.Array]]:
    (a, b), (c, d) = matrix
    determinant = a * d - b * c
    scale = 1 / jnp.where(determinant == 0, 1, determinant)
    return [[d * scale, -b * scale], [-c * scale, a * scale]]
