"""What every test runs under: strict dtype promotion, so that nothing is upcast by accident; programs shared by all."""

# ruff: noqa: E402
import gc
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

# nearly all programs run once or twice here: most of the time goes into compiling them
QUICKLY = "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false"
if QUICKLY not in os.environ.get("XLA_FLAGS", ""):
    os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} {QUICKLY}"

# nor need the compiler be told where each line stands, nor the collector look as often at what JAX makes
os.environ.setdefault("JAX_TRACEBACK_IN_LOCATIONS_LIMIT", "0")
# small systems of equations are solved by one thread: others would spin beside it, where the other worker computes
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
gc.set_threshold(100_000, 50, 100)

import jax
import pytest

import lenstrace
from lenstrace import Lens

jax.config.update("jax_numpy_dtype_promotion", "strict")
# Workers, commands and notebooks take programs from one folder, made by the first process and removed by it; none are
# kept in the user's.
OWNS_PROGRAMS = "JAX_COMPILATION_CACHE_DIR" not in os.environ
PROGRAMS = os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", tempfile.mkdtemp(prefix="lenstrace-programs-"))
os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "1"
os.environ["JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES"] = "-1"
jax.config.update("jax_compilation_cache_dir", PROGRAMS)
jax.config.update("jax_persistent_cache_min_compile_time_secs", 1.0)
jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
ROOT = Path(__file__).parent.parent
LONGEST = {"test_notebooks", "test_readme"}
# Each program that is kept takes a few pieces of a process's memory map; Linux allows 65,530 of them.
MAPS, MOST_PIECES = Path("/proc/self/maps"), 25_000


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


@pytest.fixture(scope="module", autouse=True)
def _programs_that_are_kept() -> Iterator[None]:
    """Let the programs of earlier files go before there are too many."""
    yield
    if MAPS.exists() and len(MAPS.read_bytes().splitlines()) > MOST_PIECES:
        jax.clear_caches()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What takes longest first: a worker that met it last would be waited for by all."""
    items.sort(key=lambda item: item.path.stem not in LONGEST)


def pytest_unconfigure() -> None:
    """Remove the programs."""
    if OWNS_PROGRAMS:
        shutil.rmtree(PROGRAMS, ignore_errors=True)
