"""Slabs, prisms and lenses of negative index against published closed forms, and figures computed elsewhere."""

import numpy as np
import pytest

from lenstrace import OptionError, phenomena


def test_slab_of_another_index_has_the_crossings_of_the_closed_form() -> None:
    found = phenomena.slab(index=-1.1, source=1.0, thickness=2.0, angles=(0.0, 30.0, 60.0, 80.0))
    crossings = [row.measured for row in found.rows if "crosses the axis behind" in row.quantity]
    published = [0.818181818182, 0.767766952966, 0.474419561549, -0.291311159665]
    np.testing.assert_allclose(crossings[:4], published, rtol=0, atol=6e-13)


@pytest.mark.parametrize(
    ("options", "image"),
    [
        ({"index": -1.6, "surroundings": 1.5}, "a real image"),
        ({"source": 2.0}, "its image on the back face"),
        ({"source": 5.0}, "no real image"),
    ],
)
def test_slab_agrees_with_theory_elsewhere(options: dict[str, float], image: str) -> None:
    found = phenomena.slab(**options)
    assert found.agrees, found
    assert image in found.setting


def test_spot_of_a_perfect_slab() -> None:
    found = phenomena.slab(source=0.7, thickness=2.0, aperture=0.98)
    assert abs(found.rows[-1].measured) <= 1e-14 * 2.0
    np.testing.assert_allclose(found.spots[:, 4:], found.spots_theory[:, 4:], rtol=1e-6)


def test_total_reflection_is_refused() -> None:
    with pytest.raises(OptionError, match=r"reflected totally at the index -0\.5; keep all rays below 30 deg"):
        phenomena.slab(index=-0.5)
