"""The nine dispersion formulas, each against a value written out by hand in mpmath; the index of air."""

from typing import Any

import mpmath
import numpy as np
import pytest

from lenstrace.optics.dispersion import CIDDOR, FORMULAS, air_index, gases


@pytest.mark.parametrize("number", range(1, 10))
def test_hand_evaluated(number: int) -> None:
    for wavelength in (0.55, 1.7):
        coefficients, expected = _mpmath_formulas(mpmath.mpf(wavelength))[number]
        got = FORMULAS[number](np.asarray(wavelength), tuple(float(c) for c in coefficients))
        assert float(got) == pytest.approx(float(expected), rel=2e-15)


@pytest.mark.parametrize("number", range(1, 10))
def test_shape(number: int) -> None:
    coefficients = _mpmath_formulas(mpmath.mpf(1))[number][0]
    assert FORMULAS[number](np.full((2, 3), 0.6), coefficients).shape == (2, 3)


def test_air() -> None:
    """(n - 1) 1e8 of dry air at 0.633 um: 27653 at 15 C and 27182 at 20 C."""
    assert float(gases(np.asarray(0.633), CIDDOR)) == pytest.approx(1.00027653, abs=2e-8)
    assert float(air_index(np.asarray(0.633))) == pytest.approx(1.00027182, abs=3e-8)


def _mpmath_formulas(wavelength: Any) -> dict[int, tuple[tuple[float, ...], Any]]:
    """Number -> coefficients and index, each formula written out by hand as the database prints it."""
    m, root = mpmath.mpf, mpmath.sqrt
    w = wavelength
    w2 = w * w
    return {
        1: (
            (0.1, 0.6961663, 0.0684043, 0.4079426, 0.1162414),
            root(m(1.1) + m(0.6961663) * w2 / (w2 - m(0.0684043) ** 2) + m(0.4079426) * w2 / (w2 - m(0.1162414) ** 2)),
        ),
        2: (
            (0.2, 1.03961212, 0.00600069867, 1.01046945, 103.560653),
            root(1 + m(0.2) + m(1.03961212) * w2 / (w2 - m(0.00600069867)) + m(1.01046945) * w2 / (w2 - m(103.560653))),
        ),
        3: ((2.8, -0.014, 2, 0.0177, -2), root(m(2.8) - m(0.014) * w2 + m(0.0177) / w2)),
        4: (
            (8.393, 0.14383, 1, 0.2421, 2, 4430.99, 0, 36.71, 2, 0.01, 3),
            root(
                m(8.393) + m(0.14383) * w / (w2 - m(0.2421) ** 2) + m(4430.99) / (w2 - m(36.71) ** 2) + m(0.01) * w**3
            ),
        ),
        5: ((1.5, 0.004, -2, 1e-4, -4), m(1.5) + m(0.004) / w2 + m(1e-4) / w2**2),
        6: (
            (1e-5, 0.05792105, 238.0185, 0.00167917, 57.362),
            1 + m(1e-5) + m(0.05792105) / (m(238.0185) - 1 / w2) + m(0.00167917) / (m(57.362) - 1 / w2),
        ),
        7: (
            (3.41983, 0.159906, -0.123109, 1.26878e-6, -1.95104e-9, 1e-10),
            m(3.41983)
            + m(0.159906) / (w2 - m(0.028))
            - m(0.123109) / (w2 - m(0.028)) ** 2
            + m(1.26878e-6) * w2
            - m(1.95104e-9) * w2**2
            + m(1e-10) * w2**3,
        ),
        8: ((0.3, 0.05, 0.06, -0.001), _retro(m(0.3) + m(0.05) * w2 / (w2 - m(0.06)) - m(0.001) * w2)),
        9: (
            (2.3, 0.012, 0.019, 0.02, 0.3, 0.05),
            root(m(2.3) + m(0.012) / (w2 - m(0.019)) + m(0.02) * (w - m(0.3)) / ((w - m(0.3)) ** 2 + m(0.05))),
        ),
    }


def _retro(refraction: Any) -> Any:
    """n out of (n^2 - 1) / (n^2 + 2) by root finding, not by the formula under test."""
    return mpmath.findroot(lambda n: (n * n - 1) / (n * n + 2) - refraction, 1.7)
