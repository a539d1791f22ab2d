"""Third-order aberrations: against published sums, closed forms, exact rays near the axis, and paraxial colour."""

import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens, PrescriptionError
from lenstrace.analysis.aberrations import seidel as computed
from lenstrace.analysis.third_order import Seidel
from lenstrace.plotting.aberrations import plot_seidel, seidel_figure

LENSES = json.loads((Path(__file__).parent.parent / "figures" / "seidel.json").read_text())["lenses"]
FIVE = ("spherical", "coma", "astigmatism", "petzval", "distortion")


def seidel(lens: Lens, field: float | None = None) -> Seidel:
    """In numpy, where sums of the result are not compiled one by one."""
    return jax.device_get(computed(lens, field=field))


def five(result: Seidel) -> np.ndarray:
    """S_I ... S_V of a lens."""
    return np.array([getattr(result.total, name) for name in FIVE])


def lens_of(rows: list[dict], diameter: float = 10.0, angle: float = 1.0) -> Lens:
    """A lens of one wavelength with its object at infinity."""
    return lenstrace.lens(
        rows, {"entrance_pupil_diameter": diameter}, {"kind": "angle", "y": [0.0, angle]}, {"um": [0.5]}
    )


@pytest.mark.parametrize("name", LENSES)
def test_reference_lenses(name: str, designs: dict[str, Lens]) -> None:
    assert_allclose(five(seidel(designs[name])), [LENSES[name][key] for key in FIVE], rtol=1e-11)


def everything() -> Lens:
    """What can go wrong together: a dispersive object space, r^2 terms, conics, a mirror, a field lens at an image
    with asphere terms, a negative index."""
    return lenstrace.lens(
        [
            {"radius": 40.0, "conic": -0.7, "asphere": {2: 2e-3, 4: 1e-6, 6: 1e-10}, "thickness": 6, "index": 1.7},
            {"thickness": 30.0, "asphere": {4: -2e-6}},
            {"radius": -300.0, "conic": 2.0, "thickness": -25.0, "mirror": True},
            {"radius": 80.0, "thickness": -5.0, "index": -1.5, "asphere": {2: 1e-3}},
            {"radius": -90.0, "thickness": -10.0},
            {"thickness": -20.0, "stop": True},
            {"radius": -50.0, "thickness": -5.0, "index": {"um": [0.5, 0.6], "n": [1.6, 1.58]}},
            {"radius": 70.0, "thickness": -100.0},
        ],
        {"entrance_pupil_diameter": 8.0},
        {"kind": "object_height", "x": [0.0, 3.0], "y": [0.0, 4.0]},
        {"um": [0.5, 0.6], "primary": 0.6},
        object_distance=150.0,
        object_index={"um": [0.5, 0.6], "n": [1.35, 1.33]},
    )


def even(lens: Lens) -> Lens:
    """Odd asphere terms left out."""
    for number, row in enumerate(lens, 1):
        if row.powers:
            terms = dict(zip(row.powers, row.coefficients, strict=True))
            lens = lens.replace(surface=number, asphere={p: a for p, a in terms.items() if p % 2 == 0})
    return lens


def paraxial_ray(lens: Lens, wave: int, y: float, slope: float) -> tuple[float, float]:
    """Height and geometric slope behind the last row of a ray given in front of the first."""
    index = np.array(lens.system.orientation) * np.asarray(lens.system.index)[wave]
    w = index[0] * slope
    for i, row in enumerate(lens):
        terms = dict(zip(row.powers, row.coefficients, strict=True))
        y += np.asarray(lens.thickness)[i - 1] * w / index[i] if i else 0.0
        w -= y * (row.curvature + 2 * terms.get(2, 0.0)) * (index[i + 1] - index[i])
    return y, w / index[-1]


def image_plane(lens: Lens) -> float:
    """Place of the paraxial image, mm from the last row."""
    y, slope = (1.0, 0.0) if lens.object_distance is None else (1.0, 1 / float(lens.object_distance))
    y, slope = paraxial_ray(lens, lens.wavelengths.primary, y, slope)
    return -y / slope


def exact(lens: Lens, field: float, scale: float, px: np.ndarray, py: np.ndarray) -> np.ndarray:
    """Where real rays of field and pupil, both `scale` times as large, meet the plane of the paraxial image, mm."""
    small = np.degrees(np.arctan(scale * np.tan(np.radians(field)))) if lens.fields.kind == "angle" else scale * field
    path = lenstrace.trace(lens, field=small, pupil=(scale * px, scale * py))
    assert np.asarray(path.has_course).all()
    x, y, z, l, m, n = (np.asarray(getattr(path, name))[len(lens)] for name in "xyzlmn")
    distance = (image_plane(lens) - z) / n
    return np.array([x + distance * l, y + distance * m])


@pytest.mark.parametrize(
    ("name", "scales"),
    [
        ("phone_lens", (1 / 64, 1 / 128)),
        ("everything", (1 / 16, 1 / 32)),
    ],
)
def test_real_rays_near_the_axis(name: str, scales: tuple[float, float], designs: dict[str, Lens]) -> None:
    lens = everything() if name == "everything" else even(designs[name]).replace(ray_aiming=False)
    result = seidel(lens)
    field = float(np.hypot(lens.fields.x[-1], lens.fields.y[-1]))
    px, py = np.array([0, 0, 0.6, -0.5, 0.8, 0]), np.array([1, -1, 0.8, 0.5, -0.6, 0])
    t, ideal = result.transverse(), float(result.lagrange_invariant / (result.image_index * result.image_slope))
    r2 = px**2 + py**2
    third = np.array([
        t.spherical * r2 * px + t.sagittal_coma * 2 * px * py + t.sagittal_field * px,
        t.spherical * r2 * py + t.sagittal_coma * (r2 + 2 * py**2) + t.tangential_field * py + t.distortion,
    ])  # fmt: skip
    aberration, left = [], []
    for scale in scales:
        missed = exact(lens, field, scale, px, py) - scale * np.array([[0.0], [ideal]])
        aberration.append(np.abs(missed).max())
        left.append(np.abs(missed - scale**3 * third).max())
    # halved: aberrations fall by 2^3, what third order leaves of them by 2^5
    assert_allclose(np.log2(aberration[0] / aberration[1]), 3, atol=0.1)
    assert_allclose(np.log2(left[0] / left[1]), 5, atol=0.1)
    assert left[1] < 0.03 * aberration[1]


def test_longitudinal_figures_are_foci_of_real_rays(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    result, h = seidel(lens), 1e-4
    along, scale = result.longitudinal(), 0.02
    path = lenstrace.trace(lens, pupil=(0.0, scale))
    focus = image_plane(lens)
    y, z, m, n = (float(getattr(path, name)[len(lens)]) for name in "yzmn")
    assert_allclose(z - y * n / m - focus, scale**2 * along.spherical, rtol=2e-3)
    # tangential and sagittal focus of narrow pencils about the chief ray
    field = np.degrees(np.arctan(scale * np.tan(np.radians(lens.fields.y[-1]))))
    path = lenstrace.trace(lens, field=field, pupil=(np.array([0, 0, h, -h]), np.array([h, -h, 0, 0])))
    x, y, z, l, m, n = (np.asarray(getattr(path, name))[len(lens)] for name in "xyzlmn")
    tangent = m / n
    height = y - z * tangent
    sagittal = -(x[2] - z[2] * l[2] / n[2] - x[3] + z[3] * l[3] / n[3]) / (l[2] / n[2] - l[3] / n[3])
    assert_allclose(-np.diff(height[:2]) / np.diff(tangent[:2]) - focus, scale**2 * along.tangential_field, rtol=5e-3)
    assert_allclose(sagittal - focus, scale**2 * along.sagittal_field, rtol=5e-3)
    assert_allclose(along.astigmatism, along.tangential_field - along.sagittal_field, rtol=1e-12)
    # sag of the Petzval surface at the paraxial image height
    image = result.lagrange_invariant / (result.image_index * result.image_slope)
    assert_allclose(along.petzval, image**2 / 2 / result.petzval_radius, rtol=1e-12)


def test_colour_is_that_of_paraxial_rays() -> None:
    """Differences of rays of nearly the same wavelength, in a lens whose object stands in a dispersive medium."""
    small = 1e-6
    lens = everything()
    glass = {"um": [0.5, 0.6], "n": [1.58 + small, 1.58]}
    lens = lens.replace(surface=7, index=glass).replace(surface=1, index={**glass, "n": [1.7 + 2 * small, 1.7]})
    oil = lenstrace.lens([{"stop": True}], {"entrance_pupil_diameter": 1.0}, {"y": [0.0]}, {"um": [0.5, 0.6]},
                         object_index={**glass, "n": [1.33 + small, 1.33]}).object_medium  # fmt: skip
    lens = lens.replace(object_medium=oil)
    result, distance, plane = seidel(lens), 150.0, image_plane(lens)

    def arrives(wave: int, y: float, slope: float) -> float:
        """Height in the image plane of a ray that leaves the object with a geometric slope."""
        y, slope = paraxial_ray(lens, wave, y + slope * distance, slope)
        return y + plane * slope

    y, chief_y = float(result.marginal_height[0]), float(result.chief_height[0])
    object_height = 5.0
    axial = arrives(0, 0.0, y / distance) - arrives(1, 0.0, y / distance)
    slope = (chief_y - object_height) / distance
    lateral = arrives(0, object_height, slope) - arrives(1, object_height, slope)
    t = result.transverse()
    assert_allclose([t.axial_colour, t.lateral_colour], [axial, lateral], rtol=1e-4)
    assert_allclose(result.longitudinal().axial_colour, -axial / result.image_slope, rtol=1e-4)


def test_mirrors_in_closed_form() -> None:
    """f = 100, y = 5: Welford (1986), section 8.9; Schroeder, Astronomical Optics (2000), chapter 6."""
    f, y, angle = 100.0, 5.0, 1.0
    tangent = np.tan(np.radians(angle))
    mirror = {"radius": -2 * f, "thickness": -f, "mirror": True}

    def of(distance: float, conic: float) -> Seidel:
        return seidel(lens_of([{"thickness": distance, "stop": True}, {**mirror, "conic": conic}]))

    h = y * tangent
    # a paraboloid that is the stop; sagittal coma is f tan / (16 F^2)
    parabola = of(0.0, -1.0)
    assert_allclose(five(parabola), [0, -(y**2) * h / (2 * f**2), h**2 / f, -(h**2) / f, 0], atol=1e-15)
    coma = f * tangent / (16 * (f / (2 * y)) ** 2)
    assert_allclose(np.abs(parabola.transverse()[1:3]), [3 * coma, coma], rtol=1e-12)
    assert_allclose(parabola.petzval_radius, -f, rtol=1e-14)
    # with the stop in its focal plane it has no astigmatism
    assert_allclose(five(of(f, -1.0))[:3], [0, -(y**2) * h / (2 * f**2), 0], atol=1e-15)
    # a sphere with the stop in its centre has spherical aberration and field curvature alone
    sphere = of(2 * f, 0.0)
    assert_allclose(five(sphere), [y**4 / (4 * f**3), 0, 0, -(h**2) / f, 0], atol=1e-16)
    assert_allclose(sphere.waves().W040, y**4 / (32 * f**3) / 0.5e-3, rtol=1e-12)
    # Schmidt's plate takes it away: a (n - 1) = 1 / (4 R^3)
    plate = {"thickness": 0.5, "index": 1.5}
    figure = {"thickness": 2 * f, "stop": True, "asphere": {4: 1 / (32 * f**3) / 0.5}}
    schmidt = seidel(lens_of([plate, figure, mirror]))
    assert_allclose(five(schmidt), [0, 0, 0, -(h**2) / f, 0], atol=1e-16)
    assert_allclose(schmidt.aspheric_part.spherical, [0, -(y**4) / (4 * f**3), 0], rtol=1e-12)


def test_stigmatic_surfaces(designs: dict[str, Lens]) -> None:
    # hyperhemisphere and lens of an immersion objective: aplanatic, concentric, aplanatic
    found = seidel(designs["immersion_objective"], field=0.01)
    for name in ("spherical", "coma", "astigmatism"):
        assert_allclose(np.asarray(getattr(found.surfaces, name))[[1, 3]], 0, atol=1e-14)
    assert_allclose([found.surfaces.spherical[2], found.surfaces.coma[2]], 0, atol=1e-14)
    # distortion goes through A = 0 of that concentric surface smoothly, and is (Abar/A)(S_III + S_IV) beside it
    assert abs(float(found.surfaces.distortion[2])) > 1e-9
    bent = seidel(designs["immersion_objective"].replace(surface=3, curvature=-1 / 8.001), field=0.01)
    y, chief = bent.marginal_height, bent.chief_height
    slope, chief_slope = (y[2] - y[1]) / 0.5, (chief[2] - chief[1]) / 0.5
    ratio = (chief_slope - chief[2] / 8.001) / (slope - y[2] / 8.001)
    usual = ratio * (bent.surfaces.astigmatism[2] + bent.surfaces.petzval[2])
    assert_allclose(bent.surfaces.distortion[2], usual, rtol=1e-9)
    assert_allclose(found.surfaces.distortion[2], usual, rtol=1e-2)
    # on the axis alone nothing but spherical aberration, and that is none
    assert_allclose(five(seidel(designs["hyperbolic_singlet"])), 0, atol=1e-14)


def test_aperture_and_fields_of_a_near_object(designs: dict[str, Lens]) -> None:
    relay = designs["relay_one_to_one"].replace(ray_aiming=False)
    found, distance, sine, height = seidel(relay), relay.object_distance, 0.08, 5.0
    slope = sine / np.sqrt(1 - sine**2)
    assert_allclose(found.marginal_height[0], distance * slope, rtol=1e-14)
    assert_allclose([found.lagrange_invariant, found.field], [slope * height, height], rtol=1e-12)
    # by symmetry about the stop
    assert_allclose([found.total.coma, found.total.distortion, found.total.lateral_colour], 0, atol=1e-16)
    half = seidel(relay, field=2.5)
    assert_allclose(five(half)[2:4], five(found)[2:4] / 4, rtol=1e-12)


def test_an_image_at_infinity_has_sums_and_no_transverse_figures(designs: dict[str, Lens]) -> None:
    found = seidel(designs["afocal_expander"])
    assert np.isfinite(five(found)).all()
    assert np.isnan([*found.transverse(), *found.longitudinal()]).all()
    assert np.isfinite(found.waves()).all()


def test_derivatives_batches_and_precision(designs: dict[str, Lens]) -> None:
    lens = designs["cemented_doublet"]

    def figure(curvature: jax.Array) -> jax.Array:
        total = computed(lens.replace(curvature=curvature)).total
        return sum((weight * getattr(total, name) for weight, name in enumerate(FIVE, 1)), total.axial_colour)

    c, h = jnp.asarray(lens.curvature), 1e-6
    steps = h * jnp.concatenate([jnp.zeros((1, len(c))), jnp.eye(len(c)), -jnp.eye(len(c))])
    values, gradients = jax.jit(jax.vmap(jax.value_and_grad(figure)))(c + steps)
    assert_allclose(values[0], five(seidel(lens)) @ np.arange(1, 6) + seidel(lens).total.axial_colour, rtol=1e-11)
    difference = (values[1 : len(c) + 1] - values[len(c) + 1 :]) / (2 * h)
    assert_allclose(gradients[0], difference, rtol=1e-6, atol=1e-6)
    single = seidel(lens.astype("float32"))
    assert {leaf.dtype.name for leaf in jax.tree.leaves(single)} == {"float32"}
    assert_allclose(five(single), five(seidel(lens)), rtol=2e-3)


def test_what_third_order_cannot_describe_is_refused(designs: dict[str, Lens]) -> None:
    with pytest.raises(PrescriptionError, match="90 degrees, got 110"):
        seidel(designs["fisheye"])
    with pytest.raises(PrescriptionError, match=r"surface 2: the asphere term r\^3"):
        seidel(designs["phone_lens"])


def test_plot(designs: dict[str, Lens]) -> None:
    axes = Figure().add_subplot()
    result = seidel(designs["double_gauss"])
    assert plot_seidel(result, axes) is axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("surface", "Seidel sum, µm")
    # the stop adds nothing
    assert [text.get_text() for text in axes.get_xticklabels()] == [*"12345", *"789", "10", "11", "total"]
    legend = axes.get_legend()
    assert legend is not None
    assert len(legend.get_texts()) == 7
    heights = [bar.get_height() for bar in axes.containers[0]]  # type: ignore[attr-defined]
    assert_allclose(heights[-1], 1000 * LENSES["double_gauss"]["spherical"], rtol=1e-9)
    seidel_figure(result, designs["double_gauss"].name).draw_without_rendering()
