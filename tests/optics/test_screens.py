"""Phase screens against closed forms, the law of interaction in 40 digits, and each other; what a file says of them."""

import functools
import itertools
import re
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from jax.typing import ArrayLike
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens, PrescriptionError, RayStatus
from lenstrace.optics.interactions import Interaction, bend
from lenstrace.optics.screens.grid import GridScreen
from lenstrace.optics.screens.lenses import IdealLens
from lenstrace.optics.screens.point_mass import PointMass
from lenstrace.optics.screens.screen import Screen, path_and_slopes
from lenstrace.optics.vectors import Vector

UM, MM = 0.55, 0.55e-3
GRID = {"half_width": [12.0, 9.0], "path": (1e-3 * np.random.default_rng(1).standard_normal((7, 9))).tolist()}
SCREENS = {
    "ideal_lens": 100.0,
    "quadratic_lens": -80.0,
    "grating": {"period": 0.003, "order": -2, "angle": 37.0},
    "zernike": {"radius": 11.0, "order": "noll", "terms": {4: 2e-3, 7: -1e-3, 11: 5e-4}},
    "grid": GRID,
    "point_mass": 1e-4,
}
# the order in which one ray meets them: the last on a mirror
TRAIN = sorted(SCREENS, key=lambda kind: kind == "quadratic_lens")
every_screen = pytest.mark.parametrize("kind", SCREENS)


def flat(screen: object, **row: object) -> Lens:
    """One surface in air, a screen on it, 100 mm before the image."""
    rows = [{"thickness": 100.0, "stop": True, **({} if screen is None else {"screen": screen}), **row}]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 20.0}, [0.0], [0.5, UM])


def train() -> Lens:
    """A screen of each kind one behind the other, 2 mm apart, the last on a curved mirror: all kinds in one program."""
    mirror = {"mirror": True, "thickness": -100.0, "radius": -70.0}
    rows = [{"thickness": 2.0, "screen": {kind: SCREENS[kind]}} for kind in TRAIN]
    return lenstrace.lens(
        [{**rows[0], "stop": True}, *rows[1:-1], {**rows[-1], **mirror}], {"entrance_pupil_diameter": 20.0}, [0.0], [UM]
    )


@functools.cache
def through_the_train() -> Callable[[tuple[Screen, ...], ArrayLike, ArrayLike, ArrayLike], Any]:
    """Where a ray along the axis ends and how it came there, by the numbers of all screens, how far apart they are, and
    where it starts; with derivatives by the screens and the start."""
    lens = train()

    def place(
        screens: tuple[Screen, ...], gap: jax.Array, x: jax.Array, y: jax.Array
    ) -> tuple[jax.Array, lenstrace.Ray]:
        changed = lens.replace(surface=len(screens), screen=screens[-1])
        for number, screen in enumerate(screens[:-1], 1):
            changed = changed.replace(surface=number, screen=screen, thickness=gap)
        path = lenstrace.trace(changed, rays=lenstrace.ray((x, y, 0.0), (0.0, 0.0, 1.0)))
        assert path.opl is not None
        return path.x[-1] + 2 * path.y[-1] + 3 * path.opl[-1], path

    return jax.jit(jax.value_and_grad(place, argnums=(0, 2, 3), has_aux=True))


def screens_of_the_train() -> tuple[Screen, ...]:
    """Their numbers as arrays, so that all calls are of one kind."""
    lens = train()
    return jax.tree.map(np.asarray, tuple(lens[number].screen for number in range(1, len(SCREENS) + 1)))


def inclined(count: int = 40) -> lenstrace.Ray:
    """Rays from all sides."""
    some = np.random.default_rng(2)
    point = some.uniform(-7, 7, (3, count))
    l, m = some.uniform(-0.4, 0.4, (2, count))
    return lenstrace.ray(tuple(point), (l, m, np.sqrt(1 - l * l - m * m)))


def test_the_ideal_lens_focuses_to_one_point() -> None:
    end = lenstrace.trace(flat({"ideal_lens": 100.0}), pupil=(0.3, np.linspace(-1, 1, 9)), path=False)
    assert np.abs(np.asarray(end.y)).max() <= 1e-12
    assert_allclose(end.opl, 100.0, rtol=1e-15)
    diverging = lenstrace.trace(flat({"ideal_lens": -100.0}), pupil=(0.0, np.array([0.2, 1.0])))
    assert_allclose(-diverging.y[1] * diverging.n[1] / diverging.m[1], -100.0, rtol=1e-14)


def test_the_quadratic_lens_crosses_where_its_closed_form_says() -> None:
    path = lenstrace.trace(flat({"quadratic_lens": 100.0}), pupil=(0.0, np.array([0.5, 1.0])))
    crossing = -path.y[1] * path.n[1] / path.m[1]
    assert_allclose(crossing, np.sqrt(100.0**2 - np.array([5.0, 10.0]) ** 2), rtol=1e-14)
    assert float(crossing[1]) == pytest.approx(99.498743710662, abs=5e-13)


@pytest.mark.parametrize(("order", "degrees"), [*itertools.product([-2, -1, 0, 1, 2], [0.0, 20.0, -65.0])])
def test_grating_orders_obey_the_grating_equation(order: int, degrees: float) -> None:
    lens = flat({"grating": {"period": 0.0025, "order": order, "angle": 90.0}}, index=1.4)
    incident = np.sin(np.radians(degrees))
    start = lenstrace.ray((0.0, 1.0, 0.0), (0.0, incident, np.sqrt(1 - incident**2)))
    path = lenstrace.trace(lens, rays=start)
    assert float(path.m[1]) == pytest.approx((incident + order * MM / 0.0025) / 1.4, abs=1e-14)
    other = lenstrace.trace(lens, rays=start, wavelength=0.5)
    assert float(other.m[1]) == pytest.approx((incident + order * 0.5e-3 / 0.0025) / 1.4, abs=1e-14)


def test_conical_diffraction_keeps_the_momentum_along_the_lines() -> None:
    lens = flat({"grating": {"period": 0.0025, "order": 1, "angle": 0.0}})
    path = lenstrace.trace(lens, rays=lenstrace.ray((0, 0, 0), (0.1, 0.3, np.sqrt(0.9))))
    assert_allclose([path.l[1], path.m[1]], [0.1 + MM / 0.0025, 0.3], atol=1e-15)


def test_an_order_that_does_not_exist_is_a_lost_ray_with_finite_derivatives() -> None:
    @jax.jit
    @functools.partial(jax.grad, has_aux=True)
    def slope(period: jax.Array) -> tuple[jax.Array, lenstrace.Ray]:
        lens = flat(None).replace(surface=1, screen={"grating": {"period": period, "order": 1, "angle": 90.0}})
        path = lenstrace.trace(lens, pupil=(0.0, 0.5))
        return path.m[-1], path

    none, lost = slope(5e-4)
    assert RayStatus(int(lost.status[-1])) is RayStatus.TIR
    assert int(lost.surface[-1]) == 1
    assert none == 0
    assert float(slope(5e-3)[0]) == pytest.approx(-MM / 5e-3**2, rel=1e-12)


@every_screen
def test_a_screen_of_nothing_changes_nothing(kind: str) -> None:
    nothing = {
        "ideal_lens": 1e300,
        "quadratic_lens": 1e300,
        "grating": {"period": 1.0, "order": 0},
        "zernike": {"radius": 10.0, "terms": {4: 0.0}},
        "grid": {"half_width": [5, 5], "path": np.zeros((5, 6))},
        "point_mass": 1e-300,
    }
    rows = [
        {"stop": True, "thickness": 5.0},
        {"radius": 40.0, "index": 1.5, "thickness": 9.0},
        {"mirror": True, "radius": -90.0, "thickness": -100.0},
    ]
    screened = [{**row, "screen": {kind: nothing[kind]}} for row in rows]
    plain, found = (
        lenstrace.trace(lenstrace.lens(each, {"entrance_pupil_diameter": 20.0}, [0.0], [UM]), rays=inclined())
        for each in (rows, screened)
    )
    assert np.asarray(plain.ok).all()
    for name in "xyzlmn":
        assert_allclose(getattr(found, name), getattr(plain, name), rtol=0, atol=4e-14)
    assert_allclose(found.opl, plain.opl, rtol=1e-15, atol=4e-14)


def test_a_screen_of_nothing_in_air_changes_no_bit() -> None:
    start = inclined()
    found = lenstrace.trace(flat({"zernike": {"radius": 10.0, "terms": {4: 0.0, 9: 0.0}}}), rays=start)
    for name in "lmn":
        np.testing.assert_array_equal(getattr(found, name)[1], getattr(start, name))


OPPOSITE = {
    "ideal_lens": -100.0,
    "quadratic_lens": 80.0,
    "grating": {"period": 0.003, "order": 2, "angle": 37.0},
    "zernike": {"radius": 11.0, "order": "noll", "terms": {4: -2e-3, 7: 1e-3, 11: -5e-4}},
    "grid": {"half_width": GRID["half_width"], "path": -np.array(GRID["path"])},
}


@pytest.mark.parametrize("kind", OPPOSITE)
def test_a_screen_and_its_negative_cancel(kind: str) -> None:
    rows = [{"stop": True, "screen": {kind: SCREENS[kind]}}, {"screen": {kind: OPPOSITE[kind]}, "thickness": 50.0}]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 20.0}, [0.0], [UM])
    start = inclined()
    path = lenstrace.trace(lens, rays=start)
    assert np.asarray(path.ok[1]).all()
    for name in "lmn":
        assert_allclose(getattr(path, name)[2], getattr(start, name), rtol=0, atol=1e-15)
    step = np.hypot(np.hypot(path.x[1] - start.x, path.y[1] - start.y), start.z)
    assert_allclose(path.opl[2], -np.sign(start.z) * step, atol=2e-14)


@jax.jit
def sent_back(screen: Screen, there: lenstrace.Ray, index_behind: jax.Array) -> tuple[Vector, jax.Array]:
    """Directions behind a sphere of the radius 60 of rays that come back to where they are, into air."""
    back = tuple(-d for d in (there.l, there.m, there.n))
    normal = (-there.x / 60, -there.y / 60, 1 - there.z / 60)
    along = sum((n * d for n, d in zip(normal, back, strict=True)), jnp.zeros_like(there.x))
    _, push = path_and_slopes(screen, there.x, there.y, jnp.asarray(MM))
    geometry = (back, normal, jnp.ones_like(along), jnp.abs(along), jnp.sign(along))
    either = Interaction.REFRACT_EITHER_SIGN
    return bend(either, *geometry, index_behind, jnp.asarray(1.0), jnp.full(along.shape, True), push)


@every_screen
def test_light_sent_back_retraces_its_way(kind: str) -> None:
    start = inclined()
    for index in (1.0, 1.6, -1.2):
        lens = flat({kind: SCREENS[kind]}, radius=60.0, index=index)
        there = jax.tree.map(lambda a: a[1], lenstrace.trace(lens, rays=start))
        assert np.asarray(there.ok).all()
        direction, bends = sent_back(lens[1].screen, there, jnp.asarray(index))
        assert np.asarray(bends).all()
        for found, sent in zip(direction, (start.l, start.m, start.n), strict=True):
            assert_allclose(found, -sent, rtol=0, atol=3e-15, err_msg=f"index {index}")


@pytest.mark.parametrize("interaction", Interaction)
def test_the_law_in_40_digits(interaction: Interaction) -> None:
    """p = n1 d1 + grad W along the surface is n2 d2 along it, d2 a unit vector to the right side."""
    some = np.random.default_rng(3)
    mp = mpmath.mp
    judged = 0
    with mp.workdps(40):
        for _ in range(30):
            d = some.standard_normal(3)
            d /= np.sqrt(d @ d)
            normal = np.append(some.uniform(-0.5, 0.5, 2), 1.0)
            push = some.uniform(-0.2, 0.2, 2)
            n1, n2 = 1.3, -1.6 if interaction is Interaction.REFRACT_EITHER_SIGN else 1.6
            exact = [[mp.mpf(float(a)) for a in v] for v in (d, normal, np.append(push, 0.0))]
            length = mp.sqrt(sum(a * a for a in exact[1]))
            unit = [a / length for a in exact[1]]
            behind = mp.mpf(n1) if interaction is Interaction.REFLECT else mp.mpf(n2)
            momentum = [mp.mpf(n1) * a + w for a, w in zip(exact[0], exact[2], strict=True)]
            across = sum(a * b for a, b in zip(momentum, unit, strict=True))
            tangent = [(a - across * b) / behind for a, b in zip(momentum, unit, strict=True)]
            square = 1 - sum(a * a for a in tangent)
            cosine = sum(a * b for a, b in zip(exact[0], unit, strict=True))
            sign = mp.sign(cosine) * (-1 if interaction is Interaction.REFLECT else 1)
            if square <= 0:
                continue
            judged += 1
            expected = [float(a + sign * mp.sqrt(square) * b) for a, b in zip(tangent, unit, strict=True)]
            numbers = tuple(map(jnp.asarray, d)), tuple(map(jnp.asarray, normal))
            along = jnp.asarray(d @ normal)
            geometry = (*numbers, jnp.asarray(normal @ normal), jnp.abs(along), jnp.sign(along))
            slopes = jnp.asarray(push[0]), jnp.asarray(push[1])
            found, bends = bend(interaction, *geometry, jnp.asarray(n1), jnp.asarray(n2), jnp.asarray(True), slopes)
            assert bool(bends)
            # near grazing exit the direction is as uncertain as its square root
            assert_allclose(found, expected, rtol=0, atol=2e-15 / max(float(mp.sqrt(square)), 1e-3))
    assert judged >= 20


def test_derivatives_are_those_of_differences() -> None:
    run, start = through_the_train(), (np.float64(2), np.float64(3.1), np.float64(6.2))
    numbers, structure = jax.tree.flatten(screens_of_the_train())
    (_, path), (slopes, *_) = run(structure.unflatten(numbers), *start)
    assert np.asarray(path.ok).all()
    for at, slope in enumerate(jax.tree.leaves(slopes)):
        step = 1e-6 * max(0.1, np.abs(numbers[at]).max())
        toward = np.random.default_rng(4).standard_normal(numbers[at].shape)
        sides = [[n + s * step * toward if i == at else n for i, n in enumerate(numbers)] for s in (1, -1)]
        ends = [run(structure.unflatten(jax.tree.map(np.asarray, side)), *start)[0][0] for side in sides]
        difference = float(ends[0] - ends[1]) / (2 * step)
        assert float(np.sum(slope * toward)) == pytest.approx(difference, rel=2e-6, abs=1e-6), f"number {at}"


def test_everything_is_finite_at_the_vertex() -> None:
    """All screens stand at one place, so that the ray of the axis meets the vertex of each, turned or not."""
    zero = np.float64(0)
    (value, path), slopes = through_the_train()(screens_of_the_train(), zero, zero, zero)
    assert np.abs([path.x[:-1], path.y[:-1]]).max() == 0
    assert np.isfinite(value)
    assert all(np.isfinite(slope).all() for slope in jax.tree.leaves(slopes))
    assert np.isfinite(np.asarray(lenstrace.first_order(train()).power)).all()


def test_a_grid_is_exact_for_cubics_and_smooth() -> None:
    x, y = np.linspace(-3, 3, 8), np.linspace(-2, 2, 5)

    def cubic(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 0.1 + x - 2 * y + x * y + 0.3 * x**3 - 0.2 * y**3 + 0.05 * x**3 * y**2

    grid = GridScreen(cubic(x[None], y[:, None]), (3.0, 2.0))
    some = np.random.default_rng(5)
    px, py = some.uniform(-3, 3, 200), some.uniform(-2, 2, 200)
    value, (along_x, along_y) = path_and_slopes(grid, jnp.asarray(px), jnp.asarray(py), jnp.asarray(MM))
    assert_allclose(value, cubic(px, py), atol=2e-14)
    assert_allclose(along_x, 1 + py + 0.9 * px**2 + 0.15 * px**2 * py**2, atol=1e-13)
    assert_allclose(along_y, -2 + px - 0.6 * py**2 + 0.1 * px**3 * py, atol=1e-13)


def test_a_grid_converges_with_the_fourth_power_of_its_step() -> None:
    at = jnp.linspace(-0.9, 0.9, 57)
    errors = []
    for count in (9, 17, 33):
        x = np.linspace(-1, 1, count)
        grid = GridScreen(np.sin(2 * x[None] + x[:, None]), (1.0, 1.0))
        errors.append(float(jnp.abs(grid.path(at, -at / 2, jnp.asarray(MM)) - jnp.sin(2 * at - at / 2)).max()))
    assert np.log2(errors[0] / errors[1]) > 3.5
    assert np.log2(errors[1] / errors[2]) > 3.5


def test_a_deformable_mirror_turned_by_an_angle_turns_light_by_twice_that() -> None:
    slope = np.sin(np.radians(0.4))
    y = np.linspace(-12, 12, 5)
    path = -slope * np.repeat(y[:, None], 5, 1)
    lens = flat({"grid": {"half_width": [12, 12], "path": path}}, mirror=True, thickness=-100.0)
    end = lenstrace.trace(lens, pupil=(0.0, 0.7))
    assert float(end.m[1]) == pytest.approx(-slope, abs=1e-15)
    turned = flat(None, mirror=True, thickness=-100.0, tilt=[-0.2, 0, 0])
    assert float(lenstrace.trace(turned, pupil=(0.0, 0.7)).m[2]) == pytest.approx(-slope, abs=1e-15)


def test_zernike_terms_are_those_of_the_tables() -> None:
    lens = flat({"zernike": {"radius": 10.0, "order": "fringe", "terms": {9: 2e-3}}})
    path = lenstrace.trace(lens, pupil=(0.0, np.array([0.0, 0.25, 1.0])))
    assert path.opl is not None
    r = np.array([0.0, 0.25, 1.0])
    assert_allclose(path.opl[1], 2e-3 * (6 * r**4 - 6 * r**2 + 1), atol=1e-15)
    slope = 2e-3 * (24 * r**3 - 12 * r) / 10
    assert_allclose(path.m[1], slope, atol=1e-16)


def test_a_point_mass_turns_light_by_einsteins_angle() -> None:
    path = lenstrace.trace(flat({"point_mass": 1e-3}), pupil=(0.0, np.array([0.1, 1.0])))
    assert_allclose(path.m[1], -2e-3 / np.array([1.0, 10.0]), rtol=1e-14)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_point_mass_is_exact_near_and_far(dtype: str) -> None:
    radius = jnp.asarray(3.0, dtype)
    x, y = (np.asarray(a, dtype) for a in ([1e-25, 1e-12, 3.0, 1e20, -1e30], [2e-25, 0.0, -4.0, 1e20, 0.0]))
    path, slopes = path_and_slopes(PointMass(radius), jnp.asarray(x), jnp.asarray(y), jnp.asarray(MM, dtype))
    wide_x, wide_y = x.astype(float), y.astype(float)
    r = np.hypot(wide_x, wide_y)
    close = {"rtol": 8 * float(jnp.finfo(dtype).eps)}
    assert path.dtype == dtype
    assert_allclose(path, -6 * np.log(r), **close)
    assert_allclose(slopes[0], -6 * (wide_x / r) / r, **close)
    assert_allclose(slopes[1], -6 * (wide_y / r) / r, **close)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_ray_through_a_point_mass_goes_straight_on(dtype: str) -> None:
    zero = jnp.zeros((), dtype)

    @jax.jit
    def derivatives(mass: PointMass) -> tuple[jax.Array, tuple[jax.Array, jax.Array], jax.Array]:
        second = jax.hessian(lambda at: mass.path(at[0], at[1], zero))(jnp.zeros(2, dtype))
        return *path_and_slopes(mass, zero, zero, zero), second

    path, slopes, second = derivatives(PointMass(jnp.asarray(3.0, dtype)))
    assert path == 0
    assert slopes == (0, 0)
    assert jnp.isfinite(second).all()


def test_paraxial_optics_knows_the_power_of_a_screen() -> None:
    rows = [
        {"thickness": 30.0, "stop": True, "screen": {"ideal_lens": 100.0}, "index": 1.5},
        {"thickness": 10.0, "screen": {"quadratic_lens": 50.0}},
    ]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 1e-3}, [0.0], [UM])
    found = float(lenstrace.first_order(lens).focal_length[0])
    assert found == pytest.approx(1 / (1 / 100 + 1 / 50 - 20 / 100 / 50), rel=1e-14)
    end = lenstrace.trace(lens, pupil=(0.0, 1.0))
    assert float(-5e-4 / end.m[2]) == pytest.approx(found, rel=1e-9)
    with pytest.raises(PrescriptionError, match=r"a phase screen .* has no Seidel sums"):
        lenstrace.seidel(lens)


def test_newtons_equation_holds_with_a_screen() -> None:
    check = lenstrace.newton_check(flat({"ideal_lens": 100.0}))
    assert_allclose(check.residual, 0, atol=1e-12)
    assert_allclose(check.slope[np.isfinite(np.asarray(check.slope))], 2, atol=0.1)


def test_float32_stays_float32() -> None:
    start = lenstrace.ray((0.0, 5.0, 0.0), (0.0, 0.0, 1.0))
    narrow = lenstrace.trace(train().astype("float32"), rays=start)
    (_, wide), _ = through_the_train()(screens_of_the_train(), np.float64(2), np.float64(0), np.float64(5))
    for name in ("x", "y", "l", "m"):
        assert getattr(narrow, name).dtype == jnp.float32
        # 100 mm behind each screen that is 3e-5 mm
        assert_allclose(getattr(narrow, name), getattr(wide, name), atol=3e-7 if name in "lm" else 3e-5)


@every_screen
@pytest.mark.parametrize("unit", ["mm", "in"])
def test_a_file_keeps_a_screen(kind: str, unit: str) -> None:
    lens = flat({kind: SCREENS[kind]})
    again = lenstrace.loads(lenstrace.dumps(lens))
    assert jax.tree.structure(again) == jax.tree.structure(lens)
    for a, b in zip(jax.tree.leaves(again), jax.tree.leaves(lens), strict=True):
        np.testing.assert_array_equal(a, b)
    inches = lenstrace.loads(lenstrace.dumps(lens).replace("name", 'units = "in"\nname', 1))
    if unit == "in" and kind in ("ideal_lens", "quadratic_lens", "point_mass"):
        assert jax.tree.leaves(inches[1].screen)[0] == pytest.approx(25.4 * SCREENS[kind])
    if kind == "grating":
        grating = inches[1].screen
        assert jax.tree.leaves(grating) == pytest.approx([0.003 * 25.4, -2, 37])
    if kind == "zernike":
        assert max(jax.tree.leaves(inches[1].screen)) == pytest.approx(11 * 25.4)


@pytest.mark.parametrize(
    ("screen", "message"),
    [
        ("{ ideal_lense = 50 }", "surface 1: screen: unknown key 'ideal_lense'; did you mean 'ideal_lens'?"),
        ("{ grating = { period = 0.02, foo = 1 } }", "screen: grating: unknown key 'foo'; known here: period,"),
        ("{ zernike = { radius = 1, term = { 4 = 1e-4 } } }", "unknown key 'term'; did you mean 'terms'?"),
        ("{}", "surface 1: screen"),
    ],
)
def test_a_file_with_a_misspelt_screen_is_refused_in_one_line(screen: str, message: str) -> None:
    text = lenstrace.dumps(flat({"ideal_lens": 50.0})).replace("screen = {ideal_lens = 50.0}", f"screen = {screen}")
    with pytest.raises(PrescriptionError, match=re.escape(message)):
        lenstrace.loads(text)


@pytest.mark.parametrize(
    ("screen", "message"),
    [
        ({"ideal_lens": 0.0}, "surface 1: screen ideal_lens: the focal length must be a finite number other than 0"),
        ({"quadratic_lens": float("nan")}, "finite number other than 0, got nan"),
        ({"grating": {"period": -1.0}}, "grating: the period must be a finite number above 0, got -1"),
        ({"grating": {"period": 1.0, "order": 0.5}}, "the order must be a whole number, got 0.5"),
        ({"grating": {"period": 1.0, "angle": float("inf")}}, "the angle must be a finite number, got inf"),
        ({"grating": {}}, "period"),
        ({"zernike": {"radius": 0.0, "terms": {4: 1.0}}}, "zernike: the radius must be a finite number above 0"),
        ({"zernike": {"radius": 1.0, "terms": {0: 1.0}}}, "numbered from 1"),
        ({"zernike": {"radius": 1.0, "terms": {}}}, "at least one term is needed"),
        ({"zernike": {"radius": 1.0, "terms": {"a": 1.0}}}, "terms are numbers and coefficients"),
        ({"zernike": {"radius": 1.0, "terms": {4: float("inf")}}}, "a coefficient must be a finite number"),
        (
            {"grid": {"half_width": [1, 1], "path": [[1.0, 2.0]]}},
            r"at least 4 rows of 4 values, got the shape \(1, 2",
        ),
        ({"grid": {"half_width": [1, 1], "path": [[1.0, 2.0], [1.0]]}}, "a table of numbers, every row as long"),
        ({"grid": {"half_width": [1], "path": [[1.0] * 4] * 4}}, "half_width takes 2 numbers"),
        ({"grid": {"half_width": [1, -1], "path": [[1.0] * 4] * 4}}, "half_width must be a finite number above 0"),
        ({"grid": {"half_width": [1, 1], "path": [[float("nan")] * 4] * 4}}, "the path must be finite numbers"),
        ({"point_mass": -1.0}, "the Schwarzschild radius must be a finite number above 0"),
        ({"ideal_lens": 1.0, "point_mass": 1.0}, "screen takes one of ideal_lens, quadratic_lens, point_mass, grating"),
    ],
)
def test_bad_screens_are_refused_in_one_line(screen: dict[str, object], message: str) -> None:
    with pytest.raises(PrescriptionError, match=message) as caught:
        flat(screen)
    assert "\n" not in str(caught.value)
    with pytest.raises(PrescriptionError, match=r"surface 1|screen"):
        flat({"ideal_lens": 50.0}).replace(surface=1, screen=screen)


@pytest.mark.parametrize(
    ("screen", "message"),
    [
        (5, r"^screen takes a mapping of one key, such as .*, got 5$"),
        ("ideal_lens", r"^screen takes a mapping of one key, such as .*, got 'ideal_lens'$"),
        ([1], r"^screen takes a mapping of one key, such as .*, got \[1\]$"),
        ({"zernike": {"radius": 1, "order": ["noll"], "terms": {4: 1.0}}}, r"^screen zernike: unknown order .*'noll'"),
        (
            {"zernike": {"radius": 1, "terms": {"4": 1.0, 4: 2.0}}},
            r"^screen zernike: a term is given twice.* 4, 4$",
        ),
        ({"zernike": {"radius": 1, "terms": {"1_1": 1.0}}}, r"^screen zernike: terms are numbers and coefficients"),
        ({"zernike": {"radius": 1, "terms": [4]}}, r"^screen zernike: terms are numbers .*, got \[4\]$"),
        ({"zernike": {"radius": 1, "terms": {4: "a"}}}, r"^screen zernike term 4 must be a number, got 'a'$"),
    ],
)
def test_replace_refuses_what_a_file_cannot_say(screen: object, message: str) -> None:
    with pytest.raises(PrescriptionError) as caught:
        flat(None).replace(surface=1, screen=screen)
    assert re.search(message, str(caught.value).removeprefix("surface 1: "))


def test_a_screen_may_be_given_as_it_is_and_taken_away() -> None:
    lens = flat(None).replace(surface=1, screen=IdealLens(70.0))
    assert float(lenstrace.first_order(lens).focal_length[0]) == pytest.approx(70.0, rel=1e-14)
    assert lens.replace(surface=1, screen=None)[1].screen is None
    with pytest.raises(PrescriptionError, match="screen cannot be given to the image surface"):
        lens.replace(surface=2, screen={"ideal_lens": 50.0})


FAR = {
    "zernike": {"radius": 1.0, "terms": {11: 1e-5, 66: 1e-5}},
    "grid": GRID,
    **{kind: SCREENS[kind] for kind in ("ideal_lens", "quadratic_lens", "grating", "point_mass")},
}


# Light goes on behind all but the last, so that the next one is met as far out.
FAR_OUT = [
    (("grating", "point_mass", "quadratic_lens"), "float32"),
    (("ideal_lens",), "float32"),
    (("grid",), "float32"),
    (("zernike",), "float32"),
    (("zernike",), "float64"),
]


@pytest.mark.parametrize(("kinds", "dtype"), FAR_OUT)
def test_rays_far_out_are_finite_with_their_derivatives(kinds: tuple[str, ...], dtype: str) -> None:
    first, *others = ({"screen": {kind: FAR[kind]}} for kind in kinds)
    # none far out meets the mirror: what missed it goes on against the sense of the light
    mirror = {"radius": 40.0, "mirror": True, "screen": {"quadratic_lens": -80.0}}
    rows = [{"stop": True, "index": 1.5, **first}, *others, mirror]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 20.0}, [0.0], [UM]).astype(dtype)
    # a curved surface squares them: so far out it is finite itself
    far = [1e5, 1e14, 1e18] if dtype == "float32" else [1e5, 1e20, 1e40, 1e60]
    x = jnp.asarray([0.1, *far, 0.2], dtype)
    failure, zero = jnp.zeros(x.shape, jnp.int32), 0 * x

    @jax.jit
    @functools.partial(jax.grad, has_aux=True)
    def total(x: jax.Array) -> tuple[jax.Array, lenstrace.Ray]:
        start = lenstrace.Ray(x, zero, zero, zero, zero, zero + 1, failure, zero)
        end = lenstrace.trace(lens, rays=start, path=False)
        assert end.opl is not None
        return jnp.sum(end.x + end.l + end.opl), end

    slope, end = total(x)
    assert slope.dtype == dtype
    assert jnp.isfinite(slope).all(), slope
    for name in ("x", "y", "z", "l", "m", "n", "opl"):
        assert jnp.isfinite(getattr(end, name)).all(), name
    reached = np.asarray(end.surface)
    assert ((reached == 0) | (reached >= len(kinds))).all()


def test_a_clipped_ray_meets_screens_where_it_is() -> None:
    rows = [{"stop": True, "aperture": {"circle": 1.0}}, {"screen": {"quadratic_lens": 50.0}, "thickness": 100.0}]
    lens = lenstrace.lens(rows, {"entrance_pupil_diameter": 20.0}, [0.0], [UM])
    end = lenstrace.trace(lens, rays=lenstrace.ray((0.0, 5.0, 0.0), (0.0, 0.0, 1.0)))
    assert RayStatus(int(end.status[-1])) is RayStatus.CLIPPED
    assert float(end.m[2]) == pytest.approx(-0.1, rel=1e-14)
