"""Light that is counted once and only once: by every method, of lamps that move, on long ways, at every scale."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest

import lenstrace
from lenstrace import AccuracyWarning
from lenstrace.scene import (
    Dielectric,
    Diffuse,
    DistantLight,
    Object,
    Orthographic,
    Pinhole,
    Plane,
    PointLight,
    Rectangle,
    RoughConductor,
    RoughDielectric,
    Scene,
    Sphere,
    View,
    implicit,
)
from lenstrace.scene.materials.rough_conductor import metal_reflectance

LAMP = Object(Rectangle(1, 1), Diffuse(0.0), (0, 1, 0), (90, 0, 0), emission=1.0)
FLOOR = Object(Plane(), Diffuse(1.0), rotation=(-90, 0, 0))
SKY_BALL = Scene([Object(Sphere(1), Diffuse(0.5))], environment=1.0)
FRONT = Pinhole(View((0, 0, 5), (0, 0, 0)), 40)


def seen(scene: Scene, camera: Any, size: int = 16, **more: Any) -> tuple[float, float]:
    """Mean of the pixels, and its standard error."""
    picture = lenstrace.render(scene, camera, size=(size, size), **more)
    assert picture.nan_pixels == 0
    error = np.sqrt((picture.standard_error[..., 0] ** 2).sum()) / size**2
    return float(picture.radiance[..., 0].mean()), float(error)


def test_gloss_shows_a_lamp_once() -> None:
    """A gold plate under a lamp: by rays of gloss as by both ways of a path."""
    scene = Scene([Object(Rectangle(4, 4), RoughConductor(roughness=0.3), rotation=(-90, 0, 0)), LAMP])
    eye = Orthographic(View((0.5, 0.5, 0.3), (0, 0, 0)), 0.1)
    found = {name: seen(scene, eye, samples=256, depth=2, method=name) for name in ("path", "distributed")}
    apart = found["path"][0] - found["distributed"][0]
    assert abs(apart) < 4 * np.hypot(found["path"][1], found["distributed"][1])
    assert found["path"][1] < 2e-3


def test_a_matt_ball_under_an_even_sky_gives_back_its_albedo() -> None:
    """A convex body sees nothing of itself: radiance albedo times that of the sky."""
    eye = Orthographic(View((0, 0, 5), (0, 0, 0)), 1.0)
    for name in ("distributed", "path"):
        mean, error = seen(SKY_BALL, eye, samples=64, depth=2, method=name)
        assert abs(mean - 0.5) < 4 * error < 0.03, name
    with pytest.warns(AccuracyWarning, match="whitted: the environment is seen, but lights nothing"):
        assert seen(SKY_BALL, eye, samples=1, method="whitted")[0] == 0


def test_a_moving_lamp_lights_from_all_its_places() -> None:
    """Against the mean of lamps that stand still: 24 places, midpoint rule."""
    eye = Orthographic(View((3, 0.5, 0), (3, 0, 0), (0, 0, 1)), 1e-3)

    def lamp(x: float, motion: Any = None) -> Scene:
        return Scene([FLOOR, Object(Sphere(0.2), Diffuse(0.0), (x, 1, 0), emission=1.0, motion=motion)])

    moving, error = seen(lamp(0.0, (6.0, 0.0, 0.0)), eye, samples=512, depth=2)
    still = [seen(lamp(6 * ((i + 0.5) / 24 - 0.5)), eye, size=8, samples=64, depth=2)[0] for i in range(24)]
    assert moving == pytest.approx(np.mean(still), abs=4 * error + 0.005 * moving)


def test_only_chance_ends_a_walk() -> None:
    """A closed room, emission .5, albedo .9: 0.5 / (1 - 0.9) = 5, of which 16 terms are 4.07."""
    sides = [((0, 0, -1), (0, 0, 0)), ((0, 0, 1), (180, 0, 0)), ((0, -1, 0), (-90, 0, 0))]
    sides += [((0, 1, 0), (90, 0, 0)), ((-1, 0, 0), (0, 90, 0)), ((1, 0, 0), (0, -90, 0))]
    room = Scene([Object(Rectangle(1, 1), Diffuse(0.9), *side, emission=0.5) for side in sides])
    mean, error = seen(room, Pinhole(View((0, 0, 0.5), (0.1, 0.2, -1)), 60), samples=64)
    assert abs(mean - 5) < 4 * error < 0.3


def test_no_light_is_lost_in_glass() -> None:
    """Roulette goes by the light that is lost, not by n^2: a ball of glass under an even sky is not seen."""
    ball = Scene([Object(Sphere(1), Dielectric(1.5))], environment=1.0)
    eye = Orthographic(View((0, 0, 5), (0, 0, 0)), 1.0)
    chance, sure = (lenstrace.render(ball, eye, size=(16, 16), samples=16, depth=depth) for depth in (None, 64))
    assert sure.radiance == pytest.approx(1, abs=1e-5)
    assert chance.mean_rgb[0] == pytest.approx(1, abs=0.002)
    # few come so far that chance asks
    assert np.mean(np.abs(chance.radiance - 1) < 1e-4) > 0.5


def test_rough_glass_without_a_boundary_is_not_seen() -> None:
    pane = Object(Rectangle(1, 1), RoughDielectric(1.0))
    lamp = Object(Rectangle(0.05, 0.05), Diffuse(0.0), (0, 0, -1), emission=1.0)
    assert seen(Scene([pane, lamp]), Orthographic(View((0, 0, 2), (0, 0, 0)), 0.05), samples=16)[0] == 1


def test_the_unit_of_length_makes_no_difference() -> None:
    """A lamp, a sun and a sky: which of them is asked does not go by metres or millimetres."""
    means = []
    for unit in (1.0, 1024.0):  # a power of two changes no digit
        objects = [
            Object(Sphere(0.5 * unit), Diffuse(0.5), (0, 0.5 * unit, 0)),
            Object(Sphere(0.2 * unit), Diffuse(0.0), (unit, 2 * unit, 0), emission=5.0),
        ]
        scene = Scene([FLOOR, *objects], [DistantLight((0, -1, -0.3), 1.0)], environment=0.2)
        means.append(seen(scene, Pinhole(View((0, unit, 4 * unit), (0, 0.5 * unit, 0)), 35), samples=4, depth=3)[0])
    assert means[1] == pytest.approx(means[0], rel=1e-3)


def test_a_shape_without_a_normal_at_the_eye_is_no_hole() -> None:
    """The gradient of x^2 + y^2 is 0 on the axis that the eye looks along."""
    pipe = Object(implicit("x^2 + y^2 - 0.25", 1.0), Diffuse(0.5))
    assert seen(Scene([pipe], [PointLight((2, 2, 2), 5.0)], environment=0.1), FRONT, samples=4)[0] > 0


@pytest.mark.parametrize(
    ("cosine", "eta", "k", "reflectance", "slopes"),
    [
        # 1 - R = 4 eta / ((eta + 1)^2 + k^2) at normal incidence
        (1.0, 0.0, 3.0, 1.0, (0.0, -0.4, 0.0)),
        (1.0, 1.5, 0.0, 0.04, (0.0, 0.128, 0.0)),
        # beyond the critical angle of a medium without absorption; its absorption begins at once
        (0.3, 0.2, 0.0, 1.0, (0.0, 0.0, -0.39719253119852027)),
        (0.0, 1.0, 0.0, 0.0, (0.0, 0.0, 0.0)),
    ],
)
def test_metals_at_their_ends(cosine: float, eta: float, k: float, reflectance: float, slopes: Any) -> None:
    assert metal_reflectance(cosine, eta, k) == pytest.approx(reflectance, abs=1e-14)  # type: ignore[arg-type]
    found = jax.grad(metal_reflectance, (0, 1, 2))(cosine, eta, k)
    assert np.array(found) == pytest.approx(slopes, abs=1e-6)
