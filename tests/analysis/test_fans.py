"""Ray fans: Optiland's figures, the derivative of the path against the aberration, angles behind an afocal lens."""

from __future__ import annotations

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens, RayError
from lenstrace.analysis.fans import fans
from lenstrace.analysis.image_rays import image_rays
from lenstrace.analysis.path_difference import Sphere, differences

# Optiland 0.6.3, RayFan, num_points=5: the tangential fan's ey and the sagittal fan's ex, mm, at -1, -0.5, 0, 0.5, 1,
# by design, place of the field, place of the wavelength.
OPTILAND = {
    ("double_gauss", 1, 0): (
        [0.03405999553285355, 0.015186278541541753, 0.003839202818284093, -0.008135343723129296, -0.028308064256194143],
        [0.04558714185001467, 0.018437962550970077, 0.0, -0.018437962550970077, -0.04558714185001467],
    ),
    ("double_gauss", 2, 1): (
        [0.04394651556265927, 0.019386003459793244, 0.0, -0.02008658641239336, -0.045863803974352635],
        [0.06121762857226276, 0.027975609462479678, 0.0, -0.027975609462479678, -0.06121762857226276],
    ),
    ("cooke_triplet", 2, 2): (
        [
            -0.03395753760179687,
            0.004878435020184924,
            0.00023380977952314197,
            -0.005945887568479691,
            0.036545592330568866,
        ],
        [0.012145346022071735, 0.007750257412814321, 0.0, -0.007750257412814321, -0.012145346022071735],
    ),
}


@pytest.mark.parametrize("name", ["double_gauss", "cooke_triplet"])
def test_fans_against_optiland(name: str, designs: dict[str, Lens]) -> None:
    found = fans(designs[name], points=5)
    assert_allclose(found.pupil, [-1, -0.5, 0, 0.5, 1])
    for (_, field, wave), (tangential, sagittal) in ((k, v) for k, v in OPTILAND.items() if k[0] == name):
        assert_allclose(found.tangential.y[field, wave], tangential, atol=1e-12)
        assert_allclose(found.sagittal.x[field, wave], sagittal, atol=1e-12)
        # a lens is symmetrical about its y-z plane
        assert_allclose(found.tangential.x[field, wave], 0, atol=1e-14)
        assert_allclose(found.sagittal.opd[field, wave], found.sagittal.opd[field, wave][::-1], atol=1e-10)


@pytest.mark.parametrize(("name", "reference"), [("double_gauss", "primary"), ("phone_lens", "chief")])
def test_path_difference_and_aberration_agree_through_the_derivative(
    name: str, reference: str, designs: dict[str, Lens]
) -> None:
    """dW = n' dd . e for any change of a ray, exactly: Fermat's principle (Rayces, Optica Acta 11, 85 (1964))."""
    lens = designs[name]
    x, y = jnp.array([0.0, 0.3, 0.7, -0.6, 0.1]), jnp.array([1.0, -0.9, 0.2, 0.6, 0.0])

    def of_pupil(x: jax.Array, y: jax.Array) -> tuple[jax.Array, ...]:
        arrived = image_rays(lens, x, y)
        found = differences(arrived, Sphere(reference, far=True))
        path = found.opd * (jnp.asarray(arrived.um)[:, None] / 1000)
        rays = jax.tree.map(lambda a: jnp.swapaxes(a, 0, 1)[..., 1:], arrived.rays)
        return path, rays.l, rays.m, rays.n, found.x, found.y

    @jax.jit
    def both(x: jax.Array, y: jax.Array) -> list[tuple[tuple[jax.Array, ...], tuple[jax.Array, ...]]]:
        one, none = jnp.ones_like(x), jnp.zeros_like(x)
        return [jax.jvp(of_pupil, (x, y), direction) for direction in ((one, none), (none, one))]

    largest = 0.0
    for (_, _, _, _, ex, ey), (path, l, m, _, _, _) in both(x, y):
        # the image is plane: e has no z
        assert_allclose(path, l * ex + m * ey, rtol=1e-9, atol=1e-14)
        largest = max(largest, float(jnp.abs(path).max()))
    assert largest > 1e-4


def test_references_differ_by_what_they_say(designs: dict[str, Lens]) -> None:
    primary, chief, best = (
        fans(designs["double_gauss"], points=5, reference=name) for name in ("primary", "chief", "best")
    )
    # lateral colour is what the chief rays of other wavelengths miss the primary's by
    shift = primary.tangential.y[..., 2]
    assert float(jnp.abs(shift[:, [0, 2]])[1:].min()) > 9e-4
    assert_allclose(shift[:, 1], 0, atol=1e-16)
    assert_allclose(primary.tangential.y - shift[..., None], chief.tangential.y, atol=1e-14)
    for fan in (primary, chief):
        assert_allclose(fan.tangential.opd[..., 2], 0, atol=1e-12)
    squares = [jnp.sum(f.tangential.opd**2 + f.sagittal.opd**2, -1) for f in (best, chief)]
    assert bool((squares[0] < squares[1]).all())


def test_afocal_angles_against_the_path_on_a_plane(designs: dict[str, Lens]) -> None:
    lens = designs["afocal_expander"]
    found = fans(lens, points=101)
    # stigmatic on the axis: every ray leaves parallel to it, in phase
    assert_allclose([found.tangential.y[0], found.sagittal.x[0]], 0, atol=1e-14)
    assert_allclose([found.tangential.opd[0], found.sagittal.opd[0]], 0, atol=1e-9)
    # a field off the axis: on the plane across the chief ray dW = -d . dX (Malus), d from the fan's angles
    traced = lenstrace.trace(lens, field=0.2, pupil=(0.0, np.asarray(found.pupil)), path=False)
    place = np.stack([traced.y, traced.z])
    angle = np.asarray(found.tangential.y[1, 0])
    chief = np.arctan2(traced.m[50], traced.n[50])
    direction, across = (
        np.stack([np.sin(angle + chief), np.cos(angle + chief)]),
        np.array([np.sin(chief), np.cos(chief)]),
    )
    apart = place - place[:, 50:51]
    on_plane = apart - direction * (across @ apart) / (across @ direction)
    steps = -(0.5 * (direction[:, 1:] + direction[:, :-1]) * np.diff(on_plane)).sum(0)
    path = np.asarray(found.tangential.opd[1, 0]) * lens.wavelengths.um[0] / 1000
    assert np.ptp(path) > 1e-5
    assert_allclose(np.diff(path), steps, atol=2e-5 * np.ptp(path))


def test_the_shadow_of_the_secondary_is_a_gap(designs: dict[str, Lens]) -> None:
    found = fans(designs["hubble"], points=21)
    dark = np.abs(np.asarray(found.pupil)) * 1200 < 396
    # the nearer the edge of the field, the further the shadow on the first row moves, but less than a step
    for fan in (found.tangential, found.sagittal):
        for values in (fan.x, fan.y, fan.opd):
            assert_allclose(np.isnan(values[0, 0]), dark)
    # Ritchey-Chretien: no spherical aberration to speak of on the axis
    assert float(jnp.nanmax(jnp.abs(found.tangential.opd[0]))) < 0.06


def test_float32(designs: dict[str, Lens]) -> None:
    lens = designs["double_gauss"]
    wide, narrow = fans(lens, points=5), fans(lens.astype(np.float32), points=5)
    assert narrow.tangential.opd.dtype == np.float32
    for a, b in ((wide.tangential, narrow.tangential), (wide.sagittal, narrow.sagittal)):
        assert_allclose(a.opd, b.opd, atol=0.01)
        assert_allclose(a.x, b.x, atol=2e-5)


@pytest.mark.parametrize("points", [4, 1, 2.5, True])
def test_points_that_are_no_fan(points: int, designs: dict[str, Lens]) -> None:
    with pytest.raises(RayError, match="odd whole number"):
        fans(designs["double_gauss"], points=points)


def test_an_unknown_reference(designs: dict[str, Lens]) -> None:
    with pytest.raises(RayError, match="chief, primary, best"):
        fans(designs["double_gauss"], reference="centroid")


def test_a_lost_chief_ray_is_named(designs: dict[str, Lens]) -> None:
    lens = designs["double_gauss"]
    wild = lens.replace(fields=dataclasses.replace(lens.fields, y=(0.0, 10.0, 70.0)))
    with pytest.raises(lenstrace.LostRaysError, match=r"field \(0, 70\) deg.*chief ray is lost"):
        fans(wild, points=5)
