"""Searches: minima that other programs know, the evidence, weights, interruptions, honest failure."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.optimize import least_squares

import lenstrace
from lenstrace import Optimized, Problem
from lenstrace.design import Conic, Curvature, Custom, FocalLength, SpotRMS, Thickness, TotalTrack
from lenstrace.design.merit import programs
from lenstrace.design.ready import begun
from lenstrace.design.search import Step

# Of the reference problem: the least merit that several solvers agree on, mm^2.
LEAST_A, LEAST_B = 1.3868265e-3, 7.36943e-5


@pytest.fixture(scope="module")
def triplet(problem_a: Problem) -> Optimized:
    return lenstrace.optimize(problem_a)


def test_the_triplet_comes_to_its_minimum(problem_a: Problem, triplet: Optimized) -> None:
    assert triplet.merit_before == pytest.approx(33.6e-3, rel=2e-3)
    assert triplet.merit_after == pytest.approx(LEAST_A, rel=1e-6)
    assert triplet.improved
    assert triplet.arrived
    assert triplet.message == "a minimum"
    assert problem_a.lens[1].radius == pytest.approx(0.97 * 22.01359)  # the start is as it was


def test_the_merit_is_that_of_the_lens_as_analysis_sees_it(problem_a: Problem, triplet: Optimized) -> None:
    spots = np.asarray(lenstrace.spots(triplet.lens).rms_centroid)
    primary = triplet.lens.wavelengths.primary
    length = float(lenstrace.first_order(triplet.lens).focal_length[primary])
    target = problem_a.want[1].target  # type: ignore[attr-defined]
    assert np.sum(spots**2) + (length - target) ** 2 == pytest.approx(triplet.merit_after, rel=1e-9)
    assert [term.after for term in triplet.terms[:9]] == pytest.approx(spots.ravel(), rel=1e-9)
    assert "RMS spot, field 14 deg, 0.65 um" in triplet.table()


@pytest.mark.parametrize("method", ["least_squares", "lbfgs"])
def test_the_double_gauss_comes_to_its_minimum(problem_b: Problem, method: str) -> None:
    found = lenstrace.optimize(problem_b, method=method)
    assert found.merit_after == pytest.approx(LEAST_B, rel=1e-5)
    gaps = [found.lens[n].thickness for n in (2, 5, 6, 9)]
    assert min(gaps) >= 0.1
    assert [change.name for change in found.changes if change.at_bound == "least"] == ["thickness 2", "thickness 9"]


def test_other_solvers_find_the_same_minimum(problem_a: Problem) -> None:
    """L-BFGS with gradients in reverse, and MINPACK's Levenberg-Marquardt from another start."""
    assert lenstrace.optimize(problem_a, method="lbfgs").merit_after == pytest.approx(LEAST_A, rel=1e-6)
    ready = begun(problem_a)
    at_start = ready.merit.evaluated(ready.start.numbers)
    slope = 2 * np.asarray(at_start.jacobian).T @ np.asarray(at_start.residual)
    assert np.asarray(ready.merit.gradient(ready.start.numbers)[1]) == pytest.approx(slope, rel=1e-10)
    elsewhere = ready.start.numbers * (1 + 0.01 * np.array([1, -1, 1, 1, -1, 1, -1, 1, 0]))
    found = least_squares(
        lambda p: np.asarray(ready.merit.evaluated(p).residual),
        elsewhere,
        jac=lambda p: np.asarray(ready.merit.evaluated(p).jacobian),  # pyright: ignore[reportArgumentType]
        method="lm",
        x_scale="jac",
        xtol=1e-14,
        ftol=1e-14,
    )
    assert 2 * found.cost == pytest.approx(LEAST_A, rel=1e-6)


def test_a_weight_three_times_as_large_makes_a_term_nine_times_as_large(problem_a: Problem) -> None:
    def terms(weight: float) -> np.ndarray:
        want = [SpotRMS(), FocalLength(49.0, weight=weight)]
        return np.asarray(begun(dataclasses.replace(problem_a, want=want)).before.merit)

    assert terms(3.0)[-1] == pytest.approx(9 * terms(1.0)[-1], rel=1e-14)
    assert terms(3.0)[:-1] == pytest.approx(terms(1.0)[:-1], rel=1e-14)


def test_nothing_is_compiled_anew_for_other_numbers(problem_a: Problem, triplet: Optimized) -> None:
    assert triplet.improved
    before = programs.cache_info().misses
    other = Problem(
        problem_a.lens.replace(surface=1, radius=25.0),
        vary=[Curvature([1, 2, 3, 4, 5, 6]), Thickness([2, 4], bounds=(0.5, 12.0)), Thickness("last")],
        want=[SpotRMS(weight=2.0), FocalLength(48.0, weight=5.0)],
    )
    assert lenstrace.optimize(other).improved
    assert programs.cache_info().misses == before


def test_a_plane_leaves_flatness(designs: dict[str, lenstrace.Lens]) -> None:
    lens = designs["plano_convex_plane_first"]
    lens = lens.replace(fields=lenstrace.Fields((0.0,), (0.0,), "angle"), wavelengths=lens.wavelengths.primary_alone)
    flat = [n for n, row in enumerate(lens, 1) if row.curvature == 0]
    assert flat
    found = lenstrace.optimize(
        Problem(lens, vary=[Curvature("all"), Thickness("last")], want=[SpotRMS(), FocalLength(100.0)])
    )
    assert abs(found.lens[flat[0]].curvature) > 1e-3
    assert found.merit_after < 0.5 * found.merit_before


def test_a_start_that_cannot_be_improved_is_not_called_a_success(triplet: Optimized, problem_a: Problem) -> None:
    again = lenstrace.optimize(dataclasses.replace(problem_a, lens=triplet.lens))
    assert not again.improved
    assert "not improved" in again.message
    assert again.lens == triplet.lens
    deaf = lenstrace.optimize(Problem(problem_a.lens, vary=[Conic([4])], want=[FocalLength(40.0)]))
    assert not deaf.improved
    assert deaf.merit_after == deaf.merit_before


def test_ctrl_c_and_the_end_of_the_time_give_the_best_so_far(problem_a: Problem) -> None:
    def stop(number: int, step: Step) -> None:
        assert step.best <= step.merit
        if number == 5:
            raise KeyboardInterrupt

    stopped = lenstrace.optimize(problem_a, progress=stop)
    assert stopped.interrupted
    assert not stopped.arrived
    assert stopped.improved
    assert stopped.merit_after == pytest.approx(min(step.merit for step in stopped.history), rel=1e-12)
    late = lenstrace.optimize(problem_a, seconds=1e-6)
    assert late.steps == 1
    assert "the time" in late.message


def test_a_function_of_the_lens_is_wanted(designs: dict[str, lenstrace.Lens]) -> None:
    lens = designs["cooke_triplet"]

    def front_to_back(lens: lenstrace.Lens) -> object:
        return lens.thickness[0] / lens.thickness[2]

    want = [Custom(function=front_to_back, target=2.0, label="ratio of thicknesses"), TotalTrack(max=60.0)]
    found = lenstrace.optimize(Problem(lens, vary=[Thickness([1, 3])], want=want))
    assert found.lens[1].thickness / found.lens[3].thickness == pytest.approx(2.0, rel=1e-9)
    assert sum(row.thickness for row in found.lens) <= 60.0 + 1e-6


def test_the_bending_of_a_thin_lens_for_least_spherical_aberration() -> None:
    """q = -2 (n^2 - 1) p / (n + 2), p = -1 for light from infinity: 0.714 for n = 1.5. Source: Jenkins & White,
    Fundamentals of Optics, section 9.3; a lens 0.01 mm thick of 100 mm is thin to 1e-4."""
    lens = lenstrace.lens(
        [{"radius": 100.0, "thickness": 0.01, "index": 1.5, "stop": True}, {"radius": -100.0, "thickness": 100.0}],
        {"entrance_pupil_diameter": 5.0},
        [0.0],
        [0.5876],
    )
    want = [lenstrace.design.SeidelSum(name="spherical"), FocalLength(100.0)]
    found = lenstrace.optimize(Problem(lens, vary=[Curvature("all")], want=want)).lens
    q = (found[2].radius + found[1].radius) / (found[2].radius - found[1].radius)
    assert q == pytest.approx(2 * (1.5**2 - 1) / (1.5 + 2), abs=1e-3)
