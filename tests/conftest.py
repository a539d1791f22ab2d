"""What every test runs under: strict dtype promotion, so that nothing is upcast by accident."""

from pathlib import Path

import jax
import pytest

import lenstrace
from lenstrace import Lens

jax.config.update("jax_numpy_dtype_promotion", "strict")

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="session")
def designs() -> dict[str, Lens]:
    """Every prescription in designs/, by the name of its file."""
    return {path.stem: lenstrace.load(path) for path in sorted((ROOT / "designs").glob("*.toml"))}
