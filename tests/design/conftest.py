"""The problems that several tests search in."""

from __future__ import annotations

import pytest

from lenstrace import Lens, Problem
from tests.design.problems import GAPS, perturbed


@pytest.fixture(scope="session")
def problem_a(designs: dict[str, Lens]) -> Problem:
    """The Cooke triplet, nine variables."""
    return perturbed(designs["cooke_triplet"], GAPS["cooke_triplet"])


@pytest.fixture(scope="session")
def problem_b(designs: dict[str, Lens]) -> Problem:
    """The double Gauss, thirteen variables."""
    return perturbed(designs["double_gauss"], GAPS["double_gauss"])
