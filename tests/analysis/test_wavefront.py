"""Wavefronts: perfect systems, a known defocus, Optiland and batoid, and paths in 50 digits."""

from __future__ import annotations

import functools
from typing import Any

import jax
import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Fields, Lens, RayError
from lenstrace.analysis.image_rays import image_rays
from lenstrace.analysis.path_difference import Sphere, differences
from lenstrace.analysis.wavefront import wavefront, zernike_coefficients
from lenstrace.compute.compiled import compiled
from lenstrace.sequential.reference import reference_trace
from lenstrace.sequential.reference_launch import reference_launch
from lenstrace.sequential.reference_surface import indices_of
from lenstrace.sequential.sampling import pupil_points

mp: Any = mpmath.mp
COMPILED = "/jax/core/compile/backend_compile_duration"
# Perfect over this part of the pupil: beyond it the term of r^22 counts that the oval's series leaves out.
PERFECT = {"hyperbolic_singlet": 1.0, "cartesian_oval": 0.9, "negative_index_slab": 1.0, "immersion_objective": 1.0}

# Optiland 0.6.3, Wavefront, strategy chief_ray, hexapolar: OPD in waves at these points of the pupil, by design and
# places of field and wavelength.
POINTS = (
    np.array([0.766044443118978, -0.17364817766693, -0.577350269189626]),
    np.array([0.642787609686539, 0.984807753012208, 0.333333333333334]),
)
OPTILAND = {
    ("double_gauss", 0, 0): (1.5282950802447657, 1.5282950802447657, 0.45889186276134875),
    ("double_gauss", 1, 2): (1.6492536955331238, 1.0131732934103599, 0.7045193929279244),
    ("double_gauss", 2, 1): (4.345202173003618, 3.454111145833408, 1.939067394451645),
    ("cooke_triplet", 0, 2): (-0.9207593983918425, -0.9207593983918425, -0.6756866597229942),
    ("cooke_triplet", 1, 1): (-0.05300985722297727, -2.010617757387029, 0.22373920711128323),
    ("cooke_triplet", 2, 0): (2.1484292900719737, 1.9020583630346977, 1.2036706303009126),
}


@compiled
def _differences(arrived: Any, sphere: Sphere) -> Any:
    return differences(arrived, sphere)


def opd(lens: Lens, x: Any, y: Any, reference: str = "chief", far: bool = False) -> np.ndarray:
    """Path differences (F, W, N) in waves."""
    return np.asarray(_differences(image_rays(lens, x, y), Sphere(reference, far=far)).opd)


def conic_mirror(radius: float, conic: float, image: float, **more: Any) -> Lens:
    row = {"radius": radius, "conic": conic, "thickness": image, "mirror": True, "stop": True}
    aperture = {"object_na": 0.2} if more else {"entrance_pupil_diameter": 80.0}
    return lenstrace.lens([row], aperture, [0.0], [0.55], **more)


def telecentric() -> Lens:
    """The plano-hyperbolic singlet with the stop in its front focus: an exit pupil at infinity."""
    rows = [
        {"thickness": 90.0, "stop": True},
        {"thickness": 15.0, "index": 1.5},
        {"radius": -50.0, "conic": -2.25, "thickness": 100.0},
    ]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 50.0}, [0.0, 1.0], [0.6328])


def doublet(thickness: float = 3.0) -> Lens:
    rows = [
        {"radius": 23.0, "thickness": thickness, "glass": "N-BK7"},
        {"radius": -41.0, "thickness": 1.5, "glass": "N-SF2", "stop": True},
        {"radius": -130.0, "thickness": 37.0},
    ]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 4.0}, [0.0, 2.0], [0.55])


def rms(lens: Lens, part: float = 1.0) -> float:
    """The largest RMS path difference of a lens's fields, waves, over a part of the radius of the pupil."""
    x, y, _ = pupil_points("hexapolar", 4)
    return float(opd(lens, part * x, part * y).std(-1).max())


@pytest.mark.parametrize("name", list(PERFECT))
def test_perfect_systems(name: str, designs: dict[str, Lens]) -> None:
    assert rms(designs[name], PERFECT[name]) < 1e-11


def test_mirrors_that_are_perfect() -> None:
    # a parabola for parallel light; an ellipsoid between its foci, a (1 + e) = 300 and a (1 - e) = 100 mm away
    assert rms(conic_mirror(-200.0, -1.0, -100.0)) < 1e-11
    assert rms(conic_mirror(-150.0, -0.25, -100.0, object_distance=300.0)) < 1e-11


def singlet_defocus(r: np.ndarray, shift: float, radius: float | None) -> np.ndarray:
    """W, in waves, of the plano-hyperbolic singlet at r of its pupil, the image surface shifted by some mm.

    The light runs along perfect rays to F. The sphere of radius R about the point C = F + shift meets the ray of slope
    theta at s before F, where |C - F + s d| = R: s = -shift cos theta + sqrt(R^2 - shift^2 sin^2 theta), and the axial
    ray at R - shift: W = s - (R - shift). R None: infinite.
    """
    with mp.workdps(40):
        waves = []
        for height in (25 * mp.mpf(float(each)) for each in r):
            # (k + 1) c^2 r^2 of a hyperboloid that opens toward -z
            sag = -(height**2 / 50) / (1 + mp.sqrt(1 + mp.mpf("1.25") * height**2 / 2500))
            cosine = (100 - sag) / mp.hypot(height, 100 - sag)
            dz = mp.mpf(shift)
            w = dz * (1 - cosine)
            if radius is not None:
                w += mp.sqrt(mp.mpf(radius) ** 2 - dz**2 * (1 - cosine**2)) - mp.mpf(radius)
            waves.append(float(w / mp.mpf("0.0006328")))
    return np.array(waves)


@pytest.mark.parametrize("shift", [0.02, -1.5])
def test_defocus_of_a_perfect_lens(shift: float, designs: dict[str, Lens]) -> None:
    singlet = designs["hyperbolic_singlet"]
    lens = singlet.replace(surface=2, thickness=100.0 + shift)
    # the stop, 15 mm inside the glass, is seen from behind at 1/l' = 1.5/(-15) + 0.5/50
    radius = 100.0 + shift + 100 / 9
    r = np.array([0.2, 0.5, 0.8, 1.0])
    assert_allclose(opd(lens, 0 * r, r)[0, 0], singlet_defocus(r, shift, radius), rtol=1e-11, atol=1e-9)
    assert_allclose(opd(lens, r, 0 * r, far=True)[0, 0], singlet_defocus(r, shift, None), rtol=1e-11, atol=1e-9)


def test_figures_of_a_known_defocus(designs: dict[str, Lens]) -> None:
    shift = 0.004
    front = wavefront(designs["hyperbolic_singlet"].replace(surface=2, thickness=100.0 + shift))
    # means over the pupil by Gauss's rule in u = r^2
    nodes, weights = np.polynomial.legendre.leggauss(24)
    w = singlet_defocus(np.sqrt((nodes + 1) / 2), shift, 100.0 + shift + 100 / 9)

    def mean(values: np.ndarray) -> Any:
        return (values * weights / 2).sum()

    rms = np.sqrt(mean(w**2) - mean(w) ** 2)
    assert 0.04 < rms < 0.08
    assert_allclose(front.rms[0, 0], rms, rtol=4e-3)
    assert_allclose(front.rms_without_tilt[0, 0], front.rms[0, 0], rtol=1e-9)
    assert_allclose(
        front.peak_to_valley[0, 0], singlet_defocus(np.ones(1), shift, 100.0 + shift + 100 / 9)[0], rtol=1e-9
    )
    assert_allclose(front.strehl[0, 0], abs(mean(np.exp(2j * np.pi * w))) ** 2, rtol=2e-3)
    assert_allclose(front.strehl_from_rms[0, 0], np.exp(-((2 * np.pi * rms) ** 2)), rtol=2e-3)
    residual = w - mean(w) - 3 * mean(w * nodes) * nodes
    assert_allclose(front.rms_without_focus[0, 0], np.sqrt(mean(residual**2)), rtol=2e-2)
    # the Legendre polynomials of 2 r^2 - 1 are the terms 1, 4, 9, 16 of the fringe order
    found = zernike_coefficients(front, count=37)
    legendre = [(2 * n + 1) * mean(w * np.polynomial.Legendre.basis(n)(nodes)) for n in range(4)]
    assert_allclose(found.coefficients[0, 0, [0, 3, 8, 15]], legendre, atol=1e-8)
    assert_allclose(found.coefficients[0, 0, [1, 2, 4, 5, 6, 7]], 0, atol=1e-10)
    assert float(found.residual_rms[0, 0]) < 1e-8


def test_exit_pupil_at_infinity() -> None:
    lens, r = telecentric(), np.array([0.2, 0.5, 1.0])
    assert_allclose(opd(lens, 0 * r, r)[0, 0], 0, atol=1e-11)
    assert np.isfinite(opd(lens, 0 * r, r)).all()
    shifted = lens.replace(surface=3, thickness=100.5)
    assert_allclose(opd(shifted, r, 0 * r)[0, 0], singlet_defocus(r, 0.5, None), atol=1e-9)


@pytest.mark.parametrize("name", ["double_gauss", "cooke_triplet"])
def test_path_differences_against_optiland(name: str, designs: dict[str, Lens]) -> None:
    found = opd(designs[name], *POINTS)
    for (_, field, wave), expected in ((k, v) for k, v in OPTILAND.items() if k[0] == name):
        assert_allclose(found[field, wave], expected, atol=1e-9)


def test_path_differences_against_batoid(designs: dict[str, Lens]) -> None:
    batoid = pytest.importorskip("batoid", reason="batoid is not installed: pip install lenstrace[bench]")
    lens = designs["double_gauss"]
    items, z, index = [], 0.0, [float(n) for n in lens.system.index[1]]
    for number, row in enumerate(lens, 1):
        shape = batoid.Sphere(1 / float(row.curvature)) if float(row.curvature) else batoid.Plane()
        media = {"inMedium": batoid.ConstMedium(index[number - 1]), "outMedium": batoid.ConstMedium(index[number])}
        items.append(batoid.RefractiveInterface(shape, coordSys=batoid.CoordSys(origin=[0, 0, z]), **media))
        z += float(row.thickness)
    items.append(batoid.Detector(batoid.Plane(), coordSys=batoid.CoordSys(origin=[0, 0, z])))
    start = lenstrace.trace(lens, field=14.0, pupil=(np.append(0.0, POINTS[0]), np.append(0.0, POINTS[1])))
    launched = [np.array(part[0]) for part in (start.x, start.y, start.z, start.l, start.m, start.n)]
    # a ray's time is its phase on a plane wave
    phase = launched[1] * launched[4] + launched[0] * launched[3]
    rays = batoid.RayVector(*launched, t=phase)
    batoid.CompoundOptic(items).trace(rays)
    place, course, t = np.array(rays.r), np.array(rays.v), np.array(rays.t)
    # back to the sphere that Optiland used; batoid's velocities are those of light in air
    apart = place - place[0]
    along = (apart * course).sum(1)
    back = along + np.sqrt(117.26866526678313**2 - (apart**2).sum(1) + along**2)
    path = t - back
    assert_allclose(opd(lens, *POINTS)[2, 1], (path[0] - path[1:]) / 0.5876e-3, atol=1e-6)


def judged(lens: Lens, field: float, points: list[tuple[float, float]]) -> np.ndarray:
    """W in waves of rays at the primary wavelength, in 50 digits: whole paths, and a sphere met by the textbook."""
    with mp.workdps(50):
        index = indices_of(lens, None)
        # where the stop's centre is seen from behind, by a y-u trace
        y, u = mp.zero, mp.one
        for i, row in enumerate(lens.rows[lens.stop - 1 :], lens.stop):
            u = (index[i - 1] * u - y * mp.mpf(float(row.curvature)) * (index[i] - index[i - 1])) / index[i]
            y += mp.mpf(float(row.thickness)) * u
        pupil = -y / u
        paths: list[Any] = []
        centre: Any = None
        radius: Any = None
        for point in [(0.0, 0.0), *points]:
            start, direction = reference_launch(lens, (0.0, field), point)
            if lens.object_distance is None:
                before = index[0] * (start @ direction)
            else:
                # the object lies on the ray, at its distance
                before = index[0] * (start[2] + mp.mpf(lens.object_distance)) / direction[2]
            end = reference_trace(lens, start, direction)[-1]
            place, course = np.array([end.x, end.y, end.z]), np.array([end.l, end.m, end.n])
            if centre is None:
                centre = place
                radius = mp.sqrt(place[0] ** 2 + place[1] ** 2 + (place[2] - pupil) ** 2)
            apart = place - centre
            along = apart @ course
            back = along + mp.sqrt(radius**2 - apart @ apart + along**2)
            paths.append(before + end.opl - index[-1] * back)
        um = mp.mpf(lens.wavelengths.um[lens.wavelengths.primary])
        return np.array([float((paths[0] - path) * 1000 / um) for path in paths[1:]])


@pytest.mark.parametrize(("name", "distance"), [("phone_lens", None), ("double_gauss", 1e6), ("double_gauss", 1e12)])
def test_path_differences_in_50_digits(name: str, distance: float | None, designs: dict[str, Lens]) -> None:
    lens = designs[name] if distance is None else designs[name].replace(object_distance=distance)
    x, y = np.array([0.0, 0.0, 0.6]), np.array([1.0, -0.9, 0.5])
    field = float(lens.fields.y[-1])
    found = opd(lens, x, y)[-1, lens.wavelengths.primary]
    expected = judged(lens, field, list(zip(x.tolist(), y.tolist(), strict=True)))
    assert np.abs(expected).max() > 1
    assert_allclose(found, expected, atol=1e-10)


def test_best_sphere(designs: dict[str, Lens]) -> None:
    singlet = designs["singlet_rear_stop"]
    at = functools.partial(wavefront, samples=17)
    best, chief, primary = (at(singlet, reference=name) for name in ("best", "chief", "primary"))
    assert (np.asarray(best.rms) < np.minimum(chief.rms, primary.rms)).all()
    # on the axis it is the least of all image surfaces: a curve through the lowest of a scan
    shifts = np.linspace(0, 3.2, 17)
    surface, place = len(singlet), float(singlet.thickness[-1])
    scanned = np.array([at(singlet.replace(surface=surface, thickness=place + s)).rms[0] for s in shifts]) ** 2
    for wave, squares in enumerate(scanned.T):
        low = int(squares.argmin())
        assert 1 < low < len(shifts) - 2
        near = slice(low - 2, low + 3)
        fine = np.linspace(shifts[low - 1], shifts[low + 1], 2001)
        least = np.polyval(np.polyfit(shifts[near], squares[near], 4), fine).min()
        assert_allclose(best.rms[0, wave], np.sqrt(least), rtol=1e-3)


def test_obscured_rays_count_nowhere(designs: dict[str, Lens]) -> None:
    front = wavefront(designs["hubble"], samples=65)
    radius = np.hypot(front.pupil_x, front.pupil_y)
    shadow = 396 / 1200
    assert np.isnan(front.opd[0, 0][radius < shadow - 0.001]).all()
    assert np.isfinite(front.opd[0, 0][(radius > shadow + 0.001) & (radius <= 1)]).all()
    assert_allclose(np.asarray(front.share[0, 0]).sum() / 32**2 / np.pi, 1 - shadow**2, rtol=5e-3)
    # over an annulus the mean square of the map is the figure
    arrived = np.isfinite(front.opd[0, 0])
    weights, values = np.asarray(front.share[0, 0])[arrived], np.asarray(front.opd[0, 0])[arrived]
    assert_allclose(front.rms[0, 0], np.sqrt(np.cov(values, aweights=weights, ddof=0)), rtol=0.02)


def test_float32(designs: dict[str, Lens]) -> None:
    lens = designs["double_gauss"]
    narrow = opd(lens.astype(np.float32), *POINTS)
    assert narrow.dtype == np.float32
    assert_allclose(narrow, opd(lens, *POINTS), atol=0.01)


def figures_of(curvature: jax.Array) -> jax.Array:
    """Of a parabola, perfect where its radius is -200 mm."""
    front = wavefront(conic_mirror(-200.0, -1.0, -100.0).replace(curvature=curvature), samples=9)
    return front.rms.sum() + front.rms_without_focus.sum() + front.strehl.sum()


def test_gradient_against_differences() -> None:
    curvature, step = jnp.array([-1 / 200.001]), 1e-11
    slope = jax.jit(jax.grad(figures_of))
    gradient = slope(curvature)
    difference = (figures_of(curvature + step) - figures_of(curvature - step)) / (2 * step)
    assert_allclose(gradient[0], difference, rtol=1e-4)
    # a perfect wavefront does not spoil it
    assert np.isfinite(slope(jnp.array([-1 / 200.0]))).all()


def test_under_jit() -> None:
    lens = doublet()
    jitted = jax.jit(lambda lens: wavefront(lens, samples=9).rms)(lens)
    assert_allclose(jitted, wavefront(lens, samples=9).rms, rtol=1e-9)


def test_a_lens_of_other_numbers_compiles_nothing() -> None:
    names: list[str] = []

    def heard(event: str, _: float, **more: str) -> None:
        if event == COMPILED:
            names.append(more.get("fun_name", "?"))

    def asked(lens: Lens) -> None:
        zernike_coefficients(wavefront(lens, samples=9), count=9)

    asked(doublet())
    jax.monitoring.register_event_duration_secs_listener(heard)
    other = doublet(3.3).replace(fields=Fields((0.1, 0.0), (1.0, 1.7), "angle"))
    asked(other.replace(surface=1, glass="N-LAK8"))
    jax.monitoring.unregister_event_duration_listener(heard)
    assert names == []


@pytest.mark.parametrize("samples", [8, 1026, 33.0, True])
def test_samples_that_are_no_grid(samples: Any, designs: dict[str, Lens]) -> None:
    with pytest.raises(RayError, match="samples across the pupil"):
        wavefront(designs["double_gauss"], samples=samples)
