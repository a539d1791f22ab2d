"""Pictures through a lens: by `render`, in the sizes and the precision of pictures."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lenstrace.errors import CameraError
from lenstrace.scene import Diffuse, Object, Pinhole, Rectangle, Scene, View, lens_camera, render
from lenstrace.sequential.lens import Lens

PLACE, AHEAD = (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)
WALL = Object(Rectangle(2.0, 2.0), Diffuse(0.0), (0, 0, -5), emission=1.0)


@pytest.fixture(scope="module")
def gauss(designs: dict[str, Lens]) -> Lens:
    return designs["double_gauss"]


def test_a_white_wall_is_white_and_its_edge_where_a_pinhole_sees_it(gauss: Lens) -> None:
    """Radiance 1 in the middle; the wall's edge, 2 beside the axis at 5 from the pupil, at the pinhole's place."""
    camera = lens_camera(gauss, PLACE, AHEAD, focus=5.1, f_number=8.0, unit_mm=1000.0, film=60.0, rims=False)
    scene = Scene([WALL])
    wide = 2 * math.degrees(math.atan(0.3))
    size, samples = (64, 64), 64
    seen = render(scene, camera, size=size, samples=samples, depth=1).radiance.mean(-1)
    assert seen[28:36, 28:36].mean() == pytest.approx(1, abs=0.04)
    pinhole = Pinhole(View(PLACE, AHEAD), wide)  # type: ignore[arg-type]
    sharp = render(scene, pinhole, size=size, samples=samples, depth=1).radiance.mean(-1)
    # outside the wall it is black for both; the lens has a magnification of its own, a little blur and distortion
    assert (seen > 0.2).sum() == pytest.approx((sharp > 0.5).sum(), rel=0.2)
    assert seen.max() < 2


def test_colour_may_be_left_out(gauss: Lens) -> None:
    """One wavelength: no noise of colour on a wall that has none."""
    given = {"focus": 5.1, "f_number": 8.0, "unit_mm": 1000.0}
    grey, coloured = (lens_camera(gauss, PLACE, AHEAD, colour=each, **given) for each in (False, True))  # type: ignore[arg-type]
    assert not grey.disperses
    assert coloured.disperses
    picture = render(Scene([WALL]), grey, size=(8, 8), samples=4, depth=1)
    assert (np.ptp(picture.radiance, axis=-1) == 0).all()


def test_longer_pictures_than_the_camera_was_made_for_are_refused(gauss: Lens) -> None:
    camera = lens_camera(gauss, PLACE, AHEAD, focus=5.1, unit_mm=1000.0, aspect=1.5)
    with pytest.raises(CameraError, match=r"size: 40x20 is 2 times as long as wide, .* make it with aspect = 2"):
        render(Scene([WALL]), camera, size=(40, 20), samples=1, depth=1)
