"""Ways to sample the pupil: the settings of a spot and of a wavefront, and the truth of both."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.accuracy.convergence import Answer, converge
from lenstrace.accuracy.trade import Setting
from lenstrace.analysis.arrivals import Asked, arriving, launch_points
from lenstrace.analysis.conditions import with_image, with_pupil
from lenstrace.analysis.image_rays import ImageRays, image_rays
from lenstrace.analysis.path_difference import Sphere, differences
from lenstrace.analysis.predictions import predicted_spot, predicted_wavefront
from lenstrace.analysis.pupil_rules import RulePair, open_pupil, whole_pupil
from lenstrace.analysis.settings.models import PRECISIONS, model_settings
from lenstrace.analysis.settings.samplings import Sampling, newton_sampling, newton_steps, samplings
from lenstrace.analysis.spot_accuracy import LADDER, accurate_spots
from lenstrace.analysis.spot_figures import place
from lenstrace.analysis.symmetry import has_apertures
from lenstrace.compute.compiled import compiled
from lenstrace.compute.padding import padded
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import PupilPoints

# Relative error of the truth that is tried for, and the rings that may be taken: 1e-10 is reached by aspheres of odd
# powers too, 1e-13 by all others. Rays that are aimed take too long for more than 1e-10.
TRUE, TRUE_AIMED = 1e-13, 1e-10
TRUE_LADDER = (*LADDER, 90, 120)


def spot_settings(lens: Lens) -> list[Setting]:
    """Ways to the RMS spot of the one field of a lens."""
    settings = model_settings(lens, predicted_spot)
    for precision in PRECISIONS:
        one = lens.astype(precision)
        settings += [_setting(each, precision, _spot(one, each), each.points) for each in samplings(lens)]
    sampling = newton_sampling()
    for steps in newton_steps(lens):
        settings.append(
            Setting(
                f"Newton steps {steps}, {len(sampling.points.x)} rays, float64",
                "Newton steps",
                len(sampling.points.x),
                _spot(lens, sampling, steps),
            )
        )
    return settings


def opd_settings(lens: Lens) -> list[Setting]:
    """Ways to the RMS path difference of the one field of a lens at its primary wavelength."""
    lens = _one_wave(lens)
    settings = model_settings(lens, predicted_wavefront)
    for precision in PRECISIONS:
        one = lens.astype(precision)
        settings += [_setting(each, precision, _opd(one, each), each.points) for each in samplings(lens)]
        settings += [
            _setting(each, f"{precision}, path summed", _opd(one, each, axial=True), each.points)
            for each in samplings(lens)
            if each.family == "gaussian"
        ]
    return settings


def spot_truth(lens: Lens) -> tuple[float, float, float]:
    """The RMS spot, how far it may be off, and the rounding of float64; mm."""
    found = jax.device_get(accurate_spots(lens.astype("float64"), _true(lens), TRUE_LADDER))
    value, error = float(found.polychromatic.rms_centroid[0]), float(found.error.polychromatic[0])
    return value, error, float(np.finfo(float).eps * np.abs(lens.system.thickness).sum())


def opd_truth(lens: Lens) -> tuple[float, float, float]:
    """The RMS path difference, how far it may be off, and the rounding of float64; waves."""
    lens = _one_wave(lens.astype("float64"))
    system, front = with_pupil(lens)

    def answer(rings: int) -> Answer[None]:
        pair = whole_pupil(rings)
        opd, arrives = _paths_through(lens, pair)
        if has_apertures(system) or not arrives.all():
            pair = open_pupil(front, system.light, system.fields, rings)
            opd, arrives = _paths_through(lens, pair)
        first, second, both = (
            _spread(opd, rule.reshape(-1) * arrives) for rule in (pair.first, pair.second, pair.first + pair.second)
        )
        return Answer(None, np.array([np.sqrt(both)]), np.array([abs(first - second) / (2 * np.sqrt(both) or 1)]))

    found = converge(answer, TRUE_LADDER, _true(lens))
    # about one eps of the largest path, mm, in waves
    rounding = float(np.finfo(float).eps * np.abs(system.thickness).sum() * 1e3 / lens.wavelengths.um[0])
    return float(found.value[0]), float(found.error[0]) + rounding, rounding


def _true(lens: Lens) -> float:
    return TRUE_AIMED if lens.ray_aiming else TRUE


def _paths_through(lens: Lens, pair: RulePair) -> tuple[np.ndarray, np.ndarray]:
    """Path differences in waves, and whether the rays arrive, (N,) both."""
    count = pair.x.shape[-1]
    opd, arrives = jax.device_get(_paths(image_rays(lens, *padded(pair.x, pair.y))))
    return opd[0, 0, :count], arrives[0, 0, :count]


def _spread(values: np.ndarray, weight: np.ndarray) -> float:
    share = weight / weight.sum()
    return float(share @ (values - share @ values) ** 2)


def _setting(sampling: Sampling, precision: str, how: Callable[[], Any], points: PupilPoints) -> Setting:
    count = len(points.x)
    return Setting(f"{sampling.name}, {count} rays, {precision}", f"{sampling.family}, {precision}", count, how)


def _spot(lens: Lens, sampling: Sampling, newton_steps: int | None = None) -> Callable[[], Any]:
    """The question of a spot, with its arrays made beforehand; newton_steps: at most, None as many as it takes."""
    system, front = with_image(lens, "a spot")
    dtype = system.curvature.dtype
    x, y, weight = padded(*sampling.points)
    if newton_steps is not None:
        front = front._replace(system=front.system.with_newton_steps(newton_steps))
    asked = Asked(front, system.light, place)
    points = launch_points(asked, system.fields, x, y)
    given = jax.device_put((weight.astype(dtype), system.weights, np.asarray(sampling.free, dtype)))

    def how() -> Any:
        return _size(arriving(asked, points), *given)

    return how


@compiled
def _size(arrived: Any, weight: jax.Array, weights: jax.Array, free: jax.Array) -> jax.Array:
    """RMS about the centroid of rays (W, 1, 1 + N), all wavelengths pooled, mm."""
    x, y, failure = (a[:, 0, 1:] for a in arrived)
    share = jnp.where(failure == 0, weight * weights[:, None], 0)
    share = share / jnp.sum(share)
    x, y = (a - each * jnp.sum(share * a) for a, each in ((x, free[0]), (y, free[1])))
    return jnp.sqrt(jnp.sum(share * (x * x + y * y)))


def _opd(lens: Lens, sampling: Sampling, *, axial: bool = False) -> Callable[[], Any]:
    """The question of a wavefront; axial: paths whole, with the path along the axis."""
    x, y, weight = (p.astype(lens.system.curvature.dtype) for p in padded(*sampling.points))

    def how() -> Any:
        return _opd_size(image_rays(lens, x, y, axial=axial), weight)

    return how


@compiled
def _opd_size(arrived: ImageRays, weight: Any) -> jax.Array:
    """RMS about the mean, waves, of the first field and wavelength."""
    opd, arrives = (a[0, 0] for a in _paths_of(arrived))
    share = jnp.where(arrives, weight, 0)
    share = share / jnp.sum(share)
    opd = jnp.where(arrives, opd, 0)
    return jnp.sqrt(jnp.sum(share * (opd - jnp.sum(share * opd)) ** 2))


def _paths_of(arrived: ImageRays) -> tuple[jax.Array, jax.Array]:
    found = differences(arrived, Sphere("chief"))
    return found.opd, found.failure == 0


_paths = compiled(_paths_of)


def _one_wave(lens: Lens) -> Lens:
    return lens.replace(wavelengths=lens.wavelengths.primary_alone)
