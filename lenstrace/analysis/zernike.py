"""A fit of Zernike polynomials to points of a pupil."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.typing import ArrayLike

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.errors import RayError
from lenstrace.optics.vectors import root_or_zero, safe_sqrt
from lenstrace.optics.zernike import checked_count, floating, zernike

# Terms that points tell apart only to this share of their size are not told apart; in units of eps.
DEPENDENT = 1e4


@pytree
class ZernikeFit:
    """Zernike terms that come nearest to values at points of a pupil.

    coefficients:  (count,), in the unit of the values, in the order `order`.
    residual_rms:  (), the weighted RMS of what they leave over, the same unit.
    Both are nan where the points do not determine the terms.
    """

    coefficients: jax.Array
    residual_rms: jax.Array
    order: str = static()


def fit_zernike(
    order: str, count: int, x: ArrayLike, y: ArrayLike, values: ArrayLike, weights: ArrayLike | None = None
) -> ZernikeFit:
    """The first `count` terms of an order fitted to values at points of the unit disk, by weighted least squares.

    x, y, values, weights:  of one shape; weights 1 by default. A point of weight 0 does not count, whatever it holds.
    Solved by orthogonal triangularization of the terms times sqrt(weight). RayError where fewer points count than there
    are terms, or where they do not tell the terms apart (too few rings, all on a line); nan under `jit`.
    """
    dtype = floating(x, y, values)
    weights = jnp.ones(np.shape(values), dtype) if weights is None else jnp.asarray(weights, dtype)
    if np.size(values) < checked_count(count):
        raise RayError(_too_few(count, np.size(values)))
    x, y, values, weights = (jnp.where(weights > 0, jnp.asarray(a, dtype), 0) for a in (x, y, values, weights))
    terms = zernike(order, count, x, y).reshape(count, -1)
    fitted = ZernikeFit(*_least_squares(terms, values.reshape(-1), weights.reshape(-1)), order=order)
    if not is_traced(fitted) and np.isnan(np.asarray(fitted.residual_rms)):
        points = int((np.asarray(weights) > 0).sum())
        if points < count:
            raise RayError(_too_few(count, points))
        if np.isfinite(np.asarray(values)).all():
            raise RayError(
                f"{points} points do not tell {count} Zernike terms apart: they lie on too few rings or lines; "
                "give more rings, or fewer terms"
            )
    return fitted


@compiled
def _least_squares(terms: jax.Array, values: jax.Array, weights: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Coefficients and residual RMS; terms (count, N), values and weights (N,)."""
    root = jnp.where(weights > 0, safe_sqrt(weights), 0)
    matrix = (terms * root).T
    size = jnp.abs(jnp.diagonal(jnp.linalg.qr(lax.stop_gradient(matrix), mode="r")))
    sound = jnp.min(size) > DEPENDENT * jnp.finfo(size.dtype).eps * jnp.max(size)
    none = jnp.where(sound, 0, jnp.nan).astype(matrix.dtype)
    # a matrix that cannot be solved must not spoil the derivatives of other fits: it is replaced before it is
    matrix = jnp.where(sound, matrix, jnp.eye(*matrix.shape, dtype=matrix.dtype))
    q, r = jnp.linalg.qr(matrix)
    projected = q.T @ (root * values)
    coefficients = lax.linalg.triangular_solve(r, projected[:, None], left_side=True)[:, 0]
    left = values - coefficients @ terms
    total = jnp.sum(weights)
    rms = root_or_zero(jnp.sum(weights * left * left) / jnp.where(total > 0, total, 1))
    return coefficients + none, rms + none


def _too_few(count: int, points: int) -> str:
    return f"{points} points cannot determine {count} Zernike terms; trace more rays, or fit fewer terms"
