"""The tracer against the judge in 50 digits, at every surface, over all kinds of lenses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lenstrace
from lenstrace import Lens, RayStatus
from lenstrace.sequential.reference import reference_trace
from lenstrace.sequential.reference_launch import reference_launch

POSITION, DIRECTION, PATH = 1e-11, 1e-13, 1e-11  # mm in a lens of 100 mm; without unit; mm in a lens of 100 mm
SIZE = 100.0
ENDS = (RayStatus.MISSED, RayStatus.TIR)


def made(rows: list[dict[str, Any]], diameter: float = 10.0, **more: Any) -> Lens:
    """A lens of one wavelength; the first row is the stop unless one is marked."""
    rows = [dict(row) for row in rows]
    if not any(row.get("stop") for row in rows):
        rows[0]["stop"] = True
    return lenstrace.lens(rows, {"entrance_pupil_diameter": diameter}, more.pop("fields", [0.0]), [0.55], **more)


def ray_bundle(radius: float, degrees: float, z: float = 0.0, across: float = 0.0) -> list[tuple[Any, Any]]:
    """Twelve rays: over a disc in the plane z, turned by up to `degrees` in y and `across` in x."""
    rays = []
    for i in range(12):
        r, around = radius * np.sqrt(i / 11), 2.4 * i
        l = np.sin(np.radians(across * (i % 3 - 1)))
        m = np.sqrt(1 - l * l) * np.sin(np.radians(degrees * (i % 4 - 1) / 2))
        rays.append(((r * np.cos(around), r * np.sin(around), z), (l, m, np.sqrt(1 - l * l - m * m))))
    return rays


def disagreement(lens: Lens, rays: list[tuple[Any, Any]], place: int = 0) -> tuple[float, float, float]:
    """Worst errors of position, direction and optical path of the tracer, over rays and surfaces; statuses agree."""
    points, directions = (np.array(part, float).T for part in zip(*rays, strict=True))
    um = lens.wavelengths.um[place]
    core = lenstrace.trace(lens, lenstrace.ray(tuple(points), tuple(directions)), wavelength=um)
    place_of = np.stack([np.asarray(part) for part in (core.x, core.y, core.z)])
    course = np.stack([np.asarray(part) for part in (core.l, core.m, core.n)])
    opl, status = np.asarray(core.opl), np.asarray(core.status)
    assert np.isfinite(place_of).all()
    assert np.isfinite(course).all()
    assert np.isfinite(opl).all()
    worst = [0.0, 0.0, 0.0]
    for i in range(points.shape[1]):
        rows = reference_trace(lens, points[:, i].tolist(), directions[:, i].tolist(), place)
        expected = [row.status for row in rows] + [rows[-1].status] * (len(lens) + 2 - len(rows))
        assert [RayStatus(s) for s in status[:, i]] == expected, f"ray {i}"
        ended = len(rows) < len(lens) + 2 or rows[-1].status in ENDS
        for row in rows[: len(rows) - ended]:
            s = row.surface
            point, direction = (row.x, row.y, row.z), (row.l, row.m, row.n)
            errors = (
                max(abs(float(a - b)) for a, b in zip(point, place_of[:, s, i].tolist(), strict=True)),
                max(abs(float(a - b)) for a, b in zip(direction, course[:, s, i].tolist(), strict=True)),
                abs(float(row.opl - float(opl[s, i]))),
            )
            worst = [max(pair) for pair in zip(worst, errors, strict=True)]
    return worst[0], worst[1], worst[2]


def check(lens: Lens, rays: list[tuple[Any, Any]], place: int = 0, size: float = SIZE) -> None:
    """Agreement at every surface, in a lens of the given size (mm)."""
    position, direction, path = disagreement(lens, rays, place)
    assert position < POSITION * size / SIZE
    assert direction < DIRECTION
    assert path < PATH * size / SIZE


PHONE = [
    {"thickness": 0.2, "stop": True},
    {
        "radius": 1.8,
        "thickness": 0.7,
        "index": 1.544,
        "conic": -0.5,
        "asphere": {4: -0.01, 6: 0.02, 8: -0.03, 16: -1e-4},
    },
    {"radius": -9.0, "thickness": 0.4, "conic": 3.0, "asphere": {4: 0.02, 6: -0.05, 8: 0.03, 14: -1e-4, 16: 1e-5}},
    {"radius": -4.0, "thickness": 0.4, "index": 1.64, "conic": -3.0, "asphere": {3: 0.01, 4: -0.06, 5: 0.02, 7: -0.02}},
    {"radius": 6.0, "thickness": 1.0, "asphere": {4: -0.08, 6: 0.06, 8: -0.02, 10: 0.003}},
    {"radius": 2.0, "thickness": 0.6, "index": 1.53, "conic": -5.0, "asphere": {4: -0.12, 6: 0.03, 8: -0.004}},
    {"radius": 1.2, "thickness": 1.3, "conic": -1.0, "asphere": {4: -0.09, 6: 0.02, 8: -0.003, 12: -8e-6}},
]  # the last two are gull wings
FLAT_ASPHERES = [
    {"thickness": 2.0, "index": 1.5, "asphere": {2: 1e-3, 4: 1e-4, 6: -1e-6}},
    {"thickness": 50.0, "asphere": {1: 1e-3, 3: 1e-4}},
]
OFF_AXIS_PARABOLA = [
    {"thickness": 100.0},
    {"radius": -200.0, "conic": -1.0, "thickness": -100.0, "mirror": True, "decenter": [0.0, -40.0]},
]
CASSEGRAIN = [
    {"thickness": 100.0, "aperture": {"obscuration": 15.0}},
    {"radius": -300.0, "conic": -1.1, "thickness": -90.0, "mirror": True, "aperture": {"annulus": [4.0, 30.0]}},
    {"radius": -160.0, "conic": -3.2, "thickness": 120.0, "mirror": True},
]
THREE_MIRRORS = [
    {"radius": -400.0, "conic": -0.97, "thickness": -150.0, "mirror": True},
    {"radius": -150.0, "conic": -2.0, "thickness": 170.0, "mirror": True},
    {"radius": -220.0, "conic": -0.3, "thickness": -150.0, "mirror": True},
]
MAKSUTOV = [
    {"radius": -70.0, "thickness": 8.0, "index": 1.5168},
    {"radius": -74.0, "thickness": 110.0},
    {"radius": -260.0, "thickness": -100.0, "mirror": True},
    {"radius": -74.0, "thickness": 100.0, "mirror": True, "aperture": {"circle": 12.0}},
]
MANGIN = [
    {"radius": -80.0, "thickness": 6.0, "index": 1.52},
    {"radius": -120.0, "thickness": -6.0, "mirror": True},
    {"radius": -80.0, "thickness": -85.0},
]
FOLDED = [
    {"radius": 60.0, "thickness": 5.0, "index": 1.6},
    {"radius": -90.0, "thickness": 30.0},
    {"break": True, "tilt": [45.0, 0.0, 0.0]},
    {"mirror": True, "aperture": {"rectangle": [9.0, 7.0]}},
    {"break": True, "tilt": [45.0, 0.0, 0.0], "thickness": -25.0},
]
SCANNER = [
    {"thickness": 30.0},
    {"break": True, "mirror": True, "tilt": [30.0, 10.0, 5.0], "decenter": [1.0, 2.0]},
    {"break": True, "tilt": [30.0, -10.0, 40.0], "thickness": -25.0},
    {"radius": 40.0, "thickness": -4.0, "index": 1.7},
    {"radius": -40.0, "thickness": -20.0},
]
TILTED = [
    {"radius": 60.0, "thickness": 5.0, "index": 1.6, "tilt": [5.0, -3.0, 20.0], "decenter": [0.5, -0.7]},
    {"radius": -90.0, "thickness": 10.0, "tilt": [-10.0, 8.0, 70.0], "decenter": [-1.0, 2.0]},
    {"thickness": 5.0, "index": 1.5, "tilt": [20.0, 15.0, -33.0], "asphere": {4: 1e-5}},
    {"radius": -40.0, "conic": -1.0, "thickness": 40.0, "tilt": [3.0, 4.0, 5.0]},
]
TURNED = [
    {"thickness": 20.0},
    {"radius": -80.0, "mirror": True, "break": True, "tilt": [10.0, 0.0, 0.0]},
    {"break": True, "tilt": [190.0, 0.0, 0.0], "thickness": 20.0},
    {"radius": 50.0, "index": 1.5, "thickness": 5.0, "tilt": [175.0, 3.0, 4.0]},
]
NEGATIVE = [
    {"thickness": 10.0, "index": -1.3, "tilt": [10.0, 0.0, 0.0]},
    {"thickness": 10.0, "tilt": [-5.0, 0.0, 0.0]},
    {"radius": 30.0, "index": -2.0, "thickness": 3.0},
    {"radius": -30.0, "index": -1.0, "thickness": 3.0},
    {"radius": 50.0, "thickness": 10.0},
]
AFOCAL = [
    {"radius": -200.0, "conic": -1.0, "mirror": True, "thickness": -120.0},
    {"radius": 40.0, "conic": -1.0, "mirror": True, "thickness": 100.0},
]
STRONG = [
    {"radius": 10.0, "thickness": 6.0, "index": 1.5},
    {"radius": -8.0, "thickness": 5.0},
    {"radius": 4.0, "thickness": 20.0, "index": 1.9},
]
PRISM = [
    {"thickness": 6.0, "index": 1.9},
    {"thickness": 5.0, "tilt": [25.0, 0.0, 0.0], "aperture": {"circle": 6.0}},
    {"radius": -4.0, "thickness": 20.0, "index": 1.2},
]
# rows, image, and of the bundle: radius (mm), angles in y and x (degrees), z of its points
SYSTEMS: dict[str, tuple[list[dict[str, Any]], dict[str, float], tuple[float, float, float, float]]] = {
    "phone lens with gull wings": (PHONE, {}, (0.9, 30.0, 0.0, 10.0)),
    "aspheres on planes, odd powers": (FLAT_ASPHERES, {}, (8.0, 10.0, -3.0, 5.0)),
    "off-axis parabola": (OFF_AXIS_PARABOLA, {}, (15.0, 0.5, 0.0, 0.3)),
    "two mirrors": (CASSEGRAIN, {}, (35.0, 0.5, 0.0, 0.3)),
    "three mirrors": (THREE_MIRRORS, {}, (30.0, 1.0, -200.0, 1.0)),
    "Maksutov, curved image": (MAKSUTOV, {"radius": -60.0}, (25.0, 1.0, -30.0, 1.0)),
    "Mangin mirror, conic image": (MANGIN, {"radius": 90.0, "conic": -2.0}, (15.0, 2.0, -20.0, 2.0)),
    "fold": (FOLDED, {}, (9.0, 4.0, -5.0, 4.0)),
    "folds about all axes": (SCANNER, {}, (5.0, 2.0, -5.0, 2.0)),
    "tilted surfaces": (TILTED, {}, (6.0, 5.0, -5.0, 5.0)),
    "axis turned round": (TURNED, {}, (5.0, 2.0, -5.0, 2.0)),
    "negative prism and lens": (NEGATIVE, {}, (4.0, 5.0, -5.0, 5.0)),
    "afocal": (AFOCAL, {}, (15.0, 0.3, -120.0, 0.3)),
    "missed": (STRONG, {}, (13.0, 40.0, -5.0, 20.0)),
    "total reflection and stops": (PRISM, {}, (9.0, 60.0, -1.0, 20.0)),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_systems(name: str) -> None:
    rows, image, (radius, degrees, z, across) = SYSTEMS[name]
    check(made(rows, image=image), ray_bundle(radius, degrees, z, across))


@pytest.mark.parametrize("conic", [-1.0, -3.0, 5.0])
def test_conics(conic: float) -> None:
    rows = [{"radius": 12.0, "thickness": 6.0, "index": 1.6}, {"radius": -15.0, "thickness": 15.0}]
    check(made([{**row, "conic": conic} for row in rows]), ray_bundle(9.0, 30.0, -5.0, 20.0))


PUPIL_X, PUPIL_Y = np.array([0.0, 0.0, 0.0, 1.0, -0.5, 0.3]), np.array([0.0, 1.0, -1.0, 0.0, 0.5, -0.6])


def launched(lens: Lens, field: tuple[float, float], place: int, size: float) -> list[tuple[Any, Any]]:
    """Six rays of a field, launched by the tracer as by the judge."""
    core = lenstrace.trace(lens, field=field, pupil=(PUPIL_X, PUPIL_Y), wavelength=lens.wavelengths.um[place])
    starts = np.array([core.x[0], core.y[0], core.z[0]]).T
    directions = np.array([core.l[0], core.m[0], core.n[0]]).T
    for i, pupil in enumerate(zip(PUPIL_X, PUPIL_Y, strict=True)):
        if not lens.ray_aiming:
            start, direction = reference_launch(lens, field, pupil)
            assert np.abs(starts[i] - start.astype(float)).max() < POSITION * size / SIZE
            assert np.abs(directions[i] - direction.astype(float)).max() < DIRECTION
    return list(zip(starts.tolist(), directions.tolist(), strict=True))


@pytest.mark.parametrize("name", [path.stem for path in sorted((Path(__file__).parents[2] / "designs").glob("*.toml"))])
def test_designs(name: str, designs: dict[str, Lens]) -> None:
    lens = designs[name]
    size = max(SIZE, sum(abs(float(row.thickness)) for row in lens.rows))
    last = len(lens.wavelengths.um) - 1
    for x, y, place in zip(lens.fields.x, lens.fields.y, (0, last, last), strict=False):
        check(lens, launched(lens, (float(x), float(y)), place, size), place, size)


RELAY = [
    {"radius": 40.0, "thickness": 6.0, "index": 1.6},
    {"thickness": 12.0, "stop": True},
    {"radius": -35.0, "thickness": 60.0, "asphere": {2: 1e-3, 4: 1e-6}},
]
LAUNCHES = [
    (np.inf, {"image_f_number": 9.0}, "image_height"),
    (np.inf, {"stop_semi_diameter": 3.5}, "angle"),
    (120.0, {"entrance_pupil_diameter": 8.0}, "angle"),
    (120.0, {"image_f_number": 9.0}, "object_height"),
    (120.0, {"stop_semi_diameter": 3.5}, "image_height"),
    (120.0, {"object_na": 0.04}, "object_height"),
]


@pytest.mark.parametrize(("distance", "aperture", "kind"), LAUNCHES)
def test_launch(distance: float, aperture: dict[str, float], kind: str) -> None:
    fields = {"kind": kind, "x": [2.0], "y": [5.0]}
    launched(lenstrace.lens(RELAY, aperture, fields, [0.55], object_distance=distance), (2.0, 5.0), 0, SIZE)
