"""Vignetting: edges of the pupil against circles that overlap, and sampling inside them."""

import math

import jax
import numpy as np
import pytest
from numpy.testing import assert_allclose

import lenstrace
from lenstrace import Lens, LostRaysError
from lenstrace.sequential.reference import reference_trace
from lenstrace.sequential.reference_launch import reference_launch
from lenstrace.sequential.sampling import pupil_points

TILT = math.tan(math.radians(10.0))


def tube(front: dict[str, object], fields: object = (0.0, 10.0, -10.0), **more: object) -> Lens:
    """A front opening 20 mm before a stop of radius 5 mm, and nothing else."""
    rows = [{"thickness": 20.0, **front}, {"thickness": 50.0, "stop": True}]
    return lenstrace.lens(rows, {"entrance_pupil_diameter": 10.0}, list(fields), [0.55], **more)  # type: ignore[call-overload]


def test_two_openings_cut_what_their_circles_do() -> None:
    filled = lenstrace.vignetting(tube({"aperture": {"circle": 5.0}}))
    # a ray at pupil height p passes the front opening at 5 p - 20 tan(10 deg): below by 4 tan(10 deg) of its radius
    assert_allclose(filled.top, [1, 1, 1 - 4 * TILT], rtol=1e-13)
    assert_allclose(filled.bottom, [-1, -1 + 4 * TILT, -1], rtol=1e-13)
    # half-way up, 2 tan(10 deg), both circles cut x at the same place
    half = math.sqrt(1 - (2 * TILT) ** 2)
    assert_allclose(filled.right, [1, half, half], rtol=1e-13)
    assert_allclose(filled.left, [-1, -half, -half], rtol=1e-13)
    assert_allclose(filled.centre_y, [0, 2 * TILT, -2 * TILT], atol=1e-14)
    assert_allclose(filled.half_y, [1, 1 - 2 * TILT, 1 - 2 * TILT], rtol=1e-13)


def test_semi_diameters_stop_rays_only_when_asked() -> None:
    drawn = tube({"semi_diameter": 5.0})
    assert_allclose(lenstrace.vignetting(drawn).bottom, -1, rtol=1e-13)
    clipped = drawn.replace(clip_at_semi_diameters=True)
    assert_allclose(lenstrace.vignetting(clipped).bottom, [-1, -1 + 4 * TILT, -1], rtol=1e-13)
    assert lenstrace.loads(lenstrace.dumps(clipped)).clip_at_semi_diameters
    # an aperture goes before the semi-diameter
    both = tube({"semi_diameter": 1.0, "aperture": {"circle": 5.0}}, clip_at_semi_diameters=True)
    assert_allclose(lenstrace.vignetting(both).bottom, [-1, -1 + 4 * TILT, -1], rtol=1e-13)


def test_the_judge_clips_at_semi_diameters_too(designs: dict[str, Lens]) -> None:
    tessar = designs["tessar"].replace(clip_at_semi_diameters=True)
    for pupil in ((0.0, -0.999), (0.0, 0.0)):
        traced = lenstrace.trace(tessar, field=26.0, pupil=pupil)
        judged = reference_trace(tessar, *reference_launch(tessar, (0.0, 26.0), pupil))
        assert [int(s) for s in traced.status] == [int(row.status) for row in judged]


def test_a_shadow_in_the_middle_is_no_edge(designs: dict[str, Lens]) -> None:
    filled = lenstrace.vignetting(designs["hubble"])
    assert_allclose(filled.top, 1, rtol=1e-12)
    assert_allclose(filled.left, -1, rtol=1e-12)


def test_a_spot_inside_loses_few_rays() -> None:
    # with hardly any power, so that there is an image
    lens = tube({"aperture": {"circle": 5.0}}, (0.0, 10.0)).replace(surface=2, radius=1e9, index=1.5)
    whole = lenstrace.spots(lens)
    inside = lenstrace.spots(lens, vignetting=lenstrace.vignetting(lens))
    # rays on the rim itself arrive, though rounded; of the others those beyond the other circle are lost
    x, y, _ = pupil_points("hexapolar", 6)
    assert [int(lost) for lost in whole.lost[:, 0]] == [0, (np.hypot(x, y - 4 * TILT) > 1).sum()]
    # an ellipse reaches a little beyond two circles that overlap
    x, y = math.sqrt(1 - (2 * TILT) ** 2) * x, (1 - 2 * TILT) * y
    radius = np.hypot(x, y - 2 * TILT)
    assert int(inside.lost[0, 0]) == 0
    # some points lie on the rim itself
    assert (radius > 1 + 1e-9).sum() <= int(inside.lost[1, 0]) <= (radius > 1 - 1e-9).sum() < 20
    assert_allclose(inside.y[1, 0].max() - inside.y[1, 0].min(), 10 * (1 - 2 * TILT), rtol=1e-6)


def test_edges_of_aimed_rays_are_those_of_the_stop() -> None:
    lens = tube({"aperture": {"circle": 5.0}}, (10.0,), ray_aiming=True)
    filled = lenstrace.vignetting(lens)
    assert_allclose([filled.top[0], filled.bottom[0]], [1, -1 + 4 * TILT], rtol=1e-10)


def test_nothing_through_the_middle_line_is_an_error_and_nan_under_jit() -> None:
    lens = tube({"aperture": {"circle": 0.5}}, (0.0, 40.0))
    with pytest.raises(LostRaysError, match=r"field \(0, 40\) deg: no ray"):
        lenstrace.vignetting(lens)
    found = jax.jit(lambda lens: lenstrace.vignetting(lens).top)(lens)
    assert np.isnan(found[1])
    assert_allclose(found[0], 0.1, rtol=1e-13)
