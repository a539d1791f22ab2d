"""lenstrace: a differentiable optical-design lens ray tracer in JAX.

Importing it switches JAX to 64-bit numbers, because a lens traced in float32 is silently wrong in optical path;
an explicit JAX_ENABLE_X64 in the environment is honoured. What needs a heavy library (reading files: pydantic;
plots: matplotlib) is imported when it is first used.
"""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING, Any

import jax

if "JAX_ENABLE_X64" not in os.environ:
    jax.config.update("jax_enable_x64", True)

from lenstrace.analysis.cardinal import Overview, first_order, overview
from lenstrace.analysis.mean_square import mean_square_spot
from lenstrace.analysis.newton import NewtonCheck, newton_check
from lenstrace.analysis.rays import ray, trace
from lenstrace.analysis.spots import Spots, spots
from lenstrace.analysis.vignetting import Vignetting, vignetting
from lenstrace.compute.compiled import COMPILER_OPTIONS
from lenstrace.errors import (
    ImageError,
    LensTraceError,
    LostRaysError,
    MediumError,
    PrescriptionError,
    RayError,
    UnknownGlassError,
    WavelengthError,
)
from lenstrace.optics.glasses import glass
from lenstrace.optics.rays import Ray, RayStatus
from lenstrace.sequential.document import Aperture, Fields, Wavelengths
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.paraxial import FirstOrder
from lenstrace.sequential.rows import Row
from lenstrace.sequential.system import System

if TYPE_CHECKING:
    from lenstrace.analysis.layout import layout
    from lenstrace.io.native import dumps, load, loads, save
    from lenstrace.plotting.cardinal import plot_first_order
    from lenstrace.plotting.layout import plot_layout
    from lenstrace.plotting.rays import plot_rays
    from lenstrace.plotting.spots import plot_spots
    from lenstrace.sequential.prescription import lens

__version__ = "0.1.0"

__all__ = [
    "COMPILER_OPTIONS",
    "Aperture",
    "Fields",
    "FirstOrder",
    "ImageError",
    "Lens",
    "LensTraceError",
    "LostRaysError",
    "MediumError",
    "NewtonCheck",
    "Overview",
    "PrescriptionError",
    "Ray",
    "RayError",
    "RayStatus",
    "Row",
    "Spots",
    "System",
    "UnknownGlassError",
    "Vignetting",
    "WavelengthError",
    "Wavelengths",
    "dumps",
    "first_order",
    "glass",
    "layout",
    "lens",
    "load",
    "loads",
    "mean_square_spot",
    "newton_check",
    "overview",
    "plot_first_order",
    "plot_layout",
    "plot_rays",
    "plot_spots",
    "ray",
    "save",
    "spots",
    "trace",
    "vignetting",
]

_IMPORTED_WHEN_USED = {
    "dumps": "lenstrace.io.native",
    "layout": "lenstrace.analysis.layout",
    "lens": "lenstrace.sequential.prescription",
    "load": "lenstrace.io.native",
    "loads": "lenstrace.io.native",
    "plot_first_order": "lenstrace.plotting.cardinal",
    "plot_layout": "lenstrace.plotting.layout",
    "plot_rays": "lenstrace.plotting.rays",
    "plot_spots": "lenstrace.plotting.spots",
    "save": "lenstrace.io.native",
}


def __getattr__(name: str) -> Any:
    if name not in _IMPORTED_WHEN_USED:
        raise AttributeError(f"module 'lenstrace' has no attribute {name!r}")
    value = getattr(importlib.import_module(_IMPORTED_WHEN_USED[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
