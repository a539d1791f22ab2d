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
from lenstrace.design.optimize import optimize
from lenstrace.design.outcome import Optimized
from lenstrace.design.problem import Problem
from lenstrace.design.ray_wants import IncidenceAngle, RayAngle, RayHeight, TransverseError
from lenstrace.design.spot_wants import SpotRMS, WavefrontRMS
from lenstrace.design.ties import CurvatureSolve, Pickup, ThicknessSolve
from lenstrace.design.variables import Abbe, Asphere, Conic, Curvature, Decenter, Index, Thickness, Tilt

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
    "IncidenceAngle",
    "Index",
    "LateralColour",
    "Magnification",
    "Optimized",
    "ParaxialHeight",
    "ParaxialSlope",
    "Petzval",
    "Pickup",
    "Problem",
    "RayAngle",
    "RayHeight",
    "SeidelSum",
    "SpotRMS",
    "Thickness",
    "ThicknessSolve",
    "Tilt",
    "TotalTrack",
    "TransverseError",
    "WavefrontRMS",
    "optimize",
]
