"""Zernike polynomials on the unit disk: their orders, their names, their values.

    Z = N R_n^m(r) cos(m t)  for m >= 0,      Z = N R_n^|m|(r) sin(|m| t)  for m < 0,      R_n^m(1) = 1,

t counted from +x toward +y. The orthonormal ones have N = sqrt(n + 1) for m = 0, else sqrt(2 (n + 1)): the mean of
Z^2 over the disk is 1. The unnormalized ones have N = 1.
"""

from __future__ import annotations

import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jax.typing import ArrayLike

from lenstrace.compute.compiled import compiled
from lenstrace.errors import LensTraceError

# The number of the first term of each order.
ORDERS = {"noll": 1, "fringe": 1, "ansi": 0}
FRINGE_TERMS = 37

FAMILIES = ("spherical", "coma", "astigmatism", "trefoil", "tetrafoil", "pentafoil", "hexafoil")
RANKS = ("primary", "secondary", "tertiary", "quaternary", "quinary")


def zernike_index(order: str, number: int) -> tuple[int, int]:
    """n and m of a term; m < 0 for the sine.

    noll:    from 1; Noll, JOSA 66, 207 (1976): rising n, then |m|; even numbers are cosines. Orthonormal.
    fringe:  1 ... 37, the University of Arizona's: rising n + |m|, then falling |m|, the cosine first; number 37 is
             (12, 0). Unnormalized: amplitude 1 at the rim. Wyant & Creath, Applied Optics and Optical Engineering 11,
             chapter 1 (1992), table 3.
    ansi:    from 0; ANSI Z80.28, Thibos et al., J. Refract. Surg. 18, S652 (2002): number = (n (n + 2) + m) / 2.
             Orthonormal.

    >>> [zernike_index(order, 8) for order in ORDERS]
    [(3, 1), (3, -1), (3, 1)]
    """
    first = first_number(order)
    if not isinstance(number, int | np.integer) or number < first or (order == "fringe" and number > FRINGE_TERMS):
        end = f"to {FRINGE_TERMS}" if order == "fringe" else "upward"
        raise LensTraceError(f"Zernike terms in the order {order} are numbered from {first} {end}, got {number!r}")
    if order == "fringe":
        if number == FRINGE_TERMS:
            return 12, 0
        group = math.isqrt(number - 1)
        place = number - 1 - group * group
        m = group - place // 2
        return 2 * group - m, -m if place % 2 else m
    place = number - first
    n = (math.isqrt(8 * place + 1) - 1) // 2
    place -= n * (n + 1) // 2
    if order == "ansi":
        return n, 2 * place - n
    m = place + (n + place) % 2
    return n, m if number % 2 == 0 else -m


def zernike_name(n: int, m: int) -> str:
    """The classical name of a term, empty where there is none.

    x and y, 0 and 45 deg: the cosine and the sine of an odd and of an even m.

    >>> [zernike_name(*pair) for pair in [(1, -1), (2, -2), (3, 1), (4, 0), (9, 9)]]
    ['tilt y', 'primary astigmatism 45 deg', 'primary coma x', 'primary spherical', '']
    """
    size = abs(m)
    low = {(0, 0): "piston", (1, 1): "tilt x", (1, -1): "tilt y", (2, 0): "defocus"}
    if (n, m) in low:
        return low[n, m]
    # the first of each family: (4, 0), (3, 1), and (m, m) for the others
    rank = (n - {0: 4, 1: 3}.get(size, size)) // 2
    if size >= len(FAMILIES) or rank >= len(RANKS):
        return ""
    if m == 0:
        direction = ""
    elif m % 2:
        direction = " x" if m > 0 else " y"
    else:
        direction = " 0 deg" if m > 0 else f" {90 / size:g} deg"
    return f"{RANKS[rank]} {FAMILIES[size]}{direction}"


def zernike(order: str, count: int, x: ArrayLike, y: ArrayLike) -> jax.Array:
    """The first `count` polynomials of an order at points of the unit disk, (count, ...).

    x, y:  one shape, in units of the radius. order and count are static; see `zernike_index` for the orders.

    R_n^m(r) exp(i m t) = (x + i y)^m P_k^(0, m)(2 r^2 - 1), k = (n - m) / 2, by the recurrence of the Jacobi
    polynomials (Abramowitz & Stegun, 22.7.1): no root and no angle is taken, so that all derivatives are finite at the
    centre; absolute errors stay below 1e-12 to n = 50.
    """
    first = first_number(order)
    return zernike_terms(order, tuple(range(first, first + checked_count(count))), x, y)


def zernike_terms(order: str, numbers: tuple[int, ...], x: ArrayLike, y: ArrayLike) -> jax.Array:
    """The polynomials of some numbers, (len(numbers), ...), as `zernike`."""
    n, m = np.array([zernike_index(order, number) for number in numbers]).T
    size = np.abs(m)
    dtype = floating(x, y)
    norm = np.ones(len(numbers)) if order == "fringe" else np.sqrt(np.where(m == 0, n + 1, 2 * (n + 1)))
    terms = (n - size) // 2, (m < 0).astype(int), size, norm.astype(dtype)
    steps = _steps(max((n - size) // 2), max(size)).astype(dtype)
    return _values(terms, steps, jnp.asarray(x, dtype), jnp.asarray(y, dtype))


def first_number(order: str) -> int:
    """The number of the first term of an order; LensTraceError for an unknown one."""
    if not isinstance(order, str) or order not in ORDERS:
        raise LensTraceError(f"unknown order of Zernike terms {order!r}; one of {', '.join(ORDERS)}")
    return ORDERS[order]


def checked_count(count: int) -> int:
    """The number of terms; LensTraceError for what is none."""
    if not isinstance(count, int | np.integer) or count < 1:
        raise LensTraceError(f"the count of Zernike terms must be a whole number from 1 on, got {count!r}")
    return int(count)


def floating(*values: Any) -> Any:
    """That of the values, which are of one; the widest where none of them has a fraction."""
    dtype = jnp.result_type(*values)
    return dtype if jnp.issubdtype(dtype, jnp.floating) else jnp.result_type(float)


@compiled
def _values(terms: tuple[Any, ...], steps: Any, x: jax.Array, y: jax.Array) -> jax.Array:
    """terms: k, 1 for the sine, |m| and N of each, (count,); steps: see `_steps`."""
    k, sine, size, norm = terms

    def power(z: tuple[jax.Array, jax.Array], _: Any) -> tuple[tuple[jax.Array, jax.Array], jax.Array]:
        turned = (z[0] * x - z[1] * y, z[0] * y + z[1] * x)
        return turned, jnp.stack(turned)

    one = (jnp.ones_like(x), jnp.zeros_like(x))
    powers = jnp.concatenate([jnp.stack(one)[None], lax.scan(power, one, length=steps.shape[-1] - 1)[1]])
    argument = 2 * (x * x + y * y) - 1

    def raised(pair: tuple[jax.Array, jax.Array], step: jax.Array) -> tuple[tuple[jax.Array, jax.Array], jax.Array]:
        before, now = pair
        a, b, c = (each.reshape(-1, *(1,) * (x.ndim + 1)) for each in step)
        following = (a * argument + b) * now - c * before
        return (now, following), following

    rest = lax.scan(raised, (jnp.zeros_like(powers), powers), jnp.asarray(steps))[1]
    table = jnp.concatenate([powers[None], rest])  # (k, |m|, cosine or sine, ...)
    return norm.reshape(-1, *(1,) * x.ndim) * table[k, size, sine]


def _steps(last: int, largest: int) -> np.ndarray:
    """(K, 3, M + 1), the numbers a, b, c of P_{k+1} = (a t + b) P_k - c P_{k-1} for k = 0 ... K - 1, m = 0 ... M."""
    k, m = np.arange(last, dtype=float)[:, None], np.arange(largest + 1, dtype=float)
    two = 2 * k + m
    scale = 2 * (k + 1) * (k + m + 1) * np.where(two > 0, two, 1)
    a = np.where(two > 0, (two + 1) * (two + 2) * two / scale, 1)
    return np.stack([a, -(two + 1) * m * m / scale, 2 * k * (k + m) * (two + 2) / scale], 1)
