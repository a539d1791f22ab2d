"""What rays that fail, are stopped, or are constants of somebody's program must not do to the others."""

import jax
import jax.numpy as jnp
import numpy as np
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens


def test_a_field_without_rays_leaves_the_gradients_of_the_others(designs: dict[str, Lens]) -> None:
    narrow = designs["cooke_triplet"].replace(surface=1, aperture={"circle": 1.0})
    narrow = narrow.replace(surface=6, aperture={"circle": 1.0})
    value = lenstrace.mean_square_spot(narrow, rings=3)
    assert [bool(np.isnan(v)) for v in value] == [False, True, True]

    def first(c: jax.Array) -> jax.Array:
        return lenstrace.mean_square_spot(narrow.replace(curvature=c), rings=3)[0]

    assert np.isfinite(jax.grad(first)(jnp.asarray(narrow.curvature))).all()


def test_wavelengths_of_no_weight_make_no_perfect_spot() -> None:
    # blue light alone is totally reflected at the back of a steep plate of strong dispersion
    table = {"um": [0.4, 0.7], "n": [3.0, 1.2]}
    lens = lenstrace.lens(
        [{"thickness": 5.0, "index": table, "stop": True}, {"radius": -6.0, "thickness": 20.0}],
        {"entrance_pupil_diameter": 8.0},
        [0.0, 40.0],
        {"um": [0.4, 0.7], "weights": [1.0, 0.0]},
    )
    spots = lenstrace.spots(lens, rings=2)
    lost = np.asarray(spots.lost)
    for field in range(2):
        assert np.isnan(spots.polychromatic.rms_centroid[field]) == (lost[field, 0] == spots.rays)


def test_apertures_do_not_choose_among_aimed_rays(designs: dict[str, Lens]) -> None:
    fisheye = designs["fisheye"]
    clipped = fisheye.replace(clip_at_semi_diameters=True)
    ask = {"field": 110.0, "pupil": (0.0, 0.0), "wavelength": 0.4861327, "path": False}
    free, stopped = lenstrace.trace(fisheye, **ask), lenstrace.trace(clipped, **ask)
    assert_allclose(stopped.y, free.y, rtol=1e-12)
    assert int(stopped.status) == 0


def test_rays_that_run_away_on_an_asphere_stay_finite(designs: dict[str, Lens]) -> None:
    single = designs["phone_lens"].astype("float32")
    grid = np.linspace(-4, 4, 21)
    end = lenstrace.trace(single, field=3.5, pupil=tuple(np.meshgrid(grid, grid)), path=False)
    assert not bool(end.ok.all())
    assert all(np.isfinite(a).all() for a in (end.x, end.y, end.z, end.l, end.m, end.n, end.opl))


def test_many_rays_may_be_constants_of_a_program(designs: dict[str, Lens]) -> None:
    lens, fields = designs["cooke_triplet"], jnp.linspace(0, 14, 2000)

    def heights(c: jax.Array) -> jax.Array:
        return lenstrace.trace(lens.replace(curvature=c), field=fields, pupil=(0.0, 1.0), path=False).y

    expected = lenstrace.trace(lens, field=np.asarray(fields), pupil=(0.0, 1.0), path=False).y
    assert_allclose(jax.jit(heights)(lens.curvature), expected, atol=1e-13)


def test_a_lens_of_jax_numbers_is_not_spoilt_by_a_program_it_is_a_constant_of(designs: dict[str, Lens]) -> None:
    lens = designs["cooke_triplet"]
    made = lens.replace(curvature=jnp.asarray(lens.curvature))
    assert float(jax.jit(lambda s: lenstrace.spots(made).rms_centroid.sum() * s)(1.0)) > 0
    assert_allclose(lenstrace.spots(made).rms_centroid, lenstrace.spots(lens).rms_centroid, rtol=1e-11)
