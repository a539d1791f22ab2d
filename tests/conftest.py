"""What every test runs under: strict dtype promotion, so that nothing is upcast by accident; no cache."""

import os
from pathlib import Path

import jax
import pytest

import lenstrace
from lenstrace import Lens

jax.config.update("jax_numpy_dtype_promotion", "strict")
os.environ["JAX_ENABLE_COMPILATION_CACHE"] = "false"  # commands then keep no programs in the user's folder
# nearly all programs run once or twice here: most of the time goes into compiling them
os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} --xla_backend_optimization_level=0"

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="session")
def designs() -> dict[str, Lens]:
    """Every prescription in designs/, by the name of its file."""
    return {path.stem: lenstrace.load(path) for path in sorted((ROOT / "designs").glob("*.toml"))}


RICH = [
    {"radius": 56.20238, "thickness": 1 / 3, "glass": "N-SSK2", "conic": -1.1, "semi_diameter": 27.0, "name": "front"},
    {"curvature": 0.1 / 7, "thickness": -0.5, "asphere": {4: 1e-6, 16: -2e-21}, "index": 1.5},
    {"thickness": 5, "stop": True, "aperture": {"annulus": [1, 2]}, "abbe": {"nd": 1.62, "vd": 60.3}},
    {"radius": 20, "index": {"um": [0.5, 0.6], "n": [1.51, 1.5]}, "aperture": {"circle": 9.5}, "tilt": [10, 0, 0.1]},
    {"thickness": -80, "break": True, "decenter": [0.1, 1], "aperture": {"rectangle": [3, 4]}},
    {"radius": -1e12, "mirror": True, "aperture": {"obscuration": 0.5}},
]


@pytest.fixture(scope="session")
def rich_lens() -> Lens:
    """Every key of the file, used."""
    return lenstrace.lens(
        RICH,
        {"image_f_number": 4.1},
        {"kind": "image_height", "x": [0.1], "y": [0.3]},
        {"um": [0.5, 0.6], "weights": [1, 0.3], "primary": 0.6},
        object_distance=123.4,
        object_glass="SILICA",
        ray_aiming=True,
        image={"radius": -60.0, "conic": 0.5},
        name="all keys",
        source="a test",
    )
