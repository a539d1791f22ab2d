"""Bending at a surface, prisms and rainbows against published figures; other options, limits, bad combinations."""

import pytest
from numpy.testing import assert_allclose

from lenstrace import OptionError, phenomena
from lenstrace.phenomena.demonstration import Demonstration


def measured(found: Demonstration, quantity: str) -> float:
    """What was measured of a quantity, given in full."""
    return next(row.measured for row in found.rows if row.quantity == quantity)


def test_snell_at_30_degrees_into_glass() -> None:
    found = phenomena.snell()
    parts = [measured(found, f"its direction: {where} the surface") for where in ("along", "across")]
    assert_allclose(parts, [1 / 3, -0.942809041582063], atol=1e-15)
    assert_allclose(measured(found, "its direction: length"), 1, atol=1e-15)


@pytest.mark.parametrize("angle", [0.0, 1e-6, 41.8103148957, 41.810314895778596, 60.0, 89.9])
@pytest.mark.parametrize(("before", "index"), [(1.5, 1.0), (1.0, 1.0), (10.0, -0.1), (0.1, 10.0)])
def test_snell_agrees_everywhere(angle: float, before: float, index: float) -> None:
    found = phenomena.snell(angle=angle, index=index, index_before=before)
    assert found.agrees, found
    assert (found.refracted is None) == ("reflected totally" in found.setting)


def test_snell_refuses_an_index_that_is_nearly_0() -> None:
    with pytest.raises(OptionError, match=r"0\.1 or more, or -0\.1 or less, got 0\.01"):
        phenomena.snell(index=0.01)
