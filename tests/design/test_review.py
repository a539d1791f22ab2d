"""Small things that users would have met: lists, mirrors, bounds on one side, lost rays, what is not improved."""

from pathlib import Path

import numpy as np
import pytest

import lenstrace
from lenstrace import Problem
from lenstrace.design import (
    AxialColour,
    CentreThickness,
    Curvature,
    CurvatureSolve,
    Distortion,
    FNumber,
    FocalLength,
    LateralColour,
    RayAngle,
    RayHeight,
    SeidelSum,
    SpotRMS,
    Thickness,
    ThicknessSolve,
    TotalTrack,
    WavefrontRMS,
    optimize,
    optimize_from,
    sensitivity,
)
from lenstrace.design.batch import Minimum
from lenstrace.design.problem import start_of
from lenstrace.design.ready import begun
from lenstrace.design.starts import distinct
from lenstrace.errors import DesignError

DESIGNS = Path(__file__).parents[2] / "designs"


@pytest.fixture(scope="module")
def triplet():
    return lenstrace.load(DESIGNS / "cooke_triplet.toml")


@pytest.fixture(scope="module")
def mirror():
    """A concave mirror of f/5: radius -100, f = 50 in front of it."""
    return lenstrace.loads(
        """
        [aperture]
        entrance_pupil_diameter = 10.0
        [fields]
        kind = "angle"
        y = [0.0, 1.0]
        [wavelengths]
        um = [0.55]
        [lens]
        surfaces = [{ radius = -100, thickness = -50, mirror = true, stop = true }]
        """
    )


def figures(lens, *wants):
    """What wants measure of a lens, in turn."""
    ready = begun(Problem(lens, vary=[Thickness("last")], want=list(wants)))
    return np.asarray(ready.before.value)


def test_lists_are_numbers_for_each_term(triplet):
    as_list, as_array = (
        begun(Problem(triplet, vary=[Curvature("all")], want=[SpotRMS(weight=kind([float(i) for i in range(1, 10)]))]))
        for kind in (list, np.array)
    )
    np.testing.assert_array_equal(as_list.before.merit, as_array.before.merit)
    two = RayHeight(target=[10.0, 12.0], field=np.array([0.5, 1.0]))
    assert len(figures(triplet, two)) == 2


def test_f_numbers_of_mirrors_are_positive(mirror):
    assert figures(mirror, FNumber(5.0))[0] == pytest.approx(5.0, rel=1e-12)
    solved = optimize(Problem(mirror, vary=[Thickness(1)], tie=[CurvatureSolve(1, f_number=5.0)], want=[SpotRMS()]))
    assert float(solved.lens[1].curvature) == pytest.approx(-1 / 100, rel=1e-9)
    found = optimize(Problem(mirror.replace(surface=1, radius=-90.0), vary=[Curvature(1)], want=[FNumber(5.0)]))
    assert float(found.lens[1].curvature) == pytest.approx(-1 / 100, rel=1e-6)


def test_angles_and_track_behind_a_mirror(mirror):
    angles = figures(mirror, RayAngle(target=0.0, field=0.0, pupil=(0.0, np.array([-1.0, 0.0, 1.0]))))
    # light that is 5 mm above the axis comes to it within 50 mm less the sag
    expected = np.degrees(np.arctan(5 / (50 - 5**2 / 200)))
    np.testing.assert_allclose(np.abs(angles), [expected, 0, expected], rtol=2e-3, atol=1e-9)
    assert figures(mirror, TotalTrack(max=0.0))[0] == pytest.approx(-50.0)


def test_wants_measure_what_the_analyses_do(triplet):
    waves = lenstrace.wavefront(triplet)
    np.testing.assert_allclose(figures(triplet, WavefrontRMS()), np.asarray(waves.rms).ravel(), rtol=2e-3)
    third = lenstrace.seidel(triplet)
    found = figures(triplet, SeidelSum(name="spherical"), SeidelSum(name="coma"))
    np.testing.assert_allclose(found, [float(third.total.spherical), float(third.total.coma)], rtol=1e-9)


def test_what_is_not_improved_keeps_its_ties(triplet):
    """The last gap is solved, nothing else helps: the lens that is given is the one whose merit is told."""
    moved = triplet.replace(surface=6, thickness=40.0)
    problem = Problem(moved, vary=[Thickness(3)], tie=[ThicknessSolve(6)], want=[FocalLength(min=1.0)])
    found = optimize(problem)
    assert not found.improved
    assert float(found.lens[6].thickness) == pytest.approx(
        float(lenstrace.first_order(triplet).back_focal_length[1]), rel=1e-6
    )


def test_bounds_on_one_side_leave_room_for_random_starts(triplet):
    problem = Problem(triplet, vary=[Curvature(1, bounds=(0.06, None)), Thickness("last")], want=[SpotRMS()])
    problem = Problem(triplet.replace(surface=1, radius=15.0), vary=problem.vary, want=problem.want)
    minima = optimize_from(problem, 4, seed=1)
    assert all(float(each.lens[1].curvature) >= 0.06 for each in minima)


def test_ends_that_are_no_numbers_do_not_disturb_the_order(triplet):
    start = start_of(Problem(triplet, vary=[Curvature(1)], want=[SpotRMS()]))
    ends = [Minimum(start.numbers + 0.01 * i, merit, i) for i, merit in enumerate([3.0, np.nan, 1.0, np.nan, 2.0])]
    assert [each.merit for each in distinct(ends, start)] == [1.0, 2.0, 3.0]


def test_gradients_end_at_a_merit_of_nothing(triplet):
    found = optimize(Problem(triplet, vary=[Thickness(1)], want=[CentreThickness(4.0, surfaces=[1])]), method="lbfgs")
    assert found.arrived
    assert found.merit_after < 1e-20


def test_a_wavelength_of_its_own_may_be_wanted():
    lens = lenstrace.load(DESIGNS / "double_gauss.toml")
    at = figures(lens, RayHeight(target=0.0, field=float(lens.fields.y[-1]), wavelength=0.5))
    path = lenstrace.trace(lens, field=float(lens.fields.y[-1]), pupil=(0.0, 0.0), wavelength=0.5)
    assert at[0] == pytest.approx(float(np.asarray(path.y)[-1]), rel=1e-9)


def test_lost_rays_of_the_design_are_no_spot():
    ball = lenstrace.load(DESIGNS / "ball_lens.toml")
    wide = ball.replace(aperture=lenstrace.Aperture(2.2 / abs(float(ball[1].curvature)), "entrance_pupil_diameter"))
    spots = lenstrace.spots(wide)
    assert np.any(np.asarray(spots.lost) > 0)
    told = sensitivity(wide)
    np.testing.assert_allclose(told.spots[0], np.asarray(spots.polychromatic.rms_centroid)[0], rtol=0.1)


@pytest.mark.parametrize(
    ("more", "words"),
    [({"starts": 2, "method": "magic"}, "method"), ({"starts": 2, "method": "lbfgs"}, "starts: many searches")],
)
def test_what_many_searches_do_not_know_is_refused(triplet, more, words):
    with pytest.raises(DesignError, match=words):
        optimize(Problem(triplet, vary=[Curvature(1)], want=[SpotRMS()]), **more)
    with pytest.raises(DesignError, match="keep"):
        optimize_from(Problem(triplet, vary=[Curvature(1)], want=[SpotRMS()]), 2, keep=0)


def test_unused_analyses_agree(triplet):
    """Distortion and colours of the largest field, as the analyses give them."""
    field = float(triplet.fields.y[-1])
    assert figures(triplet, Distortion())[0] == pytest.approx(
        float(np.asarray(lenstrace.distortion(triplet).percent)[-1]), rel=1e-6
    )
    lateral = lenstrace.lateral_colour(triplet)
    assert abs(figures(triplet, LateralColour())[0]) == pytest.approx(
        float(np.ptp(np.asarray(lateral.height)[-1, [0, -1]])), rel=1e-6
    )
    assert field > 0
    assert np.isfinite(figures(triplet, AxialColour())[0])
