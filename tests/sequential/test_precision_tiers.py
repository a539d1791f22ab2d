"""What each precision reaches, against the judge: image position, and path difference to the reference sphere."""

from __future__ import annotations

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import mpmath
import numpy as np
import pytest

import lenstrace
from lenstrace import Lens
from lenstrace.analysis.conditions import conditions_of, with_pupil
from lenstrace.analysis.image_rays import ImageRays, image_rays
from lenstrace.analysis.path_difference import Sphere, differences
from lenstrace.sequential.launch import path_before
from lenstrace.sequential.reference import reference_trace
from lenstrace.sequential.reference_launch import reference_launch

mp: Any = mpmath.mp
UM_PER_MM = 1000
X, Y = np.array([0.0, 0.0, 0.7, -0.3, 1.0]), np.array([1.0, -1.0, 0.4, 0.6, 0.0])
# The largest design is a telescope of 17 m, the smallest with a focus a ball of 6.5 mm; a phone lens is hardly longer.
NAMES = ("double_gauss", "three_mirror_telescope", "ball_lens", "phone_lens")
# Of the length of the lens, and of the image.
POSITION = {"float32": 2e-7, "float64": 3e-13}
STEEP = {"phone_lens": 2.0}  # its surfaces magnify errors
WAVES = {"float32": 0.01, "float64": 1e-10}
SAGS = 4  # so many eps of the largest sag where that is more waves


def judged(lens: Lens) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """x and y at the image, mm, and waves of path difference, (F, N) each, at the primary wavelength: W is the chief
    ray's path to the sphere about its image point through the exit pupil, less the ray's. And the largest sag, mm."""
    pupil_z = mp.mpf(float(conditions_of(lens).exit_position))
    found, sags = [], []
    with mp.workdps(50):
        for field in zip(map(float, lens.fields.x), map(float, lens.fields.y), strict=True):
            ends = []
            for pupil in [(0.0, 0.0), *zip(X, Y, strict=True)]:
                point, direction = reference_launch(lens, field, pupil)
                rows = reference_trace(lens, point, direction)
                sags += [abs(row.z) for row in rows[1:]]
                end = rows[-1]
                ends.append(((end.x, end.y, end.z), (end.l, end.m, end.n), end.opl + point @ direction))
            centre = ends[0][0]
            behind = centre[2] - pupil_z
            radius_squared = centre[0] ** 2 + centre[1] ** 2 + behind**2
            sense = mp.sign(behind * ends[0][1][2])

            def to_sphere(end: Any, centre: Any = centre, square: Any = radius_squared, sense: Any = sense) -> Any:
                point, direction, opl = end
                apart = [a - b for a, b in zip(point, centre, strict=True)]
                along = mp.fdot(apart, direction)
                return opl - along - sense * mp.sqrt(along**2 - mp.fdot(apart, apart) + square)

            chief = to_sphere(ends[0])
            wave = mp.mpf(lens.wavelengths.um[lens.wavelengths.primary]) / UM_PER_MM
            found.append([[end[0][0], end[0][1], (chief - to_sphere(end)) / wave] for end in ends[1:]])
    x, y, opd = np.moveaxis(np.array(found).astype(float), -1, 0)
    return x, y, opd, float(max(sags))


def summed(lens: Lens, arrived: ImageRays) -> ImageRays:
    """The same rays with the path as a textbook adds it up, from the wavefront to the image."""
    system, front = with_pupil(lens)
    light, dtype = system.light_at(system.primary), system.curvature.dtype
    paths = []
    for x, y in zip(lens.fields.x, lens.fields.y, strict=True):
        pupil = np.append(0.0, X), np.append(0.0, Y)
        ray = lenstrace.trace(lens, field=(float(x), float(y)), pupil=pupil)
        radians = [jnp.asarray(float(a) * lens.fields.scale, dtype) for a in (x, y)]
        assert ray.opl is not None
        start = jax.tree.map(lambda a: a[0], ray)
        paths.append(path_before(front, light, (radians[0], radians[1]), start) + ray.opl[-1])
    opl = jnp.broadcast_to(jnp.stack(paths), arrived.rays.x.shape)
    return dataclasses.replace(arrived, rays=dataclasses.replace(arrived.rays, opl=opl))


@pytest.mark.parametrize("name", NAMES)
def test_the_tiers(name: str, designs: dict[str, Lens]) -> None:
    lens = designs[name]
    primary, length = lens.wavelengths.primary, sum(abs(float(row.thickness)) for row in lens.rows)
    x, y, opd, sag = judged(lens)
    for precision, most in WAVES.items():
        rounded = lens.astype(precision)
        arrived = image_rays(rounded, X, Y)
        for found, expected in ((arrived.rays.x, x), (arrived.rays.y, y)):
            error = np.abs(np.asarray(found[primary, :, 1:], float) - expected).max()
            size = length * STEEP.get(name, 1.0) if precision == "float32" else np.hypot(x, y).max()
            assert error <= POSITION[precision] * size
            assert name != "double_gauss" or precision == "float64" or error <= 2e-5
        wave = lens.wavelengths.um[primary] / UM_PER_MM
        allowed = max(most, SAGS * float(np.finfo(precision).eps) * sag / wave)
        assert np.abs(np.asarray(differences(arrived, Sphere()).opd[:, primary], float) - opd).max() <= allowed
        if name == "double_gauss":
            textbook = np.asarray(differences(summed(rounded, arrived), Sphere()).opd[:, primary], float)
            excess = np.asarray(differences(arrived, Sphere()).opd[:, primary], float)
            assert np.abs(textbook - opd).max() > 4 * np.abs(excess - opd).max()
            assert precision != "float32" or np.abs(textbook - opd).max() > most
