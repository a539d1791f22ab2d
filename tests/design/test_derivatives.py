"""The derivative of every want by every kind of variable, against differences; lost rays; what follows from numbers."""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lenstrace
from lenstrace import DesignError, Lens, Problem
from lenstrace.compute.packing import Packing, packed
from lenstrace.design import (
    Abbe,
    Asphere,
    AxialColour,
    BackFocalLength,
    CentreThickness,
    Conic,
    Curvature,
    CurvatureSolve,
    Custom,
    Decenter,
    Distortion,
    EdgeThickness,
    FNumber,
    FocalLength,
    IncidenceAngle,
    Index,
    LateralColour,
    Magnification,
    ParaxialHeight,
    ParaxialSlope,
    Petzval,
    Pickup,
    RayAngle,
    RayHeight,
    SeidelSum,
    SpotRMS,
    Thickness,
    ThicknessSolve,
    Tilt,
    TotalTrack,
    TransverseError,
    WavefrontRMS,
)
from lenstrace.design.merit import residuals
from lenstrace.design.problem import start_of
from lenstrace.design.ready import begun
from lenstrace.design.view import View

# Steps of differences, in the unit of each kind of number; of an asphere term relative to its effect at 6 mm.
STEPS = {
    **{"curvature": 1e-6, "thickness": 1e-3, "conic": 1e-3, "decenter": 1e-4, "tilt": 1e-4, "index": 1e-5, "abbe": 1e-2}
}


def length_by_hand(lens: Lens) -> jax.Array:
    return lenstrace.first_order(lens).focal_length[0] * 2


CENTRED = [Curvature([1, 4]), Thickness([2, 6]), Index([3]), Abbe([1])]
# of these every trace of every want becomes a larger program
SHAPED = [Conic([1]), Asphere([2], [4, 6]), Decenter([3], "xy"), Tilt([5], "xy")]
WANTS = [
    SpotRMS(rings=2),
    SpotRMS(polychromatic=True, about="chief", rings=2, field_weights=[1, 0, 2], wavelength_weights=[1, 0.5, 0]),
    WavefrontRMS(rings=2, reference="best", field_weights=[0, 1, 0], wavelength_weights=[1, 0, 0]),
    *[FocalLength(45.0), BackFocalLength(40.0), FNumber(4.0), TotalTrack(max=50.0)],
    *[ParaxialHeight(1.0, surface=7, ray="chief"), ParaxialSlope(0.1, surface=6)],
    RayHeight(17.0, field=14.0, pupil=(0.1, np.array([-0.5, 0.5]))),
    *[TransverseError(field=14.0, pupil=(0.0, 0.7)), RayAngle(10.0, field=14.0), IncidenceAngle(max=3.0, field=14.0)],
    *[SeidelSum(name=name) for name in ("distortion", "lateral_colour")],
    *[Petzval(), AxialColour(), LateralColour(), Distortion(), Magnification(-0.2)],
    *[CentreThickness(min=9.0, surfaces=[2, 4]), EdgeThickness(min=9.0, surfaces="all")],
    Custom(function=length_by_hand),
]
# One want of each way to follow rays, and those that know the shapes.
FEW_WANTS = [
    want for want in WANTS if isinstance(want, WavefrontRMS | RayHeight | FocalLength | SeidelSum | EdgeThickness)
]
FEW_WANTS += [SpotRMS(rings=2), Distortion()]


@pytest.fixture(scope="module")
def lens(designs: dict[str, Lens]) -> Lens:
    """The triplet in model glasses, near its object so that it has a magnification."""
    lens = designs["cooke_triplet"]
    for surface, nd, vd in ((1, 1.6204, 60.3), (3, 1.62, 36.4), (5, 1.6204, 60.3)):
        lens = lens.replace(surface=surface, abbe={"nd": nd, "vd": vd})
    fields = lenstrace.Fields((0.0,) * 3, (5.0, 14.0, 20.0), "angle")
    return lens.replace(object_distance=400.0, fields=fields)


@pytest.mark.parametrize(("variables", "wants"), [(CENTRED, WANTS), (SHAPED, FEW_WANTS)], ids=["centred", "shaped"])
def test_every_want_by_every_kind_of_variable(lens: Lens, variables: list, wants: list) -> None:
    """To 1e-6 of the largest slope of each want by that number, by differences of fourth order."""
    start = start_of(Problem(lens, vary=variables, want=wants))
    fixed, packing = packed(start.posed)
    numbers = start.numbers
    steps = np.eye(len(numbers))
    both = jax.jit(functools.partial(_both, packing, fixed))
    residual = np.asarray(both(numbers, steps[0])[0])
    ends = np.cumsum([0, *(_size(packing, fixed, numbers, i) for i in range(len(wants)))])
    assert ends[-1] == len(residual)
    for i, place in enumerate(start.posed.places):
        step = STEPS.get(place.kind, 4e-5 * 6.0 ** (1 - place.part))
        column = np.asarray(both(numbers, steps[i])[1])
        assert np.all(np.isfinite(column))
        rise = [np.asarray(both(numbers + k * step * steps[i], steps[i])[0]) for k in (-2, -1, 1, 2)]
        slope = (rise[0] - 8 * rise[1] + 8 * rise[2] - rise[3]) / (12 * step)
        for want, first, last in zip(wants, ends[:-1], ends[1:], strict=True):
            exact, near = column[first:last], slope[first:last]
            # of rounding; of paths, in waves, more
            noise = 1e-13 * max(np.max(np.abs(residual[first:last])), 10 if want.unit == "waves" else 0) / step
            assert np.max(np.abs(exact - near)) <= 1e-6 * np.max(np.abs(exact)) + noise, (place.label, want)


def _both(packing: Packing, fixed: np.ndarray, numbers: jax.Array, direction: jax.Array) -> tuple[jax.Array, jax.Array]:
    """The residuals, and how they change in a direction."""
    return jax.jvp(lambda p: residuals(packing, fixed, p)[0], (numbers,), (direction,))


def _size(packing: Packing, fixed: np.ndarray, numbers: np.ndarray, want: int) -> int:
    """How many residuals one of the wants has."""

    def of_one(fixed: jax.Array, p: jax.Array) -> jax.Array:
        posed = packing.unpacked(fixed)
        return posed.wants[want].measured(View(posed.lens_of(jnp.unstack(p)))).residual

    return jax.eval_shape(of_one, fixed, numbers).size


def test_ties_hold_while_the_numbers_change(lens: Lens) -> None:
    """Symmetry by a pickup, focal length by a curvature, the paraxial image by the last gap; and their slopes."""
    ties = [
        Pickup("curvature", 4, of=3, scale=-1.0),
        ThicknessSolve(4, height=4.0),
        CurvatureSolve(6, focal_length=50.0),
        ThicknessSolve(6),
    ]
    lens = lens.replace(object_distance=None)
    want = [SpotRMS(rings=2), FocalLength(50.0)]
    ready = begun(Problem(lens, vary=[Curvature([1, 3]), Thickness(2)], want=want, tie=ties))
    with pytest.raises(DesignError, match="curvature 6: a tie that is taken later"):
        begun(Problem(lens, vary=[Thickness(2)], want=want, tie=[ties[2], ties[1]]))
    found = ready.start.posed.lens_of([0.05, -0.04, 5.0])
    assert found[4].curvature == pytest.approx(0.04, rel=1e-15)
    first = lenstrace.first_order(found)
    primary = found.wavelengths.primary
    assert float(first.focal_length[primary]) == pytest.approx(50.0, rel=1e-12)
    assert found[6].thickness == pytest.approx(float(first.back_focal_length[primary]), rel=1e-12)
    assert ready.before.value[-1] == pytest.approx(50.0, rel=1e-12)
    numbers = np.array([0.05, -0.04, 5.0])
    value = functools.partial(lambda merit, p: float(merit.gradient(p)[0]), ready.merit)
    for i, step in enumerate((1e-6, 1e-6, 1e-4)):
        move = step * np.eye(3)[i]
        near, far = (value(numbers + k * move) - value(numbers - k * move) for k in (1, 2))
        assert float(ready.merit.gradient(numbers)[1][i]) == pytest.approx((8 * near - far) / (12 * step), rel=1e-6)


def test_a_lost_ray_poisons_nothing_and_is_pulled_back() -> None:
    """A ball so strong that the rim misses it: the merit is finite, its gradient is that of differences, and the search
    brings all rays back."""
    lens = lenstrace.lens(
        [{"radius": 9.0, "thickness": 6.0, "index": 1.6, "stop": True}, {"radius": -9.0, "thickness": 12.0}],
        {"entrance_pupil_diameter": 20.0},
        [0.0, 5.0],
        [0.5876],
    )
    assert int(np.sum(lenstrace.spots(lens).lost)) > 0
    problem = Problem(lens, vary=[Curvature("all"), Thickness(2)], want=[SpotRMS(), FocalLength(25.0, weight=0.1)])
    ready = begun(problem)
    value, slope = ready.merit.gradient(ready.start.numbers)
    assert np.isfinite(float(value))
    for i, step in enumerate((1e-7, 1e-7, 1e-5)):
        ends = [float(ready.merit.gradient(ready.start.numbers + k * step * np.eye(3)[i])[0]) for k in (1, -1)]
        assert float(slope[i]) == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-4)
    found = lenstrace.optimize(problem)
    assert int(np.sum(lenstrace.spots(found.lens).lost)) == 0
    assert found.improved
    assert found.merit_after < 0.1 * found.merit_before
