"""What the fresh processes of section memory do for the peers; lenstrace is not loaded in them."""

from __future__ import annotations

from tests.benchmarks import peers
from tests.benchmarks.fresh import peak_mb

MILLION = 1_000_000
RAYOPTICS_RAYS = 2_000


def batoid_memory() -> dict[str, float]:
    """A million rays through the double Gauss, the image alone; it traces in place."""
    import batoid  # noqa: F401

    before = peak_mb()
    rays = peers.batoid_rays(*peers.filling(MILLION))
    peers.batoid_double_gauss().trace(rays)
    return {"rays": MILLION, "peak": peak_mb() - before}


def optiland_memory() -> dict[str, float]:
    """As `batoid_memory`."""
    return _optiland("numpy")


def optiland_torch_memory() -> dict[str, float]:
    """As `batoid_memory`."""
    import torch  # noqa: F401

    return _optiland("torch")


def rayoptics_memory() -> dict[str, float]:
    """As `batoid_memory`, fewer rays."""
    import rayoptics.optical.opticalmodel  # noqa: F401

    before = peak_mb()
    peers.rayoptics_traced(peers.rayoptics_double_gauss(), *peers.filling(RAYOPTICS_RAYS))()
    return {"rays": RAYOPTICS_RAYS, "peak": peak_mb() - before}


def _optiland(backend: str) -> dict[str, float]:
    import optiland.optic
    import optiland.rays  # noqa: F401

    before = peak_mb()
    image = peers.optiland_traced(peers.optiland_double_gauss(backend), *peers.filling(MILLION), backend)()
    return {"rays": image.y.shape[0], "peak": peak_mb() - before}
