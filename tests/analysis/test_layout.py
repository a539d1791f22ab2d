"""The drawing of a lens against plain geometry: planes, spheres, angles, and polygons judged by shapely."""

from __future__ import annotations

import functools
import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from lenstrace.analysis.layout import Layout, layout
from lenstrace.errors import RayError
from lenstrace.io.native import load
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

DESIGNS = Path(__file__).parents[2] / "designs"
NAMES = ("cemented_doublet", "cooke_triplet", "double_gauss", "singlet_rear_stop", "tessar")
UM = [0.5876]


@functools.cache
def design(name: str) -> tuple[Lens, Layout]:
    loaded = load(DESIGNS / f"{name}.toml")
    return loaded, layout(loaded)


@functools.cache
def cassegrain() -> Layout:
    """Parabola, f = 200, and hyperbola that takes its focus from 60 to 240 mm: 100 mm behind the primary."""
    magnification = 4.0
    primary = {"radius": -400, "conic": -1, "thickness": -140, "mirror": True, "stop": True}
    conic = -(((magnification + 1) / (magnification - 1)) ** 2)
    rows = [
        {**primary, "aperture": {"annulus": [20, 50]}},
        {"radius": -160, "conic": conic, "thickness": 240, "mirror": True},
    ]
    return layout(lens(rows, {"entrance_pupil_diameter": 100}, [0, 0.5], UM))


def element(front: dict[str, float], rear: dict[str, float], wide: float = 10.0) -> Layout:
    rows = [{"index": 1.5, "stop": True, **front}, rear]
    return layout(lens(rows, {"entrance_pupil_diameter": wide}, [0], UM))


@pytest.mark.parametrize("name", NAMES)
def test_rays_enter_at_the_field_angle_and_end_on_the_image(name: str) -> None:
    written, drawn = design(name)
    image = sum(float(row.thickness) for row in written.rows)
    for bundle in drawn.bundles:
        assert len(bundle.rays) == 5
        for ray in bundle.rays:
            z, y = ray[1] - ray[0]
            assert math.degrees(math.atan2(y, z)) == pytest.approx(bundle.field[1], abs=1e-9)
            assert z > 0
            assert ray[-1, 0] == pytest.approx(image, abs=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_marginal_rays_of_the_axis_are_a_pupil_apart(name: str) -> None:
    written, drawn = design(name)
    heights = [ray[0, 1] for ray in drawn.bundles[0].rays]
    assert heights == pytest.approx(np.linspace(-0.5, 0.5, 5) * float(written.aperture.value), abs=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_glass_is_closed_simple_and_holds_the_rays(name: str) -> None:
    written, drawn = design(name)
    glasses = [i for i, row in enumerate(written.rows, 1) if row.medium.name != "air"]
    assert [medium.first for medium in drawn.media] == glasses
    bending = [surface.number for surface in drawn.surfaces if surface.bends]
    for medium in drawn.media:
        assert np.array_equal(medium.outline[0], medium.outline[-1])
        polygon = shapely.Polygon(medium.outline)
        assert polygon.is_valid
        for bundle in drawn.bundles:
            for ray in bundle.rays:
                place = 1 + bending.index(medium.first)
                middle = ray[place : place + 2].mean(axis=0)
                # a file's own semi-diameters may be a little too small for the rays
                assert polygon.distance(shapely.Point(middle)) < 0.3


@pytest.mark.parametrize("name", NAMES)
def test_profiles_are_spheres_as_high_as_the_rays(name: str) -> None:
    written, drawn = design(name)
    bending = [surface.number for surface in drawn.surfaces if surface.bends]
    vertex = 0.0
    for row, surface in zip(written.rows, drawn.surfaces, strict=False):
        z, y = surface.profile.T
        curvature = float(row.curvature)
        assert curvature * ((z - vertex) ** 2 + y**2) == pytest.approx(2 * (z - vertex), abs=1e-9)
        assert max(abs(y)) == pytest.approx(surface.semi_diameter, rel=1e-12)
        if row.semi_diameter is not None:
            assert surface.semi_diameter == row.semi_diameter
        elif surface.bends:
            place = 1 + bending.index(surface.number)
            heights = [abs(ray[place, 1]) for bundle in drawn.bundles for ray in bundle.rays]
            assert max(heights) <= surface.semi_diameter
        vertex += float(row.thickness)


def test_cemented_surfaces_share_their_edge() -> None:
    _, drawn = design("cemented_doublet")
    first, second = (shapely.Polygon(medium.outline) for medium in drawn.media)
    assert shapely.intersection(first, second).area == pytest.approx(0, abs=1e-9)
    assert shapely.union(first, second).geom_type == "Polygon"
    assert len({surface.semi_diameter for surface in drawn.surfaces[:3]}) == 1


def test_cassegrain_is_in_focus_behind_the_hole_of_its_primary() -> None:
    drawn = cassegrain()
    assert [surface.is_mirror for surface in drawn.surfaces] == [True, True, False]
    assert drawn.media == ()
    assert len(drawn.bundles[0].rays) == 6
    for ray in drawn.bundles[0].rays:
        assert 20 - 1e-9 <= abs(ray[1, 1]) <= 50 + 1e-9
        assert ray[-1] == pytest.approx([100, 0], abs=1e-9)
    profile = drawn.surfaces[0].profile
    assert np.nanmin(abs(profile[:, 1])) == pytest.approx(20)
    assert np.isnan(profile).any()


def test_hatching_is_on_the_dark_side_of_a_mirror() -> None:
    primary, secondary, image = cassegrain().surfaces
    assert (np.diff(primary.hatching[:, :, 0]) > 0).all()
    assert (np.diff(secondary.hatching[:, :, 0]) < 0).all()
    assert len(image.hatching) == 0


def test_light_starts_in_front_of_everything_solid() -> None:
    drawn = cassegrain()
    solid = np.nanmin(drawn.surfaces[1].profile[:, 0])
    assert all(ray[0, 0] < solid for bundle in drawn.bundles for ray in bundle.rays)


def test_folded_light_obeys_the_law_of_reflection_and_ends_on_the_turned_image() -> None:
    rows = [
        {"thickness": 46, "stop": True},
        {"break": True, "tilt": [-45, 0, 0]},
        {"mirror": True},
        {"break": True, "tilt": [-45, 0, 0], "thickness": -18},
    ]
    drawn = layout(lens(rows, {"entrance_pupil_diameter": 15}, [0, 3], UM))
    assert [surface.is_mirror for surface in drawn.surfaces] == [False, False, True, False, False]
    for ray in [ray for bundle in drawn.bundles for ray in bundle.rays]:
        before, after = ray[1] - ray[0], ray[2] - ray[1]
        # a plane that runs along (1, -1) exchanges z and y, with a change of sign
        assert after / np.hypot(*after) == pytest.approx(-before[::-1] / np.hypot(*before), abs=1e-12)
        assert ray[1].sum() == pytest.approx(46)
        assert ray[-1, 1] == pytest.approx(-18, abs=1e-9)
    assert drawn.axis[-2] == pytest.approx([46, -18])


def test_slab_of_index_minus_one_has_a_focus_inside_and_one_behind() -> None:
    rows = [{"thickness": 20, "index": -1, "stop": True}, {"thickness": 10}]
    fields = {"kind": "object_height", "y": [0, 3]}
    drawn = layout(lens(rows, {"object_na": 0.5}, fields, UM, object_distance=10))
    assert drawn.media[0].index == -1
    for bundle in drawn.bundles:
        for ray in bundle.rays:
            assert ray[0] == pytest.approx([-10, bundle.field[1]], abs=1e-9)
            assert np.interp(10, *ray.T) == pytest.approx(bundle.field[1], abs=1e-9)
            assert ray[-1] == pytest.approx([30, bundle.field[1]], abs=1e-9)


def test_far_object_is_not_drawn_but_its_rays_point_to_it() -> None:
    rows = [{"radius": 50, "thickness": 5, "index": 1.5, "stop": True}, {"radius": -50, "thickness": 60}]
    fields = {"kind": "object_height", "y": [0, 40]}
    drawn = layout(lens(rows, {"entrance_pupil_diameter": 10}, fields, UM, object_distance=1000))
    for bundle in drawn.bundles:
        for ray in bundle.rays:
            assert -20 < ray[0, 0] < 0
            slope = (ray[1, 1] - ray[0, 1]) / (ray[1, 0] - ray[0, 0])
            assert ray[0, 1] + slope * (-1000 - ray[0, 0]) == pytest.approx(bundle.field[1], abs=1e-9)


def test_ball_is_drawn_whole() -> None:
    drawn = element({"radius": 5, "thickness": 10}, {"radius": -5, "thickness": 2}, wide=5)
    polygon = shapely.Polygon(drawn.media[0].outline)
    assert polygon.is_valid
    assert polygon.area == pytest.approx(math.pi * 25, rel=5e-3)


def test_glass_ends_where_its_surfaces_cross() -> None:
    sphere = {"semi_diameter": 30}
    drawn = element({"radius": 20, "thickness": 8, **sphere}, {"radius": -20, "thickness": 20, **sphere})
    polygon = shapely.Polygon(drawn.media[0].outline)
    assert polygon.is_valid
    # two circles of radius 20 whose centres are 32 apart
    assert polygon.bounds[3] == pytest.approx(12, abs=0.02)
    assert drawn.surfaces[0].semi_diameter == pytest.approx(20)


def test_narrow_surface_is_led_to_the_edge_by_a_flat_or_straight() -> None:
    front = {"radius": 20, "thickness": 3, "semi_diameter": 8}
    flat = element(front, {"radius": 12, "thickness": 20, "semi_diameter": 6}).media[0].outline
    corner = [3 + 12 - math.sqrt(12**2 - 6**2), 8]
    assert np.hypot(*(flat - corner).T).min() < 1e-12
    front = {"radius": 60, "thickness": 4, "semi_diameter": 50}
    bevel = shapely.Polygon(element(front, {"radius": 20, "thickness": 60, "semi_diameter": 18}).media[0].outline)
    assert bevel.is_valid
    assert bevel.bounds[3] == pytest.approx(50)
    assert bevel.bounds[2] == pytest.approx(60 - math.sqrt(60**2 - 50**2))


def test_stop_is_two_bars_outward_from_its_opening() -> None:
    _, drawn = design("tessar")
    stops = [surface for surface in drawn.surfaces if surface.is_stop]
    assert [surface.number for surface in stops] == [6]
    assert [surface.number for surface in drawn.surfaces if len(surface.bars)] == [6]
    for bar in stops[0].bars:
        assert abs(bar[0, 1]) == pytest.approx(6.014269889241)
        assert abs(bar[1, 1]) > abs(bar[0, 1])
        assert bar[:, 0] == pytest.approx(15.005808)


def test_failed_ray_ends_where_it_fails() -> None:
    rows = [
        {"radius": 10, "thickness": 4, "index": 1.8, "stop": True},
        {"radius": -10, "thickness": 20, "aperture": {"circle": 1}},
    ]
    drawn = layout(lens(rows, {"entrance_pupil_diameter": 10}, [0], UM))
    for ray in drawn.bundles[0].rays:
        if ray[0, 1] == pytest.approx(0):
            assert ray[-1, 0] == pytest.approx(24)
        else:
            assert len(ray) == 3
            z, y = ray[-1]
            assert (z + 6) ** 2 + y**2 == pytest.approx(100)
            assert abs(y) > 1


def test_fisheye_field_beyond_eighty_degrees_starts_outside_the_glass() -> None:
    rows = [
        {"radius": 30, "thickness": 2, "index": 1.8},
        {"radius": 12, "thickness": 20},
        {"thickness": 20, "stop": True},
    ]
    drawn = layout(lens(rows, {"entrance_pupil_diameter": 1}, [0, 82], UM, ray_aiming=True))
    glass = shapely.Polygon(drawn.media[0].outline)
    assert glass.is_valid
    for ray in drawn.bundles[1].rays:
        z, y = ray[1] - ray[0]
        assert math.degrees(math.atan2(y, z)) == pytest.approx(82, abs=1e-9)
        assert shapely.LineString(ray[:2]).intersection(glass).length < 1e-2
        assert ray[-1, 0] == pytest.approx(42)


@pytest.mark.parametrize(("asked", "drawn"), [(1, 1), (2, 3), (4, 5), (7, 7)])
def test_number_of_rays_always_with_the_chief_ray(asked: int, drawn: int) -> None:
    rays = layout(design("singlet_rear_stop")[0], rays_per_field=asked).bundles[0].rays
    assert len(rays) == drawn
    assert min(abs(ray[:, 1]).max() for ray in rays) == pytest.approx(0, abs=1e-12)


def test_no_rays_are_refused() -> None:
    with pytest.raises(RayError, match="at least 1, got 0"):
        layout(design("tessar")[0], rays_per_field=0)
