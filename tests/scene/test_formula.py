"""Formulas: arithmetic as it is written, in numpy and in JAX; nothing else runs."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lenstrace.errors import SceneError
from lenstrace.scene.formula import formula


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x + 2*y - z/4", 0.5 + 2 * 1.5 - 0.5),
        ("-x^2", -0.25),
        ("2^-x", 2**-0.5),
        ("2^3^2 / 512", 1.0),
        ("atan2(y, x)", np.arctan2(1.5, 0.5)),
        ("max(min(x, y), z)", 2.0),
        ("where(x < y, 7, 8)", 7.0),
        ("sqrt(abs(-z)) + pi - e", np.sqrt(2) + np.pi - np.e),
        ("a * hypot(x, y)", 3 * np.hypot(0.5, 1.5)),
    ],
)
def test_values(text: str, expected: float) -> None:
    function = formula(text, ("x", "y", "z"), {"a": 3.0})
    assert np.allclose(function(0.5, 1.5, 2.0), expected, rtol=1e-15)
    in_jax = function(*(jnp.asarray(value, jnp.float32) for value in (0.5, 1.5, 2.0)))
    assert np.allclose(in_jax, expected, rtol=1e-6)
    # a constant has no precision of its own
    assert (in_jax + jnp.zeros((), jnp.float32)).dtype == jnp.float32


def test_derivative_of_a_whole_power_below_zero() -> None:
    slope = jax.grad(formula("x^3 - 2*x^2", ("x",)))
    assert float(slope(-1.5)) == pytest.approx(3 * 2.25 + 6, rel=1e-14)
    assert float(slope(0.0)) == 0


def test_equal_where_they_say_the_same() -> None:
    assert formula("x + 1", ("x",)) == formula("x + 1", ("x",))
    assert hash(formula("x + 1", ("x",))) == hash(formula("x + 1", ("x",)))
    assert formula("x + 1", ("x",)) != formula("x + 2", ("x",))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must be text"),
        ("x +", "cannot be read"),
        ("x + q", "unknown name 'q'; it may use x, pi, e"),
        ("open(x)", "unknown function 'open'"),
        ("__import__('os')", "unknown function '__import__'"),
        ("x.real", "'x.real' is not arithmetic"),
        ("[x for x in x]", "is not arithmetic"),
        ("(lambda: 1)()", "is not arithmetic"),
        ("sin(x, x)", "sin takes 1 numbers, got 2"),
        ("atan2(x)", "atan2 takes 2 numbers, got 1"),
        ("sin(x=1)", "is not arithmetic"),
        ("True", "is not arithmetic"),
        ("x < 1 < 2", "is not arithmetic"),
        ("9^9^9^9", "cannot be read"),
        ("(-8)^(1/3)", "not a finite number"),
        ("1/0", "cannot be read"),
        ("(" * 300 + "x" + ")" * 300, "cannot be read"),
        ("+" * 4100 + "x", "at most 4000 characters"),
        ("x\0", "cannot be read"),
    ],
)
def test_refused(text: str, message: str) -> None:
    with pytest.raises(SceneError, match="formula") as caught:
        formula(text, ("x",))
    assert message in str(caught.value)
