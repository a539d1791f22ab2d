"""What a lens or a question does not need is not in its program: seen in what XLA compiled, not on a clock."""

import re
from collections import Counter
from functools import partial

import jax
import numpy as np
import pytest

import lenstrace
from lenstrace import Lens
from lenstrace.optics.rays import living
from lenstrace.sequential.trace import trace

ROWS = [
    {"radius": 23.0, "thickness": 3.0, "index": 1.5, "stop": True},
    {"radius": -41.0, "thickness": 1.5, "index": 1.6},
    {"radius": -130.0, "thickness": 30.0},
]
# What is added to the second surface, and an operation that it takes which the plain program does not have.
FEATURES = {
    "asphere": ({"asphere": {4: 1e-7, 6: 1e-9}}, "conditional"),
    "tilt": ({"tilt": [1.0, 0.0, 0.0]}, "cosine"),
    "aperture": ({"aperture": {"circle": 5.0}}, "conditional"),
    "mirror": ({"mirror": True}, "conditional"),
}


def doublet(**second: object) -> Lens:
    row = {**ROWS[1], **second}
    if "mirror" in second:
        del row["index"]
    return lenstrace.lens([ROWS[0], row, ROWS[2]], {"entrance_pupil_diameter": 8.0}, [0.0], [0.48, 0.55, 0.65])


def operations(lens: Lens, **asked: bool) -> Counter[str]:
    """How often the compiled trace of a thousand rays has each operation, those of its loops counted once."""
    x, one = np.linspace(-1, 1, 1000), np.ones(1000)
    ray = living(x, 0 * x, 0 * x, 0 * x, 0 * x, one)  # type: ignore[arg-type]
    if asked.pop("opl", False):
        ray = lenstrace.Ray(*(ray.x, ray.y, ray.z, ray.l, ray.m, ray.n), failure=ray.failure, opl=0 * ray.x)
    program = jax.jit(partial(trace, **asked)).lower(lens.system.at(0), ray).compile().as_text()
    return counted(program)


def counted(program: str | None) -> Counter[str]:
    """Of the text of a compiled program: results, which may be tuples, then the operation."""
    assert program is not None
    without_comments = re.sub(r"/\*.*?\*/", "", program)
    return Counter(re.findall(r"= (?:\([^=]*?\)|\S+) ([a-z][a-z-]*)\(", without_comments))


@pytest.fixture(scope="module")
def plain() -> Counter[str]:
    return operations(doublet())


def test_a_centred_lens_of_spheres_has_one_loop_and_no_branch(plain: Counter[str]) -> None:
    assert plain["while"] == 1
    for absent in ("conditional", "cosine", "sine", "power", "tan"):
        assert not plain[absent], absent
    # to the crossing, of the two indices (twice), and the bending: nothing else is divided
    assert plain["divide"] > 0
    assert plain["sqrt"] > 0


@pytest.mark.parametrize("feature", FEATURES)
def test_what_a_surface_has_is_paid_for_by_the_lenses_that_have_it(feature: str, plain: Counter[str]) -> None:
    row, operation = FEATURES[feature]
    found = operations(doublet(**row))
    assert found[operation] > plain[operation] == 0
    assert found.total() > 1.2 * plain.total()


@pytest.mark.parametrize("asked", [{"opl": True}, {"path": True}])
def test_what_is_asked_is_paid_for_by_those_who_ask(asked: dict[str, bool], plain: Counter[str]) -> None:
    assert operations(doublet(), **asked).total() > 1.02 * plain.total()


def test_numbers_that_do_not_matter_are_not_in_the_program(plain: Counter[str]) -> None:
    drawn = doublet(semi_diameter=5.0, name="second")
    assert operations(drawn) == plain
    # conics and spheres are one kind; a wavelength is chosen before the trace
    assert operations(doublet(conic=-0.3)) == plain
    alone = lenstrace.lens(ROWS, {"entrance_pupil_diameter": 8.0}, [0.0, 1.0], [0.55])
    assert operations(alone) == plain


def test_a_spot_traces_its_wavelengths_in_one_loop() -> None:
    """Of one wavelength or of three, the program has the trace once."""

    def spot(lens: Lens) -> Counter[str]:
        program = jax.jit(lambda c: lenstrace.spots(lens.replace(curvature=c), rings=2).rms_centroid)
        return counted(program.lower(lens.curvature).compile().as_text())

    three = spot(doublet())
    one = spot(lenstrace.lens(ROWS, {"entrance_pupil_diameter": 8.0}, [0.0], [0.55]))
    assert abs(three["sqrt"] - one["sqrt"]) <= 2
    assert three.total() < 1.2 * one.total()
