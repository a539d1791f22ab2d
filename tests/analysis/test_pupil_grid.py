"""The grid over the pupil: areas of cells against fine counting, and the disk's moments."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lenstrace.analysis.pupil_grid import coverage, grid_points


@pytest.mark.parametrize("samples", [9, 32, 65])
def test_cells_add_up_to_the_disk(samples: int) -> None:
    x, y, part = grid_points(samples)
    width = 2 / (samples - 1)
    assert (part > 0).all()
    assert (part <= 1).all()
    assert_allclose(part.sum() * width**2, np.pi, rtol=0.1 / samples**2 + 2e-3 / samples)
    assert_allclose([(part * x).sum(), (part * y).sum(), (part * x * y).sum()], 0, atol=1e-9)
    # moments of the disk, to the second order in the width: the mean of r^2 is 1/2, of r^4 1/3
    square = x * x + y * y
    mean = [(part * square**k).sum() / part.sum() for k in (1, 2)]
    assert_allclose(mean, [1 / 2, 1 / 3], rtol=1.5 * width**2 + 1e-5)
    assert mean[0] == pytest.approx(1 / 2, rel=0.5 * width**2)


def test_a_cell_at_the_rim_against_counting() -> None:
    width = 0.05
    angle = np.linspace(0.1, 6.2, 12)
    radius = 1 + width * np.linspace(-0.7, 0.7, 12)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    steps = (np.arange(1000) + 0.5) / 1000 - 0.5
    counted = [
        np.mean((a + width * steps[:, None]) ** 2 + (b + width * steps) ** 2 <= 1) for a, b in zip(x, y, strict=True)
    ]
    assert_allclose(coverage(x, y, width), counted, atol=2e-3)
    # whole inside, and nothing outside
    assert_allclose(coverage(np.array([0.0, 0.3, 1.2]), np.array([0.0, -0.6, 0.0]), width), [1, 1, 0])
