"""The judge itself, against closed forms and against single rays that other programs have published."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import mpmath
import numpy as np
import pytest

import lenstrace
from lenstrace import Lens, RayStatus
from lenstrace.sequential.reference import reference_trace
from lenstrace.sequential.reference_launch import reference_launch

mp: Any = mpmath.mp
EXACT = 1e-45  # of 50 digits
FLOAT = 3e-14  # where a number of the prescription has been rounded to float64
PRINTED = 1e-11  # where figures stand here in 14 digits

# design, field (degrees in y), pupil x and y; then by rayoptics x, y, l, m at the image, path from the launch in the
# plane of the first vertex to the image
PUBLISHED = """
singlet_rear_stop 0 0 1 0 0.14653721333245 0 -0.12459450875925 109.64336249341
singlet_rear_stop 5 0 0 0 8.6759605581558 0 0.09315704480339 110.07741342114
singlet_rear_stop 5 1 0 0.072100651865724 8.674790980983 -0.12482232943955 0.092081923345085 110.07702532796
singlet_rear_stop 5 0.5 0.5 0.069052067956094 8.6985228039779 -0.062381874831032 0.030313811913121 109.53300273907
cemented_doublet 0 0 1 0 -0.0068039199745279 0 -0.11433908940229 107.31769868294
cemented_doublet 2 0 0 0 3.4910871690444 0 0.034454181111973 107.37709609547
cemented_doublet 2 1 0 -0.018546317679659 3.4927610833833 -0.1143890069369 0.034088949483343 107.37859127778
cemented_doublet 2 0.5 0.5 -0.0057017490913166 3.4798748416614 -0.057277767984003 -0.023003443090948 107.17788866368
cooke_triplet 0 0 1 0 -0.0041956770813277 0 -0.10043797456868 64.668178640579
cooke_triplet 20 0 0 0 18.136025932761 0 0.3253286152377 68.492692875312
cooke_triplet 20 1 0 -0.016936433773797 18.131811492539 -0.094618834965032 0.32534373380073 68.491929396836
cooke_triplet 20 0.5 0.5 -0.0094405139490829 18.125629181549 -0.047321141680335 0.28336468179205 67.634567100107
tessar 0 0 1 0 0.026871023169095 0 -0.14243212988935 74.119123193887
tessar 22.6 0 0 0 21.64018180542 0 0.37668402419113 79.788789261892
tessar 22.6 1 0 0.11002867640017 21.623789153807 -0.13017983421613 0.37755997107633 79.770912650154
tessar 22.6 0.5 0.5 0.015914281427849 21.66088206771 -0.065701477106439 0.32108947358715 78.36650757332
double_gauss 0 0 1 0 -0.018003288506484 0 -0.10014824267334 168.24687526311
double_gauss 14 0 0 0 24.669769254384 0 0.19807514370724 172.56751576881
double_gauss 14 1 0 -0.061217628572247 24.667637765141 -0.09856738350015 0.19789865637672 172.57027795603
double_gauss 14 0.5 0.5 -0.029947741370876 24.648150381349 -0.049259799004482 0.15053292208117 171.35489453363
"""


@pytest.fixture(autouse=True)
def _many_digits() -> Iterator[None]:
    with mp.workdps(60):
        yield


def made(rows: list[dict[str, Any]], **more: Any) -> Lens:
    """A lens of one wavelength; its first row is the stop."""
    rows[0] = {"stop": True, **rows[0]}
    more = {"aperture": {"entrance_pupil_diameter": 2.0}, "fields": [0.0], **more}
    return lenstrace.lens(rows, wavelengths=[0.55], **more)


@pytest.mark.parametrize("line", PUBLISHED.split("\n")[1:-1])
def test_published_rays(line: str, designs: dict[str, Lens]) -> None:
    name, *numbers = line.split()
    field, pupil_x, pupil_y, *expected = map(float, numbers)
    launch = reference_launch(designs[name], (0.0, field), (pupil_x, pupil_y))
    end = reference_trace(designs[name], *launch)[-1]
    assert np.allclose(np.array([end.x, end.y, end.l, end.m, end.opl], float), expected, rtol=0, atol=PRINTED)
    assert end.status is RayStatus.OK


@pytest.mark.parametrize("height", [0.25, 3.0, 15.0])
def test_parabola_brings_light_to_its_focus_in_equal_time(height: float) -> None:
    # c = -1/16, so that the focus stands 8 mm in front of the vertex, exactly
    mirror = made([{"thickness": 64.0}, {"curvature": -0.0625, "conic": -1.0, "thickness": -8.0, "mirror": True}])
    end = reference_trace(mirror, (0.0, height, 0.0), (0, 0, 1))[-1]
    assert abs(end.y) < EXACT
    assert abs(end.opl - 72) < EXACT


@pytest.mark.parametrize("slope", [0.1, 1.0, 1.9])
def test_ellipse_images_one_focus_into_the_other(slope: float) -> None:
    # half axes 5 and 4: k = -9/25 and R = 16/5 up to rounding, foci 2 and 8 mm from the vertex, path 10
    mirror = made([{"thickness": 2.0}, {"radius": -3.2, "conic": -0.36, "thickness": -8.0, "mirror": True}])
    length = np.hypot(1, slope)
    end = reference_trace(mirror, (0, 0, 0), (0, slope / length, 1 / length))[-1]
    assert abs(end.y) < FLOAT
    assert abs(end.opl - 10) < FLOAT


def test_thick_lens_has_its_focal_length() -> None:
    lens = made([{"radius": 50.0, "thickness": 10.0, "index": 1.5}, {"radius": -50.0, "thickness": 48.0}])
    height = mp.mpf(10) ** -12
    end = reference_trace(lens, (0, height, 0), (0, 0, 1))[-1]
    assert abs(-height / (end.m / end.n) - 51.7241379310345) < 1e-12


def test_ball_lens_marginal_ray() -> None:
    ball = made([{"radius": 1.0, "thickness": 2.0, "index": 1.5}, {"radius": -1.0}])
    end = reference_trace(ball, (0, 0.5, 0), (0, 0, 1))[-1]
    # the image stands at the back vertex, 1 mm behind the centre
    assert abs(1 - end.y * end.n / end.m - mp.mpf("1.39157294888931")) < 1e-14


@pytest.mark.parametrize("slope", [0.0, 0.5, 40.0])
def test_slab_of_index_minus_one_images_at_no_path(slope: float) -> None:
    # source 0.75 mm before a slab of 2 mm: image 1.25 mm behind it; the path is counted from the first vertex's plane
    slab = made([{"thickness": 2.0, "index": -1.0}, {"thickness": 1.25}], object_distance=0.75)
    end = reference_trace(slab, (0.0, 0.75 * slope, 0.0), unit(slope))[-1]
    assert abs(end.y) < EXACT
    assert abs(end.opl + 0.75 / unit(slope)[2]) < EXACT


def test_fold_mirror_turns_the_axis_by_a_right_angle() -> None:
    turn = {"break": True, "tilt": [45.0, 0.0, 0.0]}
    fold = made([{"thickness": 5.0}, turn, {"mirror": True}, {**turn, "thickness": -7.0}])
    end = reference_trace(fold, (0.25, 0.5, 0.0), (0, 0, 1))[-1]
    expected = (0.25, 0.5, 0, 0, 0, -1, 12)
    assert all(
        abs(a - b) < EXACT for a, b in zip((end.x, end.y, end.z, end.l, end.m, end.n, end.opl), expected, strict=True)
    )


def test_tilts_are_about_x_then_the_new_y_then_the_newest_z() -> None:
    # A right angle about x brings the surface's axis to -y, one about z then its y to -x of the turned frame
    row = {"break": True, "tilt": [90.0, 0.0, 90.0], "decenter": [1.0, 2.0]}
    end = reference_trace(made([row]), (1.5, 2.0, 0.25), (0, -1, 0))[1]
    assert np.allclose(
        np.array([end.x, end.y, end.z, end.l, end.m, end.n], float), [0.25, -0.5, 0, 0, 0, 1], atol=1e-15
    )
    surface = {**row, "break": False}
    tilted = reference_trace(made([surface]), (1.5, 2.0, 0.25), (0, -1, 0))[1]
    assert abs(tilted.x - end.x) < EXACT
    assert abs(tilted.y - end.y) < EXACT


def test_total_reflection_begins_at_the_critical_angle() -> None:
    # glass of index 2: 30 degrees
    prism = made([{"thickness": 1.0}], object_index=2.0)
    for sine, status in ((0.5 - 1e-12, RayStatus.OK), (0.5 + 1e-12, RayStatus.TIR)):
        rows = reference_trace(prism, (0, 0, 0), (0, sine, np.sqrt(1 - sine * sine)))
        assert rows[1].status is status
    assert len(rows) == 2
    assert abs(rows[1].m - sine) < 1e-15  # the direction of arrival


def test_grazing_a_sphere() -> None:
    ball = made([{"curvature": 0.125, "thickness": 8.0, "index": 1.5}])
    for above, status in ((-(mp.mpf(10) ** -30), RayStatus.OK), (mp.mpf(10) ** -30, RayStatus.MISSED)):
        rows = reference_trace(ball, (0, 8 + above, -5), (0, 0, 1))
        assert rows[1].status is status
    back = reference_trace(ball, (0, 4, 5), (0, 0, 1))[1]  # a point behind the surface: the way there is negative
    assert back.opl < 0
    assert abs(back.z - (8 - mp.sqrt(48))) < 1e-14


def test_asphere_that_writes_a_parabola_is_one() -> None:
    height, sine = 3.0, 0.125
    course = [
        reference_trace(
            made([{**row, "index": 1.75, "thickness": 4.0}]), (1.0, height, -2.0), (0.0, sine, 0.9921567416492215)
        )
        for row in ({"curvature": 0.125, "conic": -1.0}, {"asphere": {2: 0.0625}})
    ]
    for conic, asphere in zip(*course, strict=True):
        assert max(abs(conic.x - asphere.x), abs(conic.y - asphere.y), abs(conic.m - asphere.m)) < EXACT


def test_apertures_stop_a_ray_that_goes_on() -> None:
    for aperture, passes in (
        ({"circle": 2.0}, True),
        ({"circle": 1.75}, False),
        ({"annulus": [1.0, 2.0]}, True),
        ({"annulus": [2.5, 3.0]}, False),
        ({"rectangle": [0.5, 2.0]}, True),
        ({"rectangle": [2.0, 0.5]}, False),
        ({"obscuration": 2.5}, False),
        ({"obscuration": 2.0}, True),  # the rim belongs to the opening
    ):
        rows = reference_trace(made([{"aperture": aperture, "thickness": 3.0}]), (0, 2, 0), (0, 0, 1))
        assert [row.status for row in rows[1:]] == [RayStatus.OK if passes else RayStatus.CLIPPED] * 2
        assert rows[-1].opl == 3


def test_launch_refuses_ray_aiming() -> None:
    lens = made([{"thickness": 1.0}], ray_aiming=True)
    with pytest.raises(ValueError, match="ray aiming"):
        reference_launch(lens, (0, 0), (0, 0))


def unit(slope: float) -> tuple[Any, Any, Any]:
    """Direction of a ray of this slope in y, in full precision."""
    length = mp.sqrt(1 + mp.mpf(slope) ** 2)
    return mp.zero, mp.mpf(slope) / length, 1 / length
