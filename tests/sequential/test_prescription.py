"""The grammar: what is read, what is refused and with which words; files written and read again."""

import dataclasses
import math

import jax
import numpy as np
import pytest

import lenstrace
from lenstrace import Lens, LensTraceError
from lenstrace.optics.apertures import ApertureKind

FILE = """
name = "x"
[aperture]
entrance_pupil_diameter = 10
[fields]
y = [0, 5]
[wavelengths]
um = [0.55]
[lens]
surfaces = [
  { radius = 50, thickness = 5, glass = "N-BK7", stop = true },
  { radius = -50, thickness = 45 },
]
"""

# what is changed in the file, and the words of the one line that follows
MISTAKES = {
    'name = "x"|name = "x': ["not valid TOML", "line 2"],
    'name = "x"|nam = "x"': ["unknown key 'nam'", "did you mean 'name'"],
    "radius = 50,|radiuss = 50,": ["surface 1", "unknown key 'radiuss'", "did you mean 'radius'"],
    "y = [0, 5]|yy = [0, 5]": ["fields", "unknown key 'yy'", "did you mean 'y'"],
    ", stop = true|": ["stop", "stop = true"],
    "thickness = 45|thickness = 45, stop = true": ["1, 2", "stop"],
    "N-BK7|N-BK77": ["surface 1", "N-BK77", "did you mean N-BK7"],
    "N-BK7|OHARA:N-BK7": ["surface 1", "OHARA", "SCHOTT"],
    "0.55|550": ["550", "write 0.55"],
    "0.55|5.5": ["surface 1", "N-BK7", "5.5 um", "0.3 to 2.5"],
    "0.55|-0.55": ["positive", "-0.55"],
    "radius = 50,|radius = 50, semi_diameter = -4,": [
        "surface 1: semi_diameter must be positive, got -4.0; leave it out"
    ],
    "thickness = 45|thickness = nan": ["surface 2: thickness", "nan"],
    "radius = 50,|radius = 0,": ["surface 1: radius must not be 0"],
    'radius = 50,|radius = "50",': ["surface 1: radius", "number", "'50'"],
    "radius = 50,|radius = 50, curvature = 1,": ["surface 1: both radius and curvature"],
    'glass = "N-BK7"|glass = "N-BK7", index = 1.5': ["surface 1", "one of glass, index, abbe"],
    'glass = "N-BK7"|index = 0': ["surface 1", "index", "not 0"],
    'glass = "N-BK7"|index = { um = [0.5, 0.6], n = [1.5] }': ["surface 1", "1 n and 2 um"],
    'glass = "N-BK7"|abbe = { nd = 1.5 }': ["surface 1: abbe: vd is missing"],
    'glass = "N-BK7"|abbe = { nd = 1.5, vd = 0 }': ["surface 1", "vd must be positive"],
    "[lens]|[published]\ntolerance = -1\n[lens]": ["published: tolerance"],
    "stop = true|stop = true, mirror = true": ["surface 1", "mirror keeps the medium"],
    "entrance_pupil_diameter = 10|": ["aperture: exactly one of", "got none"],
    "entrance_pupil_diameter = 10|entrance_pupil_diameter = 10\nimage_f_number = 5": [
        "exactly one",
        "and image_f_number",
    ],
    "= 10|= -10": ["entrance_pupil_diameter must be positive, got -10"],
    "entrance_pupil_diameter = 10|object_na = 0.1": ["object_na", "object_distance"],
    'y = [0, 5]|y = [0, 5]\nkind = "angel"': ["fields: kind", "'angel'", "'angle'"],
    'y = [0, 5]|y = [0, 5]\nkind = "object_height"': ["object_height", "object_distance"],
    "y = [0, 5]|y = []": ["fields: at least one"],
    "y = [0, 5]|y = [0, 5]\nx = [1]": ["x has 1 values and y 2"],
    "y = [0, 5]|y = [0, 200]": ["below 180 degrees"],
    "um = [0.55]|um = []": ["wavelengths: at least one"],
    "um = [0.55]|um = [0.55]\nweights = [1, 2]": ["2 weights for 1 wavelengths"],
    "um = [0.55]|um = [0.55]\nprimary = 0.6": ["primary must be one of", "0.6"],
    "radius = 50,|radius = 50, asphere = { a4 = 1e-5 },": ["surface 1: asphere", "'a4'"],
    "radius = 50,|radius = 50, aperture = { circ = 4 },": ["surface 1: aperture", "did you mean 'circle'"],
    "radius = 50,|radius = 50, aperture = { annulus = [5, 4] },": ["surface 1", "inner < outer"],
    "radius = 50,|radius = 50, tilt = [1, 2],": ["surface 1: tilt takes 3 numbers"],
    'name = "x"|name = "x"\nunits = "furlong"': ["units", "'furlong'", "'in'"],
    "[lens]|[lens]\nobject_distance = -5": ["object_distance must be positive", "-5"],
    "[lens]|[lense]": ["unknown key 'lense'", "did you mean 'lens'"],
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_one_clear_line(mistake: str) -> None:
    old, new = mistake.split("|")
    assert old in FILE
    with pytest.raises(LensTraceError) as error:
        lenstrace.loads(FILE.replace(old, new))
    message = str(error.value)
    assert "\n" not in message
    for words in MISTAKES[mistake]:
        assert words in message


def test_the_file_that_was_spoilt_is_right() -> None:
    lens = lenstrace.loads(FILE)
    assert (len(lens), lens.stop, lens[1].radius, lens[2].curvature) == (2, 1, 50, -0.02)
    assert lens.fields.y == (0, 5)
    assert lens.wavelengths.primary == 0


def test_units_scale_every_length() -> None:
    text = FILE.replace('name = "x"', 'units = "in"').replace(
        "radius = 50,", "radius = 2, asphere = { 4 = 1e-3 }, decenter = [1, 0],"
    )
    lens = lenstrace.loads(text)
    assert math.isclose(lens[1].radius, 50.8)  # type: ignore[arg-type]
    assert math.isclose(lens[2].thickness, 45 * 25.4)  # type: ignore[arg-type]
    assert math.isclose(lens[1].asphere[4], 1e-3 / 25.4**3)  # type: ignore[arg-type]
    assert math.isclose(lens.aperture.value, 254)  # type: ignore[arg-type]
    assert lens.fields.y == (0, 5)
    # heights of fields stay in the unit of the file, where a user reads and asks for them
    near = text.replace("y = [0, 5]", 'y = [0, 5]\nkind = "object_height"').replace(
        "[lens]", "[lens]\nobject_distance = 9"
    )
    lens = lenstrace.loads(near)
    assert (lens.fields.y, lens.fields.unit, lens.object_distance) == ((0, 5), "in", 9 * 25.4)
    ray = lenstrace.trace(lens, field=5.0)
    assert np.isclose(float(ray.y[0] - ray.m[0] / ray.n[0] * 9 * 25.4), 5 * 25.4)
    assert lenstrace.loads(lenstrace.dumps(lens)).fields.y == (0, 5 * 25.4)


def test_rows_are_edited_by_the_words_of_the_file() -> None:
    lens = lenstrace.loads(FILE)
    changed = lens.replace(surface=1, radius=40.0, glass="SF5", asphere={4: 1e-6}, aperture={"circle": 6.0})
    assert (changed[1].curvature, changed[1].medium.name) == (1 / 40, "SF5")
    assert changed[1].asphere == {4: 1e-6}
    assert changed[1].aperture_kind is ApertureKind.CIRCLE
    assert lens[1].radius == 50
    assert lens.replace(surface=2, index=1.7)[2].material == "n=1.7"
    assert np.allclose(lens.replace(curvature=[0.01, 0.02]).curvature, [0.01, 0.02])
    for mistake, words in [
        ({"surface": 9, "curvature": 1.0}, "surfaces 1 to 2"),
        ({"surface": 1, "radios": 1.0}, "surface 1: a surface has no 'radios'"),
        ({"surface": 1, "radius": 0.0}, "surface 1: radius must not be 0"),
        ({"surface": 1, "semi_diameter": -1.0}, "surface 1: semi_diameter must be positive"),
        ({"surface": 1, "glass": "N-BK8"}, "surface 1: glass 'N-BK8'"),
        ({"curvature": [1.0]}, "1 values for 2 surfaces"),
        ({"radius": 5.0}, "replace(surface="),
        ({"surface": 1, "tilt": (1.0,)}, "surface 1: tilt takes 3 numbers"),
        ({"surface": 1, "curvature": None}, "surface 1: curvature must be a number"),
        ({"surface": 1, "radius": 5.0, "curvature": 0.1}, "surface 1: both radius and curvature"),
        ({"surface": 3, "tilt": (1.0, 0.0, 0.0)}, "image: tilt"),
        ({"wavelengths": [0.5]}, "wavelengths must be"),
    ]:
        with pytest.raises(LensTraceError, match=words.replace("(", r"\(")):
            lens.replace(**mistake)  # type: ignore[arg-type]


def test_whole_numbers_are_numbers() -> None:
    lens = lenstrace.loads(FILE).replace(surface=1, thickness=9, conic=0)
    slope = jax.grad(lambda each: lenstrace.overview(each).total_track)(lens)
    assert [float(row.thickness) for row in slope.rows] == [1, 1]


def test_the_table_says_it_all(rich_lens: Lens, designs: dict[str, Lens]) -> None:
    text = repr(rich_lens)
    for words in (
        "56.20238",
        "N-SSK2",
        "mirror",
        "stop",
        "break",
        "a16 = -2e-21",
        "circle 9.5 mm",
        "tilt 10, 0, 0.1 deg",
    ):
        assert words in text
    html = designs["cooke_triplet"]._repr_html_()
    assert html.count("<tr>") == 9
    assert "Cooke triplet" in html


def test_numbers_are_traced_through_replace() -> None:
    lens = lenstrace.loads(FILE)
    slope = jax.grad(lambda t: lenstrace.overview(lens.replace(surface=2, thickness=t)).total_track)(45.0)
    assert float(slope) == 1


def test_a_lens_keeps_its_numbers_once_built(designs: dict[str, Lens]) -> None:
    lens = designs["tessar"]
    assert lens.system is lens.system
    assert dataclasses.replace(lens).system is not lens.system
