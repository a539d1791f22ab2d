"""Data as pytrees: what JAX takes for the same, and what it gives back."""

import itertools

import jax
import numpy as np

import lenstrace
from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.screens.lenses import IdealLens, QuadraticLens
from lenstrace.optics.screens.point_mass import PointMass


@pytree
class Pair:
    """Two leaves and a word."""

    first: float
    second: float
    word: str = static(default="a")


def test_structures_of_unlike_classes_are_not_equal() -> None:
    """Else the program compiled for one is run for the other."""
    screens = IdealLens(100.0), QuadraticLens(100.0), PointMass(100.0)
    for one, other in itertools.combinations(map(jax.tree.structure, screens), 2):
        assert one != other


def test_leaves_and_statics_come_back() -> None:
    pair = Pair(1.0, 2.0, "b")
    leaves, structure = jax.tree.flatten(pair)
    assert leaves == [1.0, 2.0]
    again = structure.unflatten([3.0, 4.0])
    assert (again.first, again.second, again.word) == (3.0, 4.0, "b")
    assert structure != jax.tree.structure(Pair(1.0, 2.0))
    assert [str(path[0]) for path, _ in jax.tree_util.tree_leaves_with_path(pair)] == [".first", ".second"]


def test_a_program_of_one_screen_is_not_run_for_another() -> None:
    """The ideal lens brings the rim to the axis at f, the quadratic one does not; asked in turn many times."""
    for kind, height in [("ideal_lens", 0.0), ("quadratic_lens", -1.4485451016575457)] * 3:
        row = {"thickness": 100.0, "stop": True, "screen": {kind: 100.0}}
        lens = lenstrace.lens([row], {"entrance_pupil_diameter": 60.0}, [0.0], [0.5])
        found = float(lenstrace.trace(lens, pupil=(0.0, 1.0), path=False).y)
        assert np.isclose(found, height, rtol=1e-12, atol=1e-12)
