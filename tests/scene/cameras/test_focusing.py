"""Autofocus: against the thin lens, the lens equation from the principal planes, and the best focus of traced spots."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

import lenstrace
from lenstrace import CameraError, Fields, Lens
from lenstrace.optics.rays import living
from lenstrace.scene.cameras.focusing import focused
from lenstrace.scene.cameras.simple import ThinLens
from lenstrace.scene.cameras.view import View
from lenstrace.sequential.trace import trace


def planes(lens: Lens) -> tuple[float, float, float, float]:
    """f', front and rear principal plane from the first vertex, length; of the primary colour."""
    first, primary = lenstrace.first_order(lens), lens.wavelengths.primary
    rear = float(first.rear_vertex[primary]) + float(first.rear_principal_plane[primary])
    length = float(np.sum(lens.thickness[:-1]))
    return float(first.focal_length[primary]), float(first.front_principal_plane[primary]), rear, length


@pytest.fixture(scope="module")
def gauss(designs: dict[str, Lens]) -> Lens:
    return designs["double_gauss"]


@pytest.mark.parametrize("distance", [500.0, 2000.0, 1e6])
@pytest.mark.parametrize("name", ["double_gauss", "cooke_triplet"])
def test_stopped_down_it_is_the_lens_equation(name: str, distance: float, designs: dict[str, Lens]) -> None:
    lens = designs[name]
    focal, front, rear, length = planes(lens)
    found = focused(lens, distance, f_number=200.0)
    film, before = found.rows[-1].thickness, found.object_distance
    assert before + length + film == pytest.approx(distance, rel=1e-12)
    # 1 / a + 1 / b = 1 / f', from the principal planes
    a, b = before + front, length + film - rear
    assert 1 / a + 1 / b == pytest.approx(1 / focal, rel=1e-5)
    assert a > b


def test_at_infinity_the_film_stands_in_the_focus(gauss: Lens) -> None:
    found = focused(gauss, np.inf, f_number=500.0)
    assert found.object_distance is None
    assert found.rows[-1].thickness == pytest.approx(61.487546239192355, abs=2e-5)


@pytest.mark.parametrize("distance", [500.0, 2000.0, np.inf])
@pytest.mark.parametrize("f_number", [None, 2.8])
def test_the_best_focus_is_there(gauss: Lens, distance: float, f_number: float | None) -> None:
    found = focused(gauss, distance, f_number=f_number)
    found = found.replace(fields=Fields((0.0,), (0.0,), "angle"), wavelengths=gauss.wavelengths.primary_alone)
    best = lenstrace.best_focus(found)
    assert abs(float(best.spot.shift)) < 1e-9
    assert float(best.given.rms) <= float(best.paraxial.rms)


def test_mirrors_are_focused(designs: dict[str, Lens]) -> None:
    lens = designs["hubble"]
    assert focused(lens, np.inf).rows[-1].thickness == pytest.approx(lens.rows[-1].thickness, abs=0.3)
    # x x' = f'^2: a plane 100 km away
    near = focused(lens, 1e8)
    assert near.rows[-1].thickness - focused(lens, np.inf).rows[-1].thickness == pytest.approx(
        57600.0**2 / 1e8, rel=0.01
    )


@pytest.mark.parametrize("f_number", [None, 2.8, 8.0])
def test_the_stop_is_as_wide_as_its_marginal_ray(gauss: Lens, f_number: float | None) -> None:
    found = focused(gauss, np.inf, f_number=f_number)
    radius = 10.000374787083726 if f_number is None else 100.00374787083726 / f_number / 2
    at = [jnp.asarray([a]) for a in (0.0, radius, 0.0, 0.0, 0.0, 1.0)]
    height = trace(gauss.system.at(1), living(*at), last=gauss.stop).y
    assert found.aperture.value == pytest.approx(float(height[0]), rel=1e-9)


def test_the_nearest_focus(gauss: Lens) -> None:
    focal, front, rear, _ = planes(gauss)
    nearest = 4 * focal + rear - front
    focused(gauss, nearest + 0.01, f_number=16.0)
    with pytest.raises(CameraError, match=f"nearer than this lens can image, {nearest:.6g}"):
        focused(gauss, nearest - 0.01)


def test_the_circle_of_confusion(gauss: Lens) -> None:
    """A point at 4 m, the lens at f/8 focused at 2 m: the disk of the thin lens, to first order."""
    found = focused(gauss, 2000.0, f_number=8.0)
    focal, front, _, _ = planes(gauss)
    zero = tuple(map(jnp.asarray, (0.0, 0.0, 0.0)))
    thin = ThinLens(
        View(zero, zero, zero), *(jnp.asarray(a) for a in (focal, 8.0, found.object_distance + front, 24.0))
    )
    far = 4000.0
    # the rim of the stop, found along the ray that starts from the point
    system = found.system.at(1)
    heights = np.linspace(0, 10, 4001)
    slopes = jnp.asarray(heights / far)
    n = 1 / jnp.sqrt(1 + slopes * slopes)
    ray = living(0 * n, jnp.asarray(heights), 0 * n, 0 * n, slopes * n, n)
    stop = np.abs(np.asarray(trace(system, ray, last=found.stop).y))
    at_rim = float(np.interp(found.aperture.value, stop, np.asarray(trace(system, ray).y)))
    assert 2 * abs(at_rim) == pytest.approx(float(thin.circle_of_confusion(jnp.asarray(far + front))), rel=0.03)


def test_a_film_left_where_it_is(gauss: Lens) -> None:
    found = focused(gauss, None, f_number=4.0)
    assert found.rows == gauss.rows
    assert found.object_distance is None
    assert dataclasses.replace(found, aperture=gauss.aperture).aperture == gauss.aperture
