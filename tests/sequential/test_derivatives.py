"""Gradients of the spot by every number of a lens, against central differences; finite where they must be."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens
from lenstrace.optics.apertures import ApertureKind

QUICKLY = {"xla_backend_optimization_level": 0}  # what is called a few times compiles in a fifth of the time
ROWS = [
    {"radius": 30.0, "thickness": 5.0, "index": 1.6, "conic": -0.4, "asphere": {4: 2e-6, 6: 1e-9}},
    {"thickness": 8.0},
    {"radius": -25.0, "thickness": 2.0, "abbe": {"nd": 1.7, "vd": 30.0}, "asphere": {4: -5e-6}},
    {"radius": 40.0, "thickness": 5.0},
    {"thickness": 4.0, "stop": True},
    {"radius": 60.0, "thickness": 4.0, "index": 1.62, "tilt": [0.4, -0.3, 2.0], "decenter": [0.1, -0.2]},
    {"radius": -28.0, "thickness": 47.0, "asphere": {3: 1e-5}},
]


@pytest.fixture(scope="module")
def lens() -> Lens:
    """Plane, conic, aspheres, a tilted surface, a model glass."""
    return lenstrace.lens(ROWS, {"image_f_number": 6.0}, [3.0], [0.5, 0.6], image={"radius": -200.0})


def merit(lens: Lens) -> jax.Array:
    return jnp.sum(lenstrace.spots(lens, rings=2).rms_centroid)


at_once = jax.jit(jax.value_and_grad(merit), compiler_options=QUICKLY)


def test_gradient_by_every_number_of_the_rows(lens: Lens) -> None:
    value, gradient = at_once(lens)
    found, _ = jax.tree.flatten(gradient.rows)
    leaves, tree = jax.tree.flatten(lens.rows)
    assert len(leaves) == 7 * 3 + 2 + 1 + 1 + 5 + 4  # c, t, k of each row; asphere terms; the pose; indices
    for i, leaf in enumerate(leaves):
        # a step that moves the ray by about a micrometre, whatever the number is
        scale = 1 / max(float(abs(found[i])), 1e-9)
        step = min(2e-5 * scale * float(value), 0.05)
        moved = []
        for sign in (2, 1, -1, -2):
            changed = tree.unflatten([*leaves[:i], leaf + sign * step, *leaves[i + 1 :]])
            moved.append(float(at_once(dataclasses.replace(lens, rows=changed))[0]))
        difference = (8 * (moved[1] - moved[2]) - (moved[0] - moved[3])) / (12 * step)
        assert_allclose(found[i], difference, rtol=1e-6, atol=1e-9, err_msg=str(i))


def test_lost_rays_leave_gradients_finite() -> None:
    # half the rays of the second field miss the strong ball, some are clipped, some totally reflected
    rows = [
        {"radius": 6.0, "thickness": 12.0, "index": 1.9, "stop": True},
        {"radius": -6.0, "thickness": 2.0, "aperture": {"circle": 2.5}},
    ]
    ball = lenstrace.lens(rows, {"entrance_pupil_diameter": 13.0}, [0.0, 30.0], [0.55])
    spots = lenstrace.spots(ball)
    reasons = {status.name for field in (0, 1) for _, status in spots.losses(field, 0)}
    assert reasons >= {"MISSED", "CLIPPED"}
    _, gradient = at_once(ball)
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(gradient))


def test_gradient_at_a_perfect_spot_is_finite(designs: dict[str, Lens]) -> None:
    _, gradient = at_once(designs["negative_index_slab"])
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(gradient))


def test_curvature_gradient_of_a_flat_plate_against_the_exact_formula() -> None:
    # front of a plate 0 mm thick, image at distance d, axial parallel light at height h: y = h (1 - (n - 1) c d)
    rows = [{"thickness": 0.0, "index": 1.5, "stop": True}, {"thickness": 100.0}]
    plate = lenstrace.lens(rows, {"entrance_pupil_diameter": 2.0}, [0.0], [0.55])

    def height(c: jax.Array) -> jax.Array:
        return lenstrace.trace(plate.replace(surface=1, curvature=c), pupil=(0.0, 1.0), path=False).y

    assert_allclose(jax.jit(jax.grad(height), compiler_options=QUICKLY)(0.0), -0.5 * 100, rtol=1e-14)


def test_kinds_are_what_the_rows_need(lens: Lens) -> None:
    kinds = lens.system.kinds
    assert kinds[1].powers == ()
    assert kinds[0].powers == kinds[2].powers == (3, 4, 6)
    assert all(kind.aperture is ApertureKind.NONE for kind in kinds)
