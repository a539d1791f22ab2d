"""The trade of any question: errors, times, front, choice."""

import math
import time

import pytest

from lenstrace.accuracy.trade import Setting, trade
from lenstrace.errors import AccuracyError

# name, answer, seconds
ANSWERS = {
    "rough": (3.0, 0.0),
    "better": (3.1, 0.002),
    "slow and rough": (3.0, 0.004),
    "good": (3.1416, 0.006),
    "exact, slowly": (math.pi, 0.012),
}


def settings(names: tuple[str, ...] = tuple(ANSWERS)) -> list[Setting]:
    return [Setting(name, "made up", i, ANSWERS[name]) for i, name in enumerate(names)]


def answer(how: tuple[float, float]) -> float:
    time.sleep(how[1])
    return how[0]


def test_errors_times_and_front() -> None:
    found = trade(answer, settings(), math.pi, rounds=3)
    by_name = {each.setting.name: each for each in found.outcomes}
    assert by_name["better"].error == pytest.approx(math.pi - 3.1)
    assert by_name["better"].relative_error == pytest.approx(1 - 3.1 / math.pi)
    assert by_name["good"].seconds >= 0.006
    assert [each.setting.name for each in found.front] == ["rough", "better", "good", "exact, slowly"]
    assert found.complete
    assert found.chosen is None


@pytest.mark.parametrize(
    ("tolerance", "name"), [(0.1, "rough"), (0.02, "better"), (1e-5, "good"), (1e-9, "exact, slowly")]
)
def test_the_fastest_setting_within_the_tolerance_is_chosen(tolerance: float, name: str) -> None:
    chosen = trade(answer, settings(), math.pi, tolerance=tolerance, rounds=3).chosen
    assert chosen is not None
    assert chosen.setting.name == name


def test_none_is_chosen_where_none_is_accurate_enough() -> None:
    assert trade(answer, settings(("rough", "good")), math.pi, tolerance=1e-9, rounds=2).chosen is None


def test_a_floor_is_no_error() -> None:
    chosen = trade(answer, settings(("rough", "good")), math.pi, tolerance=1e-9, floor=1e-4, rounds=2).chosen
    assert chosen is not None
    assert chosen.setting.name == "good"


def test_a_truth_of_zero() -> None:
    zero, other = trade(lambda how: how, [Setting("0", "", 0, 0.0), Setting("1", "", 0, 1e-9)], 0.0, rounds=1).outcomes
    assert zero.relative_error == 0
    assert other.relative_error == math.inf
    assert zero.pareto


def test_an_answer_that_is_none_is_not_on_the_front() -> None:
    found = trade(lambda how: how, [Setting("none", "", 0, math.nan), Setting("one", "", 0, 1.0)], 1.0, rounds=1)
    assert [each.pareto for each in found.outcomes] == [False, True]


def test_an_interrupt_keeps_what_has_been_found() -> None:
    def interrupted(how: tuple[float, float]) -> float:
        if how is ANSWERS["good"]:
            raise KeyboardInterrupt
        return how[0]

    seen: list[tuple[int, int]] = []
    found = trade(interrupted, settings(), math.pi, progress=lambda done, total: seen.append((done, total)))
    assert [each.setting.name for each in found.outcomes] == ["rough", "better", "slow and rough"]
    assert not found.complete
    assert seen == [(1, 5), (2, 5), (3, 5)]


def test_what_cannot_be_asked() -> None:
    with pytest.raises(AccuracyError, match="tolerance must be a positive number"):
        trade(answer, settings(), math.pi, tolerance=-1.0)
    with pytest.raises(AccuracyError, match="at least one setting"):
        trade(answer, [], math.pi)
    with pytest.raises(AccuracyError, match="two settings have the name 'rough'"):
        trade(answer, settings(("rough", "rough")), math.pi)
