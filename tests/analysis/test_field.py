"""Analyses against field: closed forms, Coddington's equations written apart from the trace, and a peer's figures."""

import argparse
import json
import math
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Fields, ImageError, Lens, LensTraceError, RayError
from lenstrace.analysis.colour import axial_colour, lateral_colour, longitudinal_aberration
from lenstrace.analysis.distortion import distortion, distortion_grid
from lenstrace.analysis.field_curvature import field_curvature
from lenstrace.analysis.field_line import shares_of
from lenstrace.analysis.illumination import incidence_angles, relative_illumination
from lenstrace.cli import field as command

POINTS = 5
INDEX = np.array([1.52, 1.50, 1.49])
RADIUS = 50.0


@pytest.fixture(scope="module")
def surface() -> Lens:
    """One refracting sphere, the stop in its vertex, the image in glass where the middle wavelength has its focus."""
    um = [0.48, 0.55, 0.65]
    rows = [{"radius": RADIUS, "thickness": 150.0, "stop": True, "index": {"um": um, "n": list(INDEX)}}]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 20.0}, [0.0, 20.0], um)


@pytest.fixture(scope="module")
def mirror() -> Lens:
    """A spherical mirror, R = -200 mm, the stop in its centre, the image on the sphere of half the radius."""
    rows = [{"thickness": 200.0, "stop": True}, {"radius": -200.0, "thickness": -100.0, "mirror": True}]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 0.4}, [0.0, 40.0], [0.55], image={"radius": -100.0})


def test_one_surface_obeys_coddington(surface: Lens) -> None:
    found = field_curvature(surface, points=POINTS)
    assert_allclose(found.field, [0, 5, 10, 15, 20], atol=1e-13)
    cosine = np.cos(np.radians(found.field))[:, None]
    behind = np.sqrt(1 - (np.sin(np.radians(found.field))[:, None] / INDEX) ** 2)
    power = (INDEX * behind - cosine) / RADIUS
    sagittal, tangential = INDEX / power, INDEX * behind**2 / power
    assert_allclose(found.sagittal, sagittal * behind - 150, rtol=1e-12, atol=1e-12)
    assert_allclose(found.tangential, tangential * behind - 150, rtol=1e-12, atol=1e-12)
    # 1 / rho = -n' (n' - 1) / (n' R)
    assert_allclose(found.petzval_radius, -RADIUS / (INDEX - 1), rtol=1e-14)

    def last(curvature: jax.Array) -> jax.Array:
        return field_curvature(surface.replace(curvature=curvature), points=POINTS).sagittal[-1, 1]

    # the distance is proportional to 1 / c
    slope = jax.jit(jax.grad(last), compiler_options=lenstrace.COMPILER_OPTIONS)(jnp.array([1 / RADIUS]))
    assert_allclose(slope, [-RADIUS * (sagittal * behind)[-1, 1]], rtol=1e-11)


def test_single_precision_stays_single(surface: Lens) -> None:
    single = surface.astype("float32")
    for ask in (field_curvature, lateral_colour):
        wide, narrow = ask(surface, points=POINTS), ask(single, points=POINTS)
        for name, value in vars(narrow).items():
            assert value.dtype == jnp.float32, name
            assert_allclose(value, getattr(wide, name), rtol=2e-5, atol=5e-4, err_msg=name)


def test_colour_and_axial_crossings_of_one_surface(surface: Lens) -> None:
    axial = axial_colour(surface, points=3)
    focus = INDEX * RADIUS / (INDEX - 1)
    assert_allclose(axial.focus, focus - 150, atol=1e-11)
    assert_allclose(axial.shift, focus - focus[1], atol=1e-11)
    assert_allclose(axial.curve_um, [0.48, 0.565, 0.65])
    assert_allclose(axial.curve_shift[::2], axial.shift[::2], atol=1e-11)

    lateral = lateral_colour(surface, points=POINTS)
    behind = np.arcsin(np.sin(np.radians(lateral.field))[:, None] / INDEX)
    heights = 150 * np.tan(behind)
    # light that goes up is imaged above the axis here
    assert_allclose(lateral.y, heights - heights[:, 1:2], atol=1e-12)
    assert_allclose(lateral.height, lateral.y, atol=1e-15)
    assert_allclose(lateral.x, 0, atol=1e-15)

    # a ray parallel to the axis at height y: I = asin(y / R), crossing at R sin I' / sin(I - I') from the centre
    along = longitudinal_aberration(surface, points=POINTS)
    inner = np.arcsin(np.linspace(0, 1, POINTS) * 10 / RADIUS)[1:, None]
    outer = np.arcsin(np.sin(inner) / INDEX)
    assert_allclose(along.z[1:], RADIUS + RADIUS * np.sin(outer) / np.sin(inner - outer) - 150, rtol=1e-11)
    assert_allclose(along.z[0], axial.focus, atol=1e-11)

    seen = distortion(surface, points=POINTS)
    assert_allclose(seen.slope, 100, rtol=1e-13)
    assert_allclose(seen.height, heights[:, 1], atol=1e-12)
    assert_allclose(seen.reference, 100 * np.tan(np.radians(seen.field)), atol=1e-12)


def test_mirror_with_its_stop_in_the_centre(mirror: Lens) -> None:
    found, seen = field_curvature(mirror, points=POINTS), distortion(mirror, points=POINTS)
    angle = np.radians(np.linspace(0, 40, POINTS))
    assert_allclose(found.tangential, 0, atol=1e-12)
    assert_allclose(found.sagittal, 0, atol=1e-12)
    assert_allclose(found.petzval_radius, -100, rtol=1e-14)
    # every chief ray returns on itself: h = f sin(theta) on the sphere
    assert_allclose(seen.height, 100 * np.sin(angle), atol=1e-12)
    assert_allclose(seen.percent, 100 * (np.cos(angle) - 1), atol=1e-11)
    assert_allclose(seen.f_theta_percent[1:], 100 * (np.sin(angle[1:]) / angle[1:] - 1), atol=1e-11)
    # on a plane: h = f tan(theta), and the foci stay on the sphere
    flat = mirror.replace(surface=3, curvature=0.0)
    assert_allclose(distortion(flat, points=POINTS).percent, 0, atol=1e-11)
    shift = -100 * (1 - np.cos(angle))
    flat_found = field_curvature(flat, points=POINTS)
    assert_allclose(flat_found.tangential[:, 0], shift, atol=1e-11)
    assert_allclose(flat_found.sagittal[:, 0], shift, atol=1e-11)
    # the stop in the vertex: t = f cos(theta), s = f / cos(theta) along the ray
    vertex = field_curvature(flat.replace(surface=1, thickness=0.0), points=POINTS)
    assert_allclose(vertex.tangential[:, 0], 100 * np.sin(angle) ** 2, atol=1e-11)
    assert_allclose(vertex.sagittal[:, 0], 0, atol=1e-11)
    assert_allclose(vertex.astigmatism, vertex.tangential - vertex.sagittal, atol=0)


def test_largest_field_leads_and_nothing_is_flat_beyond_90_degrees(mirror: Lens) -> None:
    skew = mirror.replace(fields=Fields(x=(3.0, 20.0), y=(0.0, -20.0), kind="angle"))
    seen = distortion(skew, points=POINTS)
    polar = math.atan(math.sqrt(2) * math.tan(math.radians(20)))
    assert_allclose(seen.direction, [math.sqrt(0.5), -math.sqrt(0.5)], rtol=1e-13)
    assert_allclose(seen.field, np.degrees(polar) * np.linspace(0, 1, POINTS), rtol=1e-13)
    assert_allclose(seen.height, 100 * np.sin(np.radians(seen.field)), atol=1e-12)
    wide = distortion(mirror.replace(fields=Fields(x=(0.0, 0.0), y=(0.0, 110.0), kind="angle")), points=POINTS)
    assert np.isnan(wide.reference[-1])
    assert np.isnan(wide.percent[-1])
    assert_allclose(wide.f_theta_reference[-1], 100 * math.radians(110), rtol=1e-13)


def test_grid_of_a_mirror(mirror: Lens) -> None:
    grid = jax.tree.map(lambda a: a[::5, ::5], distortion_grid(mirror))
    half = math.tan(math.radians(40)) / math.sqrt(2)
    assert_allclose(grid.field_x[0], np.degrees(np.arctan([-half, 0, half])), atol=1e-12)
    assert_allclose(grid.ideal_x[2], 100 * np.array([-half, 0, half]), atol=1e-11)
    assert_allclose(grid.ideal_y[:, 1], 100 * np.array([-half, 0, half]), atol=1e-11)
    # on the sphere about the stop a chief ray stands at 100 mm times its direction
    corner = 100 * half / math.sqrt(1 + 2 * half * half)
    assert_allclose([grid.x[0, 2], grid.y[0, 2]], [corner, -corner], rtol=1e-12)
    with pytest.raises(ImageError, match="110 degrees"):
        distortion_grid(mirror.replace(fields=Fields(x=(0.0,), y=(110.0,), kind="angle")))


def test_light_on_a_curved_image_falls_with_the_stop_alone(mirror: Lens) -> None:
    """Every field sees the same mirror; the stop is foreshortened: cos(theta)."""
    light = relative_illumination(mirror, points=3)
    assert_allclose(light.relative, np.cos(np.radians(light.field)), rtol=1e-5)
    assert_allclose(light.solid_angle[0], math.pi * (0.2 / 100) ** 2, rtol=1e-5)
    assert_allclose(light.fraction, 1)


def hole(diameter: float) -> Lens:
    """An opening 100 mm from a plane object, and nothing else."""
    return lenstrace.lens(
        [{"thickness": 50.0, "stop": True}],
        {"entrance_pupil_diameter": diameter},
        {"kind": "object_height", "y": [0.0, 80.0]},
        [0.55],
        object_distance=100.0,
    )


def test_cosine_to_the_fourth_and_a_disk_of_any_size() -> None:
    small = relative_illumination(hole(0.02), points=POINTS)
    assert_allclose(small.relative, 1 / (1 + (np.linspace(0, 80, POINTS) / 100) ** 2) ** 2, rtol=1e-7)
    # form factor from an element to a parallel disk (Howell's catalogue, B-13), in units of the radius 30 mm
    large = relative_illumination(hole(60.0), points=POINTS)
    height, offset = 100 / 30, np.linspace(0, 80, POINTS) / 30
    root = np.sqrt((1 + height**2 + offset**2) ** 2 - 4 * offset**2)
    factor = (1 - (height**2 + offset**2 - 1) / root) / 2
    assert_allclose(large.solid_angle, math.pi * factor, rtol=1e-5)
    assert_allclose(large.relative, factor / factor[0], rtol=1e-5)


def test_pinhole_has_no_distortion() -> None:
    seen = distortion(hole(0.02), points=POINTS)
    assert_allclose(seen.height, np.linspace(0, 40, POINTS), atol=1e-12)
    assert_allclose(seen.percent, 0, atol=1e-12)
    assert np.isnan(seen.f_theta_percent).all()


def test_part_of_the_pupil_is_what_two_circles_share() -> None:
    rows = [{"thickness": 20.0, "aperture": {"annulus": [2.0, 5.0]}}, {"thickness": 50.0, "stop": True}]
    tube = lenstrace.lens(rows, {"entrance_pupil_diameter": 10.0}, [0.0, 5.0], [0.55])
    light = relative_illumination(tube, points=3, rays=8192)
    apart = 4 * np.tan(np.radians(light.field))
    shared = (2 * np.arccos(apart / 2) - apart / 2 * np.sqrt(4 - apart**2)) / math.pi
    assert_allclose(light.fraction, shared - 0.4**2, atol=1e-3)
    # light that stays parallel has no image, and what needs one says so
    assert np.isnan(light.relative).all()
    with pytest.raises(ImageError, match="field curvature needs an image"):
        field_curvature(tube)


def coddington(lens: Lens, degrees: float) -> tuple[float, float, list[float]]:
    """Tangential and sagittal shift (mm) of a centred lens of spheres in air, and the chief ray's angles of incidence
    (degrees), at the primary wavelength; in the meridional plane, nothing of the package used."""
    c, gap = [float(row.curvature) for row in lens], [float(row.thickness) for row in lens]
    n = [float(index) for index in np.asarray(lens.system.index)[lens.wavelengths.primary]]
    # the entrance pupil by a y-nu trace of two rays to the stop
    a, nu_a, b, nu_b = 1.0, 0.0, 0.0, 1.0
    for k in range(lens.stop - 1):
        power = c[k] * (n[k + 1] - n[k])
        nu_a, nu_b = nu_a - power * a, nu_b - power * b
        a, b = a + gap[k] * nu_a / n[k + 1], b + gap[k] * nu_b / n[k + 1]
    angle = math.radians(degrees)
    y, z, m, k_z = -b / a * math.tan(angle), 0.0, math.sin(angle), math.cos(angle)
    vergence_t = vergence_s = 0.0
    angles = []
    for k in range(len(c)):
        f, g = c[k] * (y * y + z * z) - 2 * z, k_z - c[k] * (y * m + z * k_z)
        way = f / (g + math.sqrt(g * g - c[k] * f))
        y, z = y + way * m, z + way * k_z
        # the reduced distance to the focus shrinks on the way to the surface
        vergence_t, vergence_s = (v / (1 - v * way / n[k]) for v in (vergence_t, vergence_s))
        normal_y, normal_z = -c[k] * y, 1 - c[k] * z
        cosine = m * normal_y + k_z * normal_z
        behind = math.sqrt(1 - (n[k] / n[k + 1]) ** 2 * (1 - cosine**2))
        angles.append(math.degrees(math.acos(min(cosine, 1.0))))
        power = c[k] * (n[k + 1] * behind - n[k] * cosine)
        vergence_t = (vergence_t * cosine**2 + power) / behind**2
        vergence_s = vergence_s + power
        bend = behind - n[k] / n[k + 1] * cosine
        m, k_z = n[k] / n[k + 1] * m + bend * normal_y, n[k] / n[k + 1] * k_z + bend * normal_z
        z -= gap[k]
    way = -z / k_z
    return (1 / vergence_t - way) * k_z, (1 / vergence_s - way) * k_z, [*angles, math.degrees(math.acos(k_z))]


def test_double_gauss(designs: dict[str, Lens]) -> None:
    lens = designs["double_gauss"]
    found, seen = field_curvature(lens, points=POINTS), distortion(lens, points=POINTS)
    angles = incidence_angles(lens, points=POINTS)
    for place, degrees in enumerate((0.0, 3.5, 7.0, 10.5, 14.0)):
        tangential, sagittal, incidence = coddington(lens, degrees)
        assert_allclose(found.tangential[place, 1], tangential, atol=1e-11)
        assert_allclose(found.sagittal[place, 1], sagittal, atol=1e-11)
        assert_allclose(angles.chief[place], incidence, atol=1e-6 if place == 0 else 1e-10)
    # Optiland 0.6.3, optiland.analysis.FieldCurvature (rays at +-1e-5 of the pupil) and Distortion, num_points=5,
    # the same radii, thicknesses and indices at 0.5876 um
    tangential = [1.0239172560488163e-05, -0.018195194142140395, -0.07569622465900143, -0.1832962295514451]
    sagittal = [1.0239172560488163e-05, -0.038198650087665965, -0.14886580089457876, -0.32026214726359015]
    assert_allclose(found.tangential[:, 1], [*tangential, -0.36731671992144543], atol=2e-6)
    assert_allclose(found.sagittal[:, 1], [*sagittal, -0.5336602356425498], atol=2e-6)
    percent = [0.0, -0.05653812496611816, -0.23331729437938403, -0.5531165086027182, -1.058659196406631]
    f_theta = [0.0, 0.06796283291172926, 0.2660452974610389, 0.5753219924450989, 0.9586294923115855]
    assert_allclose(seen.percent, percent, atol=1e-8)
    assert_allclose(seen.f_theta_percent, f_theta, atol=1e-8)
    # of small fields: 3 S - T is two Petzval shifts, in third order
    near = lens.replace(fields=Fields(x=(0.0, 0.0), y=(0.0, 0.2), kind="angle"))
    small, height = field_curvature(near, points=POINTS), distortion(near, points=POINTS).height[-1]
    shift = (3 * small.sagittal - small.tangential)[-1] - (3 * small.sagittal - small.tangential)[0]
    assert_allclose(shift[1] / 2, height**2 / 2 / small.petzval_radius[1], rtol=1e-4)


def test_angles_at_a_mirror(mirror: Lens) -> None:
    angles = incidence_angles(mirror, points=3)
    # stop, mirror and image: a chief ray through the centre meets both spheres along their normals
    assert_allclose(angles.chief, [[0, 0, 0], [20, 0, 0], [40, 0, 0]], atol=1e-10)
    edge = np.degrees(np.arcsin(0.2 / 200))
    assert_allclose([angles.upper[0, 1], angles.lower[0, 1]], edge, rtol=1e-12)
    assert_allclose(angles.largest[1], edge, rtol=1e-12)
    with pytest.raises(RayError, match="at least 1"):
        incidence_angles(mirror, points=0)


def test_one_field_is_one_row(surface: Lens) -> None:
    axial = surface.replace(fields=Fields(x=(0.0,), y=(0.0,), kind="angle"))
    assert list(shares_of(axial, POINTS)) == [0.0]
    assert list(shares_of(surface, 3)) == [0.0, 0.5, 1.0]


def test_command(mirror: Lens, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    parser = argparse.ArgumentParser()
    command.add_parser(parser.add_subparsers())
    lenstrace.save(mirror, tmp_path / "lens.toml")
    asked = ["field", str(tmp_path / "lens.toml"), "--points", str(POINTS)]
    arguments = parser.parse_args([*asked, "--json"])
    arguments.run(arguments)
    keys = json.loads(capsys.readouterr().out)
    assert_allclose(keys["field_curvature"]["tangential"], np.zeros((POINTS, 1)), atol=1e-12)
    assert_allclose(keys["incidence"]["chief"][-1], [40, 0, 0], atol=1e-10)
    assert keys["missing"] == {}
    arguments = parser.parse_args([*asked, "--plot", str(tmp_path / "lens.png")])
    arguments.run(arguments)
    printed = capsys.readouterr().out
    assert "Petzval radius" in printed
    assert "chief, field 40" in printed
    assert "one wavelength" in printed
    assert (tmp_path / "lens.png").stat().st_size > 10_000
    # a lens of which nothing can be said, and a wrong number: one error each
    flat = mirror.replace(fields=Fields(x=(0.0,), y=(5.0,), kind="image_height")).replace(surface=2, curvature=0.0)
    lenstrace.save(flat, tmp_path / "flat.toml")
    for wrong, said in (
        (["field", str(tmp_path / "flat.toml")], "image_height needs an image"),
        ([*asked[:-1], "0"], "at least 1 and at most 10001, got 0"),
    ):
        arguments = parser.parse_args(wrong)
        with pytest.raises(LensTraceError, match=said):
            arguments.run(arguments)
