"""The reversed lens: the same first-order figures, and every trace the reverse of the forward one."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lenstrace
from lenstrace import Lens, PrescriptionError
from lenstrace.optics.rays import Ray, living
from lenstrace.sequential.reversed import reversed_lens
from lenstrace.sequential.trace import trace

AIR_TO_AIR = ["double_gauss", "cooke_triplet", "tessar", "phone_lens", "singlet_rear_stop", "hubble", "thick_meniscus"]
TILTED = [
    {"radius": 60.0, "thickness": 6.0, "glass": "N-BK7", "asphere": {4: -2e-6, 6: 1e-9}, "conic": -0.4},
    {"radius": -90.0, "thickness": 4.0, "tilt": [3.0, -2.0, 25.0], "decenter": [0.4, -0.7], "index": 1.7},
    {"radius": 300.0, "thickness": 5.0, "stop": True, "aperture": {"circle": 8.0}},
    {"thickness": 1.0, "screen": {"grating": {"period": 0.05, "order": 1, "angle": 30.0}}},
    {"radius": -200.0, "thickness": 40.0, "tilt": [-1.0, 4.0, 0.0]},
]
MIRRORS = [
    {"radius": -400.0, "conic": -1.0, "thickness": -150.0, "mirror": True, "stop": True},
    {"radius": -150.0, "thickness": 100.0, "mirror": True, "tilt": [0.5, 0.3, 0.0], "decenter": [0.0, 1.0]},
    {"radius": -80.0, "thickness": -30.0, "mirror": True},
]
traced = jax.jit(trace)  # one program for all wavelengths of a lens


def tilted(rows: list[dict] = TILTED) -> Lens:
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 10.0}, [0.0], [0.48, 0.55], object_distance=200.0)


def rays(lens: Lens, width: float, slope: float) -> Ray:
    """Rays that meet the first vertex plane within `width`, from everywhere within `slope`."""
    x, y, u, v = np.random.default_rng(3).uniform(-1, 1, (4, 64))
    l, m = slope * u, slope * v
    del lens
    return living(*(jnp.asarray(a) for a in (width * x, width * y, 0 * x, l, m, np.sqrt(1 - l * l - m * m))))


def check_there_and_back(lens: Lens, width: float, slope: float) -> None:
    """From the image of the forward trace the reversed lens sends every ray back to where it came from."""
    other = reversed_lens(lens)
    for wavelength in range(len(lens.wavelengths.um)):
        start = rays(lens, width, slope)
        arrived = traced(lens.system.at(wavelength), start)
        # the image surface of these lenses is a plane, the object plane of the reversed ones
        sense = lens.system.orientation[-1]
        back = living(
            arrived.x,
            arrived.y,
            jnp.full_like(arrived.x, -sense * lens.rows[-1].thickness),
            -arrived.l,
            -arrived.m,
            sense * arrived.n,
        )
        there = traced(other.system.at(wavelength), back)
        sound = np.asarray(arrived.ok)
        assert sound.mean() > 0.5
        assert np.asarray(there.ok)[sound].all()
        # to the plane of the image surface of the reversed lens, then to the first vertex
        z = np.asarray(there.z) + (0 if lens.object_distance is None else sense * lens.object_distance)
        t = z / np.asarray(there.n)
        x, y = np.asarray(there.x - there.l * t), np.asarray(there.y - there.m * t)
        scale = max(width, abs(float(lens.rows[-1].thickness)))
        for got, want in ((x, start.x), (y, start.y)):
            assert np.abs(got - want)[sound].max() < 1e-12 * scale
        for got, want in ((there.l, -start.l), (there.m, -start.m), (there.n, sense * start.n)):
            assert np.abs(np.asarray(got) - want)[sound].max() < 1e-12


@pytest.mark.parametrize("name", AIR_TO_AIR)
def test_the_focal_length_is_the_same_and_the_focal_points_change_places(name: str, designs: dict[str, Lens]) -> None:
    lens = designs[name]
    here, there = lenstrace.first_order(lens), lenstrace.first_order(reversed_lens(lens))
    np.testing.assert_allclose(there.focal_length, here.focal_length, rtol=1e-12)
    # the rows behind the last vertex that bends stand in front of the first one now
    behind = float(np.sum(lens.thickness[:-1])) - np.asarray(here.rear_vertex)
    np.testing.assert_allclose(there.front_focal_length, behind - here.back_focal_length, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "width", "slope"),
    [
        ("double_gauss", 6.0, 0.1),
        ("tessar", 4.0, 0.1),
        ("cooke_triplet", 3.0, 0.1),
        ("phone_lens", 0.5, 0.1),
        ("relay_one_to_one", 5.0, 0.05),
        ("hubble", 1000.0, 0.0),
    ],
)
def test_a_trace_is_the_reverse_of_the_forward_trace(
    name: str, width: float, slope: float, designs: dict[str, Lens]
) -> None:
    lens = designs[name]
    check_there_and_back(lens.replace(image=lens.image.replace(curvature=0.0)), width, slope)


def test_tilts_decentres_aspheres_and_gratings_are_reversed() -> None:
    check_there_and_back(tilted(), 4.0, 0.03)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_mirrors_are_reversed(count: int) -> None:
    check_there_and_back(tilted(MIRRORS[:count]), 10.0, 0.01)


def test_conjugates_change_places(designs: dict[str, Lens]) -> None:
    lens = designs["relay_one_to_one"]
    other = reversed_lens(lens)
    assert other.object_distance == lens.rows[-1].thickness
    assert other.rows[-1].thickness == lens.object_distance
    # magnification -1
    assert other.fields.y == pytest.approx([-y for y in lens.fields.y], rel=1e-9)
    far = designs["double_gauss"]
    heights = [100.00374787083726 * np.tan(np.radians(angle)) for angle in far.fields.y]
    assert reversed_lens(far).fields.y == pytest.approx(heights, rel=1e-9)


def test_apertures_media_and_the_stop_stay_with_their_surfaces() -> None:
    lens = tilted()
    other = reversed_lens(lens)
    assert other.stop == len(lens) + 1 - lens.stop
    assert other[other.stop].aperture == (8.0,)
    index = np.asarray(lens.system.index)
    assert np.array_equal(np.asarray(other.system.index), index[:, ::-1])
    assert [row.glass for row in other][3:] == ["N-BK7", None]
    twice = reversed_lens(other)
    assert np.array_equal(twice.curvature, lens.curvature)
    assert np.array_equal(twice.thickness, lens.thickness)
    assert [row.tilt for row in twice] == [row.tilt for row in lens]


def test_what_cannot_be_reversed() -> None:
    broken = [{"thickness": 3.0, "stop": True, "radius": 50.0, "index": 1.5}, {"break": True, "tilt": [5, 0, 0]}]
    with pytest.raises(PrescriptionError, match="surface 2: a row with break = true cannot be reversed"):
        reversed_lens(tilted([*broken, {"thickness": 10.0}]))
    virtual = [{"thickness": 3.0, "stop": True, "radius": 50.0, "index": 1.5}, {"thickness": -10.0}]
    with pytest.raises(PrescriptionError, match="surface 2: the image surface must stand behind the last row"):
        reversed_lens(tilted(virtual))


def test_the_derivative_of_the_reversed_trace(designs: dict[str, Lens]) -> None:
    lens = designs["double_gauss"]

    def height(curvature: jax.Array) -> jax.Array:
        other = reversed_lens(lens.replace(surface=1, curvature=curvature))
        one = jnp.ones(())
        ray = living(3 * one, 0 * one, -61.487536 * one, 0.02 * one, 0 * one, jnp.sqrt(1 - 0.0004 * one))
        return trace(other.system.at(1), ray).l

    both = jax.jit(jax.value_and_grad(height))
    c, step = float(lens.curvature[0]), 1e-6
    difference = (float(both(c + step)[0]) - float(both(c - step)[0])) / (2 * step)
    assert float(both(c)[1]) == pytest.approx(difference, rel=1e-7)
