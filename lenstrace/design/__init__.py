"""Lenses that design themselves: what may change, what is tied, what is wanted, and the search between them.

`from lenstrace.design import Curvature, SpotRMS` gives the words that a `lenstrace.Problem` is said in.
"""

from lenstrace.design.aberration_wants import AxialColour, Distortion, LateralColour, Petzval, SeidelSum
from lenstrace.design.custom import Custom
from lenstrace.design.first_order_wants import (
    BackFocalLength,
    FNumber,
    FocalLength,
    Magnification,
    ParaxialHeight,
    ParaxialSlope,
)
from lenstrace.design.geometry_wants import CentreThickness, EdgeThickness, TotalTrack
from lenstrace.design.glass_fit import GlassFit, fit_glasses
from lenstrace.design.optimize import optimize, optimize_from
from lenstrace.design.outcome import Minima, Optimized
from lenstrace.design.problem import Problem
from lenstrace.design.ray_wants import IncidenceAngle, RayAngle, RayHeight, TransverseError
from lenstrace.design.sensitivities import Sensitivities, Tolerances
from lenstrace.design.sensitivity import sensitivity
from lenstrace.design.spot_wants import SpotRMS
from lenstrace.design.ties import CurvatureSolve, Pickup, ThicknessSolve
from lenstrace.design.variables import Abbe, Asphere, Conic, Curvature, Decenter, Index, Thickness, Tilt
from lenstrace.design.wavefront_wants import WavefrontRMS

__all__ = [
    "Abbe",
    "Asphere",
    "AxialColour",
    "BackFocalLength",
    "CentreThickness",
    "Conic",
    "Curvature",
    "CurvatureSolve",
    "Custom",
    "Decenter",
    "Distortion",
    "EdgeThickness",
    "FNumber",
    "FocalLength",
    "GlassFit",
    "IncidenceAngle",
    "Index",
    "LateralColour",
    "Magnification",
    "Minima",
    "Optimized",
    "ParaxialHeight",
    "ParaxialSlope",
    "Petzval",
    "Pickup",
    "Problem",
    "RayAngle",
    "RayHeight",
    "SeidelSum",
    "Sensitivities",
    "SpotRMS",
    "Thickness",
    "ThicknessSolve",
    "Tilt",
    "Tolerances",
    "TotalTrack",
    "TransverseError",
    "WavefrontRMS",
    "fit_glasses",
    "optimize",
    "optimize_from",
    "sensitivity",
]
