"""Bounds of the slopes of formulas: they hold wherever one looks, and are near to what one finds there."""

from __future__ import annotations

import math
import time
from typing import Any

import jax
import jax.numpy as jnp
import mpmath
import numpy as np
import pytest

from lenstrace.errors import SceneError
from lenstrace.scene.formula import Formula, formula
from lenstrace.scene.formula_bounds import slopes_within
from lenstrace.scene.interval_functions import LIBRARY
from lenstrace.scene.interval_slopes import coordinate
from lenstrace.scene.intervals import Interval

SPHERE = "sqrt(x^2 + y^2 + z^2) - 1"
BLOBS = " + ".join(
    f"exp(-3*((x - {a})^2 + (y - {b})^2 + (z - {c})^2))"
    for a, b, c in (
        (0.0, 0.9, -0.7),
        (0.9, -0.4, 0.1),
        (0.7, -0.2, 0.1),
        (-0.9, 0.5, 0.1),
        (-0.3, 0.6, -0.4),
        (0, 0, 0),
    )
)
SMOOTH = {
    "sphere": "x^2 + y^2 + z^2 - 1",
    "rounded root": "sqrt(x^2 + y^2/4 + z^2 + 0.1) - 1",
    "torus": "(x*x + y*y + z*z + 0.84)^2 - 4*(x^2 + y^2)",
    "blob": "exp(-(x^2 + y^2 + z^2)) - 0.3",
    "blobs": BLOBS + " - 0.5",
    "gyroid": "sin(2*x)*cos(2*y) + sin(2*y)*cos(2*z) + sin(2*z)*cos(2*x)",
    "heart": "(x^2 + 9*y^2/4 + z^2 - 1)^3 - x^2*z^3 - 9*y^2*z^3/80",
    "superellipsoid": "abs(x)^2.5 + abs(y)^3 + abs(z)^4 - 1",
    "hyperbolic": "exp(x)*cosh(y) - sinh(z) + tanh(x*y)",
    "inverse": "atan(3*x)*z + atan2(y, x + 5) + asin(y/4) - acos(x*z/8)",
    "quotient": "tan(x/2)/(4 + y*z/2) + log(z^2 + 1) + 2^y",
    "stretched": "hypot(x, 3) + 5^-0.5*y + (x^2 + z^2 + 1)^1.5",
}
KINKED = {
    "ball": SPHERE,
    "ball by two": "hypot(hypot(x, y), z) - 1",
    "ring": "sqrt((sqrt(x^2 + y^2) - 1)^2 + z^2) - 0.4",
    "two balls": "min(sqrt(x*x + y*y + z*z) - 1, sqrt((x - 1)^2 + y^2 + z^2) - 1)",
    "two paraboloids": "min(x^2 + y^2 + z^2 - 1, (x - 1)^2 + y^2 + z^2 - 1)",
    "octahedron": "abs(x) + abs(y) + abs(z) - 1",
    "can": "max(hypot(x, y) - 1, abs(z) - 1)",
    "ellipsoid": "sqrt(x^2/4 + y^2 + 9*z^2) - 1",
}
REACH = 2.0
PLACES, CELLS = 40_000, 120


def of_space(text: str) -> Formula:
    return formula(text, ("x", "y", "z"))


def sampled(text: str, reach: float, derivative: Any) -> np.ndarray:
    """First or second derivatives at random places."""
    function = of_space(text)
    places = np.random.default_rng(5).uniform(-reach, reach, (PLACES, 3))
    return np.asarray(jax.jit(jax.vmap(derivative(lambda place: function(*place))))(places))


def both_orders(function: Any) -> Any:
    """The gradient above the second derivatives, (4, 3)."""
    return lambda place: jnp.concatenate([jax.grad(function)(place)[None], jax.hessian(function)(place)])


def steepest(gradients: np.ndarray) -> float:
    return float(np.linalg.norm(gradients, axis=1).max())


@pytest.mark.parametrize("text", SMOOTH.values(), ids=SMOOTH.keys())
def test_smooth(text: str) -> None:
    steepness, bending = slopes_within(of_space(text), REACH)
    gradients, hessians = np.split(sampled(text, REACH, both_orders), [1], axis=1)
    found, bent = steepest(gradients[:, 0]), float(np.abs(np.linalg.eigvalsh(hessians)).max())
    assert found <= steepness < 1.5 * found
    assert bent <= bending < 1.8 * bent


@pytest.mark.parametrize("text", KINKED.values(), ids=KINKED.keys())
def test_kinked(text: str) -> None:
    steepness, bending = slopes_within(of_space(text), REACH)
    found = steepest(sampled(text, REACH, jax.grad))
    assert found * (1 - 1e-12) <= steepness < 1.02 * found
    assert bending == math.inf


def test_a_kink_outside_the_cube_does_not_matter() -> None:
    assert slopes_within(of_space("abs(x - 3) + min(y, 3 + z) + max(z, x - 5)"), 1.0) == pytest.approx((3**0.5, 0))
    _, bending = slopes_within(of_space("hypot(x - 3, y)"), 1.0)
    assert 0.5 <= bending < 0.55


def test_linear() -> None:
    steepness, bending = slopes_within(of_space("0.3*x - 1.7*y + z*2.9 - 4 + x"), 7.0)
    assert steepness == pytest.approx(math.hypot(1.3, 1.7, 2.9), rel=1e-8)
    assert bending == 0


@pytest.mark.parametrize("reach", [1e-3, 1.0, 1e4])
def test_sum_of_squares(reach: float) -> None:
    steepness, bending = slopes_within(of_space("x^2 + y^2 + z^2"), reach)
    assert steepness == pytest.approx(2 * math.sqrt(3) * reach, rel=1e-8)
    assert bending == pytest.approx(2, rel=1e-8)


@pytest.mark.parametrize(
    "text", ["7", "pi - 2", "sin(1)", "where(1 < 2, 3, sqrt(-1))", "asin(1)", "x - x + hypot(3, 4)"]
)
def test_constant(text: str) -> None:
    assert slopes_within(of_space(text), 1.0) == (0, 0)


@pytest.mark.parametrize("text", [SPHERE, KINKED["ring"], KINKED["two balls"], "((x - 1)*(x - 1) + y^2*0.5)^(1/2)"])
def test_a_distance_has_a_slope_of_1(text: str) -> None:
    assert slopes_within(of_space(text), 3.0)[0] == pytest.approx(1, rel=1e-8)


def test_a_root_that_is_squared_again_has_no_kink() -> None:
    assert slopes_within(of_space("sqrt(x^2 + y^2)^2 + abs(z)^2"), 1.0) == pytest.approx((2 * 3**0.5, 2))


@pytest.mark.parametrize(
    "text",
    [
        *("1/x", "sign(x)", "floor(x)", "log(x)", "sqrt(x)", "tan(2*x)", "x^-2", "x^0.5", "y^x", "atan2(y, x)"),
        "asin(2)",
        *("where(x < 0.3, 1, 2)", "(x < 1) * y", "x + 0*log(y)", "where(log(x)^2 >= 0, 1, 2)", "floor(sin(log(x))/9)"),
        *("1/(1 < 0)", "exp(9999*x)", "cos(5*atan2(y, x))", "sqrt(-1)", "hypot(asin(2), x)", "log(x)^0 + y"),
    ],
)
def test_no_bound(text: str) -> None:
    with pytest.raises(SceneError, match="give `steepness`"):
        slopes_within(of_space(text), 1.0)


def test_jumps_outside_the_cube_do_not_matter() -> None:
    text = "floor(x/9 + 0.5) + sign(y - 2) + where(z < 5, z, 1/z) + x*(y > 4) + y*(x >= -1.5) + atan2(z, x + 3)/9"
    steepness, bending = slopes_within(of_space(text), 1.0)
    assert math.sqrt(2) <= steepness < 1.6
    assert bending < 0.1


def test_wrong_questions() -> None:
    with pytest.raises(SceneError, match="of 3 numbers"):
        slopes_within(formula("x", ("x",)), 1.0)
    with pytest.raises(SceneError, match="positive reach"):
        slopes_within(of_space("x"), math.nan)


def test_time() -> None:
    function = of_space(SMOOTH["blobs"])
    start = time.process_time()
    slopes_within(function, REACH)
    assert time.process_time() - start < 1


@pytest.mark.parametrize(
    ("text", "low", "high"),
    [
        *[(f"{name}(x)", -2.0, 2.0) for name in ("sin", "cos", "sinh", "cosh", "tanh", "exp", "abs", "atan", "floor")],
        *[("tan(x)", -1.5, 1.5), ("log(x)", 0.01, 3.0), ("sqrt(x)", 0.01, 3.0), ("asin(x)", -0.99, 0.99)],
        *[("acos(x)", -0.99, 0.99), ("sign(x)", 0.1, 2.0), ("sin(9*x)", -3.0, 3.0), ("cos(9*x)", 0.0, 9.0)],
        *[(f"x^{n}", -2.0, 2.0) for n in (0, 1, 2, 3, 4, 7)],
        *[(f"x^{n}", 0.1, 3.0) for n in (-1, -2, -3, 0.5, 1.5, 2.5, -0.5)],
        *[("x^-2", -3.0, -0.1), ("x^-3", -3.0, -0.1), ("abs(x)^1.5", -2.0, 2.0), ("abs(x)^2.5", -2.0, 2.0)],
        *[("hypot(x, x - 1)", -2.0, 2.0), ("atan2(x, 0.3)", -2.0, 2.0), ("atan2(0.3, x)", -2.0, 2.0)],
        *[("atan2(-0.3, x)", -2.0, 2.0), ("max(x, x^2)", -2.0, 2.0), ("min(x, x^2)", -2.0, 2.0), ("2^x", -2.0, 2.0)],
    ],
)
def test_every_function(text: str, low: float, high: float) -> None:
    """The intervals hold the function and, off its kinks, both derivatives, in 30 digits; narrow ones are near."""
    random = np.random.default_rng(3)
    middle, width = random.uniform(low, high, CELLS), 10 ** random.uniform(-6, 0, CELLS)
    cells = Interval(np.maximum(middle - width, low), np.minimum(middle + width, high))
    with np.errstate(all="ignore"):
        found = of_space(text).evaluate(LIBRARY, *[coordinate(axis, cells) for axis in range(3)])
    for part, order in ((found.value, 0), (found.first[0], 1), (found.second[0], 2)):
        lows, highs = np.broadcast_to(part.low, CELLS), np.broadcast_to(part.high, CELLS)
        for cell in range(CELLS):
            place = min(max(random.uniform(cells.low[cell], cells.high[cell]), low + 1e-3), high - 1e-3)
            if not cells.low[cell] <= place <= cells.high[cell] or highs[cell] == math.inf:
                continue
            with mpmath.workdps(30):
                expected = mpmath.diff(lambda x: exact(text, x), place, order, h=mpmath.mpf("1e-9"))
                slack = mpmath.mpf("1e-6") * (1 + abs(expected)) if order else 0
                assert lows[cell] - slack <= expected <= highs[cell] + slack
    narrow = np.broadcast_to(found.value.high - found.value.low, CELLS)[width < 1e-5]
    assert np.all((narrow < 0.2) | (narrow == 1))  # 1: a step


def exact(text: str, x: mpmath.mpf) -> mpmath.mpf:
    """A formula by mpmath."""
    return of_space(text).evaluate(Exact, mpmath.mpf(x), mpmath.mpf(0), mpmath.mpf(0))


class Exact:
    """mpmath's functions by numpy's names."""

    sin, cos, tan, sinh, cosh, tanh = mpmath.sin, mpmath.cos, mpmath.tan, mpmath.sinh, mpmath.cosh, mpmath.tanh
    exp, log, sqrt, sign, floor, abs = mpmath.exp, mpmath.log, mpmath.sqrt, mpmath.sign, mpmath.floor, mpmath.fabs
    arcsin, arccos, arctan, arctan2 = mpmath.asin, mpmath.acos, mpmath.atan, mpmath.atan2
    hypot, minimum, maximum = mpmath.hypot, min, max
