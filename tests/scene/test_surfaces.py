"""Curved and implicit surfaces as a person says them: the same rays meet them as meet the shapes they are."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest

from lenstrace.errors import SceneError
from lenstrace.scene import Diffuse, Object, Pinhole, Scene, Sphere, View, render
from lenstrace.scene.build import world_of
from lenstrace.scene.hits import intersect
from lenstrace.scene.rays import NOWHERE, SceneRay
from lenstrace.scene.surfaces import asphere, conic, implicit

GREY = Diffuse(0.5)


def _met(shape: Any, point: np.ndarray, direction: np.ndarray) -> Any:
    world = world_of(Scene([Object(shape, GREY)]), np.float64)
    start = np.full(len(point), NOWHERE, np.int32)
    ray = SceneRay(tuple(point.T), tuple(direction.T), start)  # type: ignore[arg-type]
    return jax.jit(intersect)(world, jax.tree.map(np.asarray, ray))


@pytest.fixture(scope="module")
def rays() -> tuple[np.ndarray, np.ndarray]:
    """Toward a ball of radius 1 from outside it, some of which pass it."""
    random = np.random.default_rng(0)
    point = random.normal(size=(3000, 3))
    point *= 3 / np.linalg.norm(point, axis=1, keepdims=True)
    direction = random.uniform(-0.75, 0.75, (3000, 3)) - point
    return point, direction / np.linalg.norm(direction, axis=1, keepdims=True)


def test_an_implicit_ball_is_a_ball(rays: tuple[np.ndarray, np.ndarray]) -> None:
    ball, said = _met(Sphere(0.9), *rays), _met(implicit("x^2 + y^2 + z^2 - r^2", 1.0, {"r": 0.9}), *rays)
    met = np.asarray(ball.met)
    assert 0.3 < met.mean() < 0.97
    assert (np.asarray(said.met) == met).all()
    assert np.abs(np.asarray(said.distance - ball.distance))[met].max() < 1e-12
    assert max(np.abs(np.asarray(a - b))[met].max() for a, b in zip(said.normal, ball.normal, strict=True)) < 1e-12


def test_a_cap_of_radius_r_is_a_part_of_the_ball(rays: tuple[np.ndarray, np.ndarray]) -> None:
    """Its vertex at the origin, its centre at +z; a series of nothing changes nothing."""
    point, direction = rays
    moved = point + np.array([0, 0, 0.9])
    ball = _met(Sphere(0.9), point, direction)
    for shape in (conic(0.9, 0.5), asphere(0.9, 0.5, terms={4: 0.0})):
        cap = _met(shape, moved, direction)
        low = (np.asarray(ball.point[2]) < 0) & (np.hypot(*map(np.asarray, ball.point[:2])) < 0.5)
        both = np.asarray(ball.met & cap.met) & low
        assert both.sum() > 100
        assert (np.asarray(cap.met) | ~low | ~np.asarray(ball.met)).all()
        assert np.abs(np.asarray(cap.distance - ball.distance))[both].max() < 1e-12


def test_terms_are_added_to_the_sag() -> None:
    """Straight down at r = 0.5: z = a_4 r^4 + a_2 r^2 on a plane."""
    point, direction = np.array([[0.5, 0.0, 3.0], [0.0, 0.7, 3.0]]), np.array([[0.0, 0.0, -1.0]] * 2)
    cap = _met(asphere(np.inf, 0.6, terms={"4": 0.2, 2: -0.1}), point, direction)
    assert np.asarray(cap.met).tolist() == [True, False]
    assert float(cap.point[2][0]) == pytest.approx(0.2 / 16 - 0.1 / 4, abs=1e-14)


def test_other_constants_are_the_same_program() -> None:
    shapes = [implicit("x^2 + y^2 + z^2 - r^2", 1.0, {"r": r}) for r in (0.5, 0.7)]
    assert jax.tree.structure(shapes[0]) == jax.tree.structure(shapes[1])
    assert jax.tree.leaves(shapes[0])[-1] == 0.5


def test_bounds_that_do_not_hold_are_refused() -> None:
    ball = implicit("x^2 + y^2 + z^2 - 0.25", 1.0, steepness=2.0)
    with pytest.raises(SceneError, match=r"object 1: steepness 2 is too small: at \(.*\) the gradient is 3\.\d+ long"):
        world_of(Scene([Object(ball, GREY)]))
    with pytest.raises(SceneError, match=r"formula 'x \+ q': unknown name 'q'"):
        implicit("x + q", 1.0)
    with pytest.raises(SceneError, match=r"terms: a power must be a whole number from 1 on, got 1\.5"):
        asphere(1.0, 0.5, terms={1.5: 1.0})  # type: ignore[dict-item]
    with pytest.raises(SceneError, match="radius must not be 0"):
        conic(0.0, 0.5)
    with pytest.raises(SceneError, match="radius must be finite, got nan"):
        conic(np.nan, 0.5)
    with pytest.raises(SceneError, match="object 1: shape: ConicCap: surface Conic: conic must be a number, got 'k'"):
        world_of(Scene([Object(conic(1.0, 0.5, "k"), GREY)]))  # type: ignore[arg-type]
    with pytest.raises(SceneError, match=r"semi_diameter must be positive, got -0\.5"):
        asphere(1.0, -0.5, terms={4: 0.1})
    inside = Pinhole(View((0.0, 0.1, 0.0), (0.0, 0.0, 1.0)), 30.0)  # type: ignore[arg-type]
    with pytest.raises(SceneError, match="camera: stands inside object 1, a Implicit"):
        render(Scene([Object(implicit("x^2 + y^2 + z^2 - 0.25", 1.0), GREY)], environment=1.0), inside, size=(2, 2))
