"""Zernike polynomials against published tables, closed forms, quadrature on the disk; their fit against numpy's."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

from lenstrace.analysis.zernike import fit_zernike
from lenstrace.errors import LensTraceError, RayError
from lenstrace.optics.zernike import ORDERS, zernike, zernike_index, zernike_name
from lenstrace.sequential.sampling import pupil_points

# Noll, JOSA 66, 207 (1976), table I, written out: j = 1 ... 22; m < 0 stands for the sine.
NOLL = [(0, 0), (1, 1), (1, -1), (2, 0), (2, -2), (2, 2), (3, -1), (3, 1), (3, -3), (3, 3), (4, 0)]
NOLL += [(4, 2), (4, -2), (4, 4), (4, -4), (5, 1), (5, -1), (5, 3), (5, -3), (5, 5), (5, -5), (6, 0)]
# Wyant & Creath, Applied Optics and Optical Engineering 11 (1992), table 3, as numbered from 1: n and m.
FRINGE = [(0, 0), (1, 1), (1, -1), (2, 0), (2, 2), (2, -2), (3, 1), (3, -1), (4, 0), (3, 3), (3, -3), (4, 2), (4, -2)]
FRINGE += [(5, 1), (5, -1), (6, 0), (4, 4), (4, -4), (5, 3), (5, -3), (6, 2), (6, -2), (7, 1), (7, -1), (8, 0)]
FRINGE += [(5, 5), (5, -5), (6, 4), (6, -4), (7, 3), (7, -3), (8, 2), (8, -2), (9, 1), (9, -1), (10, 0), (12, 0)]
# Thibos et al., J. Refract. Surg. 18, S652 (2002), table 1: j = 0 ... 14.
ANSI = [(0, 0), (1, -1), (1, 1), (2, -2), (2, 0), (2, 2), (3, -3), (3, -1), (3, 1), (3, 3)]
ANSI += [(4, -4), (4, -2), (4, 0), (4, 2), (4, 4)]

R, T = np.sqrt(np.linspace(0, 1, 23)), np.linspace(0, 6, 23)
X, Y = R * np.cos(T), R * np.sin(T)


@pytest.mark.parametrize(("order", "table"), [("noll", NOLL), ("fringe", FRINGE), ("ansi", ANSI)])
def test_orders_are_the_published_ones(order: str, table: list[tuple[int, int]]) -> None:
    assert [zernike_index(order, ORDERS[order] + place) for place in range(len(table))] == table


def test_what_is_no_term_is_an_error() -> None:
    for order, number in (("noll", 0), ("ansi", -1), ("fringe", 38)):
        with pytest.raises(LensTraceError, match="are numbered from"):
            zernike_index(order, number)
    with pytest.raises(LensTraceError, match="one of noll, fringe, ansi"):
        zernike("malacara", 3, 0.0, 0.0)
    with pytest.raises(LensTraceError, match="whole number from 1 on"):
        zernike("noll", 0, 0.0, 0.0)


def test_names_of_the_fringe_order() -> None:
    names = [zernike_name(*pair) for pair in FRINGE]
    assert len(set(names)) == 37
    assert all(names)
    assert names[3:9:4] == ["defocus", "primary coma y"]


def test_closed_forms() -> None:
    # Noll's table I in r and t
    r, t = R, T
    expected = {
        1: np.ones_like(r),
        2: 2 * r * np.cos(t),
        4: np.sqrt(3) * (2 * r**2 - 1),
        5: np.sqrt(6) * r**2 * np.sin(2 * t),
        7: np.sqrt(8) * (3 * r**3 - 2 * r) * np.sin(t),
        10: np.sqrt(8) * r**3 * np.cos(3 * t),
        11: np.sqrt(5) * (6 * r**4 - 6 * r**2 + 1),
        13: np.sqrt(10) * (4 * r**4 - 3 * r**2) * np.sin(2 * t),
        16: np.sqrt(12) * (10 * r**5 - 12 * r**3 + 3 * r) * np.cos(t),
        22: np.sqrt(7) * (20 * r**6 - 30 * r**4 + 12 * r**2 - 1),
    }
    values = np.asarray(zernike("noll", 22, X, Y))
    for number, formula in expected.items():
        assert_allclose(values[number - 1], formula, atol=1e-13)
    # fringe 37: r^12 term 924, amplitude 1 at the rim
    high = 924 * r**12 - 2772 * r**10 + 3150 * r**8 - 1680 * r**6 + 420 * r**4 - 42 * r**2 + 1
    assert_allclose(zernike("fringe", 37, X, Y)[36], high, atol=1e-12)


def test_high_terms_to_twelve_digits() -> None:
    # one of n = 50: R_50^0 is the Legendre polynomial of degree 25 in 2 r^2 - 1; R_50^48 = 50 r^50 - 49 r^48
    values = np.asarray(zernike("ansi", 51 * 52 // 2, X, Y))
    legendre = np.polynomial.legendre.legval(2 * R**2 - 1, np.eye(26)[25])
    assert_allclose(values[(50 * 52 + 0) // 2], np.sqrt(51) * legendre, atol=1e-12)
    radial = 50 * R**50 - 49 * R**48
    assert_allclose(values[(50 * 52 - 48) // 2], np.sqrt(102) * radial * np.sin(48 * T), atol=1e-12)
    assert np.abs(values).max() <= np.sqrt(102) * (1 + 1e-12)


@pytest.mark.parametrize("order", ["noll", "ansi", "fringe"])
def test_orthogonal_over_the_disk(order: str) -> None:
    # Gauss in r^2 and equal angles: exact to degree 38
    nodes, gauss = np.polynomial.legendre.leggauss(20)
    angles = 2 * np.pi * np.arange(40) / 40
    r = np.sqrt((nodes + 1) / 2)[:, None]
    weights = np.repeat(gauss / 2 / 40, 40)
    values = np.asarray(zernike(order, 37, (r * np.cos(angles)).ravel(), (r * np.sin(angles)).ravel()))
    gram = (values * weights) @ values.T
    n, m = np.array(FRINGE).T
    square = 1 / np.where(m == 0, n + 1, 2 * (n + 1)) if order == "fringe" else np.ones(37)
    assert_allclose(gram, np.diag(square), atol=1e-12)


def test_derivatives_at_the_centre() -> None:
    def at(point: jax.Array) -> jax.Array:
        return zernike("noll", 22, point[0], point[1])

    centre = jnp.zeros(2)
    slopes = np.asarray(jax.jacobian(at)(centre))
    expected = np.zeros((22, 2))
    # 2 x, 2 y, sqrt(8) (3 r^2 - 2) times y and x, sqrt(12) (... + 3) times x and y
    expected[[1, 7, 15], 0] = 2, -2 * np.sqrt(8), 3 * np.sqrt(12)
    expected[[2, 6, 16], 1] = 2, -2 * np.sqrt(8), 3 * np.sqrt(12)
    assert_allclose(slopes, expected, atol=1e-13)
    second = np.asarray(jax.hessian(at)(centre))
    assert np.isfinite(second).all()
    assert_allclose(second[3], 4 * np.sqrt(3) * np.eye(2), atol=1e-13)


def test_a_fit_is_that_of_numpy() -> None:
    x, y, _ = pupil_points("hexapolar", 5)
    random = np.random.default_rng(3)
    values, weights = random.normal(size=91), random.random(91)
    weights[::7] = 0.0
    dirty = np.where(weights > 0, values, np.nan)
    fitted = fit_zernike("fringe", 16, x, y, dirty, weights)
    terms, root = np.asarray(zernike("fringe", 16, x, y)).T, np.sqrt(weights)
    coefficients = np.linalg.lstsq(terms * root[:, None], values * root)[0]
    assert_allclose(fitted.coefficients, coefficients, atol=1e-13)
    left = values - terms @ coefficients
    assert_allclose(fitted.residual_rms, np.sqrt((weights * left**2).sum() / weights.sum()), rtol=1e-13)


def test_derivatives_of_a_fit() -> None:
    x, y, _ = pupil_points("hexapolar", 5)
    random = np.random.default_rng(4)
    values, weights = random.normal(size=91), random.random(91)
    weights[3] = 0.0

    def figure(values: jax.Array, weights: jax.Array, x: jax.Array) -> jax.Array:
        fitted = fit_zernike("noll", 11, x, y, values, weights)
        return fitted.coefficients[3] + fitted.residual_rms

    point = tuple(map(jnp.asarray, (values, weights, x)))
    slopes = jax.jit(jax.grad(figure, argnums=(0, 1, 2)))(*point)
    step = 1e-6
    for argument, slope in enumerate(slopes):
        assert np.isfinite(slope).all()
        assert float(slope[3]) == 0
        moved = [
            figure(*[a.at[40].add(sign * step) if i == argument else a for i, a in enumerate(point)])
            for sign in (1, -1)
        ]
        assert_allclose(slope[40], (moved[0] - moved[1]) / (2 * step), rtol=1e-6, atol=1e-9)


def test_points_that_do_not_determine_the_terms() -> None:
    x, y, _ = pupil_points("hexapolar", 5)
    values, few, rim = np.ones(91), np.zeros(91), np.zeros(91)
    few[:10], rim[-30:] = 1.0, 1.0
    with pytest.raises(RayError, match="10 points cannot determine 11"):
        fit_zernike("noll", 11, x, y, values, few)
    with pytest.raises(RayError, match="91 points cannot determine 100"):
        fit_zernike("noll", 100, x, y, values)
    with pytest.raises(RayError, match="30 points do not tell 11 Zernike terms apart"):
        fit_zernike("noll", 11, x, y, values, rim)

    def coefficients(weights: jax.Array) -> jax.Array:
        return fit_zernike("noll", 11, x, y, values, weights).coefficients

    found = jax.jit(jax.vmap(coefficients))(jnp.stack([few, rim, np.ones(91)]))
    assert np.isnan(found[:2]).all()
    assert_allclose(found[2], np.eye(11)[0], atol=1e-13)
    # the field that fails leaves the derivatives of the other as they are
    slope = jax.grad(lambda w: jax.vmap(coefficients)(w)[2].sum())(jnp.stack([few, rim, np.ones(91)]))
    assert np.isfinite(slope).all()


def test_single_precision_stays_single() -> None:
    x, y = (p.astype(np.float32) for p in pupil_points("hexapolar", 5)[:2])
    fitted = fit_zernike("noll", 11, x, y, zernike("noll", 11, x, y)[5])
    assert fitted.coefficients.dtype == fitted.residual_rms.dtype == np.float32
    assert_allclose(fitted.coefficients, np.eye(11)[5], atol=1e-6)
