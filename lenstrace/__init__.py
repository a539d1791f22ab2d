"""lenstrace: a differentiable optical-design lens ray tracer in JAX.

Importing it switches JAX to 64-bit numbers, because a lens traced in float32 is silently wrong in optical path;
an explicit JAX_ENABLE_X64 in the environment is honoured. What needs a heavy library (reading files: pydantic;
plots: matplotlib), and what not everybody asks for (aberrations, diffraction), is imported when it is first used.
"""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING, Any

import jax

if "JAX_ENABLE_X64" not in os.environ:
    jax.config.update("jax_enable_x64", True)

from lenstrace import phenomena
from lenstrace.analysis.cardinal import Overview, first_order, overview
from lenstrace.analysis.mean_square import mean_square_spot
from lenstrace.analysis.newton import NewtonCheck, newton_check
from lenstrace.analysis.rays import ray, trace
from lenstrace.analysis.spot_figures import Spots
from lenstrace.analysis.spots import spots
from lenstrace.analysis.vignetting import Vignetting, vignetting
from lenstrace.compute.compiled import COMPILER_OPTIONS
from lenstrace.errors import (
    AccuracyError,
    AccuracyWarning,
    CameraError,
    DesignError,
    ImageError,
    LensTraceError,
    LostRaysError,
    MediumError,
    OptionError,
    PrescriptionError,
    RayError,
    SceneError,
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
    from lenstrace.analysis.aberrations import seidel
    from lenstrace.analysis.colour import (
        AxialColour,
        LateralColour,
        LongitudinalAberration,
        axial_colour,
        lateral_colour,
        longitudinal_aberration,
    )
    from lenstrace.analysis.distortion import Distortion, DistortionGrid, distortion, distortion_grid
    from lenstrace.analysis.encircled import encircled_energy
    from lenstrace.analysis.fans import Fans, fans
    from lenstrace.analysis.field_curvature import FieldCurvature, field_curvature
    from lenstrace.analysis.focus import BestFocus, ThroughFocus, best_focus, through_focus
    from lenstrace.analysis.illumination import Illumination, IncidenceAngles, incidence_angles, relative_illumination
    from lenstrace.analysis.layout import layout
    from lenstrace.analysis.mtf import Mtf, geometric_mtf, mtf, mtf_through_focus
    from lenstrace.analysis.psf import Psf, psf
    from lenstrace.analysis.sheet import sheet
    from lenstrace.analysis.spot_curves import spot_field, spot_spectrum
    from lenstrace.analysis.third_order import Seidel
    from lenstrace.analysis.trade import LensTrade, trade
    from lenstrace.analysis.wave_focus import wave_focus
    from lenstrace.analysis.wavefront import Wavefront, wavefront, zernike_coefficients
    from lenstrace.analysis.zernike import fit_zernike
    from lenstrace.design import Optimized, Problem, optimize
    from lenstrace.io.native import dumps, load, loads, save
    from lenstrace.io.scene import load_scene
    from lenstrace.optics.zernike import zernike
    from lenstrace.plotting.aberrations import plot_seidel
    from lenstrace.plotting.cardinal import plot_first_order
    from lenstrace.plotting.demonstration import plot_demonstration
    from lenstrace.plotting.fans import plot_fans
    from lenstrace.plotting.field import (
        plot_axial_colour,
        plot_distortion,
        plot_distortion_grid,
        plot_field_curvature,
        plot_illumination,
        plot_incidence_angles,
        plot_lateral_colour,
        plot_longitudinal_aberration,
    )
    from lenstrace.plotting.focus import plot_focus_spots, plot_through_focus
    from lenstrace.plotting.layout import plot_layout
    from lenstrace.plotting.mtf import plot_mtf, plot_mtf_field, plot_mtf_through_focus
    from lenstrace.plotting.optimize import plot_optimize
    from lenstrace.plotting.picture import plot_picture, save_picture
    from lenstrace.plotting.psf import plot_encircled, plot_psf
    from lenstrace.plotting.rays import plot_rays
    from lenstrace.plotting.sliders import explore
    from lenstrace.plotting.spot_curves import plot_spot_field, plot_spot_spectrum
    from lenstrace.plotting.spots import plot_spots
    from lenstrace.plotting.trade import plot_trade
    from lenstrace.plotting.wavefront import plot_wavefront
    from lenstrace.scene import Picture, Scene, render
    from lenstrace.sequential.prescription import lens

__version__ = "0.1.0"

__all__ = [
    "COMPILER_OPTIONS",
    "AccuracyError",
    "AccuracyWarning",
    "Aperture",
    "AxialColour",
    "BestFocus",
    "CameraError",
    "DesignError",
    "Distortion",
    "DistortionGrid",
    "Fans",
    "FieldCurvature",
    "Fields",
    "FirstOrder",
    "Illumination",
    "ImageError",
    "IncidenceAngles",
    "LateralColour",
    "Lens",
    "LensTraceError",
    "LensTrade",
    "LongitudinalAberration",
    "LostRaysError",
    "MediumError",
    "Mtf",
    "NewtonCheck",
    "Optimized",
    "OptionError",
    "Overview",
    "Picture",
    "PrescriptionError",
    "Problem",
    "Psf",
    "Ray",
    "RayError",
    "RayStatus",
    "Row",
    "Scene",
    "SceneError",
    "Seidel",
    "Spots",
    "System",
    "ThroughFocus",
    "UnknownGlassError",
    "Vignetting",
    "Wavefront",
    "WavelengthError",
    "Wavelengths",
    "axial_colour",
    "best_focus",
    "distortion",
    "distortion_grid",
    "dumps",
    "encircled_energy",
    "explore",
    "fans",
    "field_curvature",
    "first_order",
    "fit_zernike",
    "geometric_mtf",
    "glass",
    "incidence_angles",
    "lateral_colour",
    "layout",
    "lens",
    "load",
    "load_scene",
    "loads",
    "longitudinal_aberration",
    "mean_square_spot",
    "mtf",
    "mtf_through_focus",
    "newton_check",
    "optimize",
    "overview",
    "phenomena",
    "plot_axial_colour",
    "plot_demonstration",
    "plot_distortion",
    "plot_distortion_grid",
    "plot_encircled",
    "plot_fans",
    "plot_field_curvature",
    "plot_first_order",
    "plot_focus_spots",
    "plot_illumination",
    "plot_incidence_angles",
    "plot_lateral_colour",
    "plot_layout",
    "plot_longitudinal_aberration",
    "plot_mtf",
    "plot_mtf_field",
    "plot_mtf_through_focus",
    "plot_optimize",
    "plot_picture",
    "plot_psf",
    "plot_rays",
    "plot_seidel",
    "plot_spot_field",
    "plot_spot_spectrum",
    "plot_spots",
    "plot_through_focus",
    "plot_trade",
    "plot_wavefront",
    "psf",
    "ray",
    "relative_illumination",
    "render",
    "save",
    "save_picture",
    "seidel",
    "sheet",
    "spot_field",
    "spot_spectrum",
    "spots",
    "through_focus",
    "trace",
    "trade",
    "vignetting",
    "wave_focus",
    "wavefront",
    "zernike",
    "zernike_coefficients",
]

_IMPORTED_WHEN_USED = {
    "Picture": "lenstrace.scene",
    "Scene": "lenstrace.scene",
    "AxialColour": "lenstrace.analysis.colour",
    "BestFocus": "lenstrace.analysis.focus",
    "Distortion": "lenstrace.analysis.distortion",
    "DistortionGrid": "lenstrace.analysis.distortion",
    "Fans": "lenstrace.analysis.fans",
    "FieldCurvature": "lenstrace.analysis.field_curvature",
    "Illumination": "lenstrace.analysis.illumination",
    "IncidenceAngles": "lenstrace.analysis.illumination",
    "LateralColour": "lenstrace.analysis.colour",
    "LensTrade": "lenstrace.analysis.trade",
    "LongitudinalAberration": "lenstrace.analysis.colour",
    "Mtf": "lenstrace.analysis.mtf",
    "Optimized": "lenstrace.design",
    "Problem": "lenstrace.design",
    "Psf": "lenstrace.analysis.psf",
    "Seidel": "lenstrace.analysis.third_order",
    "ThroughFocus": "lenstrace.analysis.focus",
    "Wavefront": "lenstrace.analysis.wavefront",
    "axial_colour": "lenstrace.analysis.colour",
    "best_focus": "lenstrace.analysis.focus",
    "distortion": "lenstrace.analysis.distortion",
    "distortion_grid": "lenstrace.analysis.distortion",
    "dumps": "lenstrace.io.native",
    "encircled_energy": "lenstrace.analysis.encircled",
    "explore": "lenstrace.plotting.sliders",
    "fans": "lenstrace.analysis.fans",
    "field_curvature": "lenstrace.analysis.field_curvature",
    "fit_zernike": "lenstrace.analysis.zernike",
    "geometric_mtf": "lenstrace.analysis.mtf",
    "incidence_angles": "lenstrace.analysis.illumination",
    "lateral_colour": "lenstrace.analysis.colour",
    "layout": "lenstrace.analysis.layout",
    "lens": "lenstrace.sequential.prescription",
    "load": "lenstrace.io.native",
    "load_scene": "lenstrace.io.scene",
    "loads": "lenstrace.io.native",
    "longitudinal_aberration": "lenstrace.analysis.colour",
    "mtf": "lenstrace.analysis.mtf",
    "mtf_through_focus": "lenstrace.analysis.mtf",
    "optimize": "lenstrace.design",
    "plot_axial_colour": "lenstrace.plotting.field",
    "plot_demonstration": "lenstrace.plotting.demonstration",
    "plot_distortion": "lenstrace.plotting.field",
    "plot_distortion_grid": "lenstrace.plotting.field",
    "plot_encircled": "lenstrace.plotting.psf",
    "plot_fans": "lenstrace.plotting.fans",
    "plot_field_curvature": "lenstrace.plotting.field",
    "plot_first_order": "lenstrace.plotting.cardinal",
    "plot_focus_spots": "lenstrace.plotting.focus",
    "plot_illumination": "lenstrace.plotting.field",
    "plot_incidence_angles": "lenstrace.plotting.field",
    "plot_lateral_colour": "lenstrace.plotting.field",
    "plot_layout": "lenstrace.plotting.layout",
    "plot_longitudinal_aberration": "lenstrace.plotting.field",
    "plot_mtf": "lenstrace.plotting.mtf",
    "plot_mtf_field": "lenstrace.plotting.mtf",
    "plot_mtf_through_focus": "lenstrace.plotting.mtf",
    "plot_optimize": "lenstrace.plotting.optimize",
    "plot_picture": "lenstrace.plotting.picture",
    "plot_psf": "lenstrace.plotting.psf",
    "plot_rays": "lenstrace.plotting.rays",
    "plot_seidel": "lenstrace.plotting.aberrations",
    "plot_spot_field": "lenstrace.plotting.spot_curves",
    "plot_spot_spectrum": "lenstrace.plotting.spot_curves",
    "plot_spots": "lenstrace.plotting.spots",
    "plot_through_focus": "lenstrace.plotting.focus",
    "plot_trade": "lenstrace.plotting.trade",
    "plot_wavefront": "lenstrace.plotting.wavefront",
    "psf": "lenstrace.analysis.psf",
    "relative_illumination": "lenstrace.analysis.illumination",
    "render": "lenstrace.scene",
    "save": "lenstrace.io.native",
    "save_picture": "lenstrace.plotting.picture",
    "seidel": "lenstrace.analysis.aberrations",
    "sheet": "lenstrace.analysis.sheet",
    "spot_field": "lenstrace.analysis.spot_curves",
    "spot_spectrum": "lenstrace.analysis.spot_curves",
    "through_focus": "lenstrace.analysis.focus",
    "trade": "lenstrace.analysis.trade",
    "wave_focus": "lenstrace.analysis.wave_focus",
    "wavefront": "lenstrace.analysis.wavefront",
    "zernike": "lenstrace.optics.zernike",
    "zernike_coefficients": "lenstrace.analysis.wavefront",
}


def __getattr__(name: str) -> Any:
    if name not in _IMPORTED_WHEN_USED:
        raise AttributeError(f"module 'lenstrace' has no attribute {name!r}")
    value = getattr(importlib.import_module(_IMPORTED_WHEN_USED[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
