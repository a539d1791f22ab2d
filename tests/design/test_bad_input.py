"""Problems that cannot be posed: one clear line each."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import lenstrace
from lenstrace import Lens, LensTraceError, Problem
from lenstrace.design import (
    Abbe,
    Asphere,
    AxialColour,
    Curvature,
    CurvatureSolve,
    Custom,
    EdgeThickness,
    FocalLength,
    Index,
    Magnification,
    Pickup,
    RayHeight,
    SeidelSum,
    SpotRMS,
    Thickness,
    ThicknessSolve,
    Tilt,
    Tolerances,
    TotalTrack,
    TransverseError,
    WavefrontRMS,
    fit_glasses,
    optimize_from,
    sensitivity,
)

SPOT, CURVED = [SpotRMS()], [Curvature([1, 2])]
MISTAKES: list[tuple[Callable[[Lens], Any], str]] = [
    (lambda lens: Problem(lens, [], SPOT), "vary: nothing may change"),
    (lambda lens: Problem(lens, CURVED, []), "want: nothing is wanted"),
    (lambda lens: Problem(lens, [*CURVED, Curvature(2)], SPOT), "curvature 2 is named twice"),
    (lambda lens: Problem(lens, [Curvature(9)], SPOT), "curvature: surface 9 does not exist"),
    (
        lambda lens: Problem(lens, [Curvature("first")], SPOT),
        "curvature: surfaces must be numbers, or one of all, last",
    ),
    (lambda lens: Problem(lens, [Thickness(2, bounds=(3.0, 1.0))], SPOT), r"thickness: bounds must rise, got \(3, 1\)"),
    (lambda lens: Problem(lens, [Asphere(1, powers=[])], SPOT), "asphere: powers must be whole numbers"),
    (lambda lens: Problem(lens, [Tilt(1, axes="w")], SPOT), "tilt: axes must be some of 'xyz', got 'w'"),
    (lambda lens: Problem(lens, CURVED, [42]), "want: 42 is no want"),  # type: ignore[list-item]
    (lambda lens: Problem(lens, [42], SPOT), "vary: 42 is no variable"),  # type: ignore[list-item]
    (lambda lens: Problem(lens, CURVED, SPOT, [Pickup("curvature", 1, of=1)]), "curvature 1 cannot follow itself"),
    (
        lambda lens: Problem(lens, CURVED, SPOT, [Pickup("curvature", 1, of=3)]),
        "curvature 1 is tied, and cannot vary too",
    ),
    (
        lambda lens: Problem(lens, CURVED, SPOT, [Pickup("curvature", 3, of=4), Pickup("curvature", 4, of=3)]),
        "curvature 3 follows curvature 4, which is tied after it",
    ),
    (lambda lens: Problem(lens, CURVED, SPOT, [CurvatureSolve(6)]), "give focal_length or f_number, one of the two"),
    (lambda lens: Problem(lens, CURVED, SPOT, [ThicknessSolve(1, ray="chief")]), "before the stop, surface 4"),
    (
        lambda lens: _start(lens, [Thickness(2, bounds=(7.0, 9.0))], SPOT),
        r"thickness 2: the start, 6.00755 mm, lies outside its bounds \(7, 9\)",
    ),
    (lambda lens: _start(lens, [Index(2)], SPOT), "index 2: air or a mirror is behind this surface"),
    (
        lambda lens: _start(lens, CURVED, [FocalLength()]),
        "FocalLength: nothing is wanted of it; give target, min or max",
    ),
    (lambda lens: _start(lens, CURVED, [FocalLength("50")]), "FocalLength: target must be a finite number, got '50'"),
    (lambda lens: _start(lens, CURVED, [FocalLength([50, 51])]), "FocalLength: target must be one number; got"),
    (lambda lens: _start(lens, CURVED, [SpotRMS(weight=[1, 2, 3])]), "SpotRMS: weight must be one number, or 9"),
    (lambda lens: _start(lens, CURVED, [RayHeight(1.0, axis="z")]), "RayHeight: axis must be x or y, got 'z'"),  # type: ignore[arg-type]
    (lambda lens: _start(lens, CURVED, [RayHeight(1.0, pupil=1.0)]), "RayHeight: pupil must be a pair"),
    (lambda lens: _start(lens, CURVED, [RayHeight(1.0, wavelength="d")]), "wavelength must be a number of micrometres"),  # type: ignore[arg-type]
    (lambda lens: _start(lens, CURVED, [TransverseError(surface=3)]), "it is an error on the image"),
    (lambda lens: Problem(lens, [Curvature(1.5)], SPOT), "curvature: surfaces must be whole numbers, got 1.5"),  # type: ignore[arg-type]
    (lambda lens: Problem(lens, CURVED, SPOT, SPOT), "is no tie; they are Pickup"),  # type: ignore[arg-type]
    (
        lambda lens: Problem(lens, CURVED, SPOT, [Pickup("curvature", 3, of=4, scale="a")]),
        "scale must be one finite number",
    ),
    (lambda lens: lenstrace.optimize(lens), "a lenstrace.Problem is needed, got Lens"),  # type: ignore[call-overload]
    (
        lambda lens: _start(lens.replace(surface=4, aperture={"circle": 1e-9}), CURVED, SPOT),
        "SpotRMS: apertures stop all rays of field",
    ),
    (lambda lens: fit_glasses(Problem(lens, [Abbe(1)], SPOT)), "nothing but glasses varies"),
    (lambda lens: _start(lens, CURVED, [FocalLength(min=60, max=50)]), "FocalLength: min must not be above max"),
    (lambda lens: _start(lens, CURVED, [FocalLength(40, min=50)]), "the target 40 lies outside min = 50"),
    (
        lambda lens: _start(lens, CURVED, [TotalTrack(float("nan"))]),
        "TotalTrack: target must be a finite number, got nan",
    ),
    (lambda lens: _start(lens, CURVED, [SpotRMS(weight=0.0)]), "SpotRMS: weight must be positive, got 0.0"),
    (lambda lens: _start(lens, CURVED, [SpotRMS(about="middle")]), "SpotRMS: about must be one of centroid, chief"),
    (lambda lens: _start(lens, CURVED, [SpotRMS(field_weights=[1, 1])]), "field_weights must be 3 numbers"),
    (lambda lens: _start(lens, CURVED, [WavefrontRMS(reference="x")]), "unknown reference 'x'"),
    (lambda lens: _start(lens, CURVED, [Magnification(-1.0)]), "Magnification: the object is at infinity"),
    (lambda lens: _start(lens, CURVED, [SeidelSum(name="blur")]), "SeidelSum: name must be one of spherical"),
    (lambda lens: _start(lens, CURVED, [RayHeight(1.0, surface=8)]), "RayHeight: surface must be a number from 1 to 7"),
    (lambda lens: _start(lens, CURVED, [RayHeight(1.0, field=95.0, pupil=(0.0,))]), "RayHeight: "),
    (lambda lens: _start(lens, CURVED, [EdgeThickness(min=1.0, surfaces=[])]), "EdgeThickness: there is no gap"),
    (lambda lens: _start(lens, CURVED, [Custom(function=3)]), "Custom: function must take a lens"),  # type: ignore[arg-type]
    (lambda lens: _start(lens, CURVED, [Custom(function=lambda each: float(each[1].radius))]), "JAX traces"),
    (
        lambda lens: _start(lens, CURVED, [Custom(function=lambda _: float("nan"))]),
        "the function gives nan at the start",
    ),
    (
        lambda lens: _start(lens.replace(wavelengths=lens.wavelengths.primary_alone), CURVED, [AxialColour()]),
        "the lens has one wavelength; colour needs two",
    ),
    (
        lambda lens: _start(lens.replace(curvature=[0.0] * 6), CURVED, [FocalLength(50)]),
        "FocalLength: the lens is afocal",
    ),
    (
        lambda lens: _start(lens.replace(surface=1, aperture={"obscuration": 90.0}), CURVED, SPOT),
        "SpotRMS: all rays of the start are lost",
    ),
    (
        lambda lens: lenstrace.optimize(Problem(lens, CURVED, SPOT), method="magic"),
        "method must be one of least_squares, lbfgs, got 'magic'",
    ),
    (lambda lens: lenstrace.optimize(Problem(lens, CURVED, SPOT), seconds=-1), "seconds must be positive, got -1"),
    (lambda lens: optimize_from(Problem(lens, CURVED, SPOT), 0), "starts must be at least 1"),
    (lambda lens: optimize_from(Problem(lens, CURVED, SPOT), [[1.0]]), "an array of 2 finite numbers for each start"),
    (lambda lens: fit_glasses(Problem(lens, CURVED, SPOT)), "no glass varies"),
    (
        lambda lens: fit_glasses(Problem(lens, [Abbe(1), *CURVED], SPOT), "NOBODY"),
        "glass catalogue 'NOBODY' is not known",
    ),
    (lambda lens: sensitivity(lens, Tolerances(tilt=-1.0)), "tolerance tilt must be a number, 0 or more"),
    (lambda lens: sensitivity(lens.replace(curvature=[0.0] * 6)), "sensitivity: the lens is afocal"),
]


def _start(lens: Lens, vary: Any, want: Any) -> None:
    lenstrace.optimize(Problem(lens, vary, want))


@pytest.fixture(scope="module")
def lens(designs: dict[str, Lens]) -> Lens:
    """The triplet at wavelengths at which model glasses are known."""
    return designs["cooke_triplet"]


@pytest.mark.parametrize(("mistake", "said"), MISTAKES, ids=[said[:40] for _, said in MISTAKES])
def test_a_mistake_is_said_in_a_line(lens: Lens, mistake: Callable[[Lens], Any], said: str) -> None:
    with pytest.raises(LensTraceError, match=said) as caught:
        mistake(lens)
    assert "\n" not in str(caught.value)
