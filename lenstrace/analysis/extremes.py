"""The tracer at the extremes: its error in units of eps, a backward error, against the judge.

In float32 the judge gets the float32 numbers. C and its scale: see `extreme_errors`; the bound to hold is 16 for each
surface crossed.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.cardinal import first_order
from lenstrace.analysis.extreme_cases import cases
from lenstrace.analysis.extreme_errors import (
    BACKWARD,
    backward_error,
    course_of,
    gradient_error,
    judged_fate,
    launch_error,
)
from lenstrace.analysis.extreme_lenses import Case, Trial
from lenstrace.analysis.rays import ray, trace
from lenstrace.optics.rays import Ray
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference_surface import surfaces_of_system
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace as trace_system

PRECISIONS = ("float32", "float64")
# These programs run once: what is not optimized compiles in a fraction of the time.
QUICKLY: dict[str, int | bool] = {"xla_backend_optimization_level": 0, "xla_cpu_use_fusion_emitters": False}

# Of so many rays the derivatives of one are judged: that costs as much again as judging the ray.
EVERY = 3

Progress = Callable[[int, int, str], None]


@dataclasses.dataclass(frozen=True)
class Errors:
    """Of one extreme in one precision, in units of its eps.

    course, surface:   worst C at any surface, and the worst of C / number of surfaces crossed.
    launch:            worst C of rays where they are launched; 0 where they are given.
    statuses:          every status is the judge's, or is so for numbers moved by 16 eps.
    finite:            all results are finite, those of lost rays included.
    gradients_finite:  so are the derivatives of the results by every number of ray and lens.
    gradient:          worst error of the derivatives of a ray that arrives: see `gradient_error`.
    """

    course: float
    surface: float
    launch: float
    statuses: bool
    finite: bool
    gradients_finite: bool
    gradient: float


@dataclasses.dataclass(frozen=True)
class Extreme:
    """What was found at one extreme.

    surfaces, rays:  of its longest lens, the image included; of all its lenses.
    exact:           what must be exact is so: results of scaled lenses to the last bit, power 0 and infinite focal
                     lengths of afocal ones; None where nothing must.
    """

    name: str
    surfaces: int
    rays: int
    float32: Errors
    float64: Errors
    exact: bool | None


def extremes(progress: Progress | None = None) -> tuple[Extreme, ...]:
    """The tracer at every extreme. progress: called with how many are done, of how many, and the next name."""
    every, found = cases(), []
    for case in every:
        if progress is not None:
            progress(len(found), len(every), case.name)
        found.append(judged(case))
    if progress is not None:
        progress(len(every), len(every), "")
    return tuple(found)


def judged(case: Case) -> Extreme:
    """One extreme."""
    single, double = (_worst([_errors(trial, precision) for trial in case.trials]) for precision in PRECISIONS)
    exact = None
    if case.scales:
        exact = all(_scales(case, precision) for precision in PRECISIONS)
    elif case.afocal:
        exact = all(_is_afocal(trial.lens.astype(precision)) for trial in case.trials for precision in PRECISIONS)
    surfaces = max(len(trial.lens) for trial in case.trials) + 1
    return Extreme(case.name, surfaces, sum(trial.count for trial in case.trials), single, double, exact)


def _worst(errors: list[Errors]) -> Errors:
    """The worst of each figure: the largest number, or False."""
    columns = zip(*map(dataclasses.astuple, errors), strict=True)
    return Errors(*(all(column) if isinstance(column[0], bool) else max(column) for column in columns))


def _errors(trial: Trial, precision: str) -> Errors:
    lens = trial.lens.astype(precision)
    system = lens.system.at(lens.system.primary)
    eps = float(np.finfo(precision).eps)
    path = _traced(lens, trial)
    values = np.stack([np.asarray(a) for a in (path.x, path.y, path.z, path.l, path.m, path.n, path.opl)], -1)
    starts, failures = values[0, :, :6], np.asarray(path.failure)[-1]
    slopes = [_jacobian(system, start) for start in starts]
    starts = starts.astype(float)
    surfaces = surfaces_of_system(system)
    found = []
    for i, start in enumerate(starts):
        rows = course_of(surfaces, start)
        agrees, last = judged_fate(surfaces, start, rows, int(failures[i]), eps)
        each = [backward_error(rows[s], values[s, i], eps) for s in range(1, last + 1)]
        arrives = last == len(surfaces) and bool(np.isfinite(rows[-1].condition).all())
        found.append(
            Errors(
                course=max(each, default=0.0),
                surface=max((error / s for s, error in enumerate(each, 1)), default=0.0),
                launch=0.0 if trial.launched is None else launch_error(trial.lens, trial.launched[i], start, precision),
                statuses=agrees,
                finite=bool(np.isfinite(values[:, i]).all()),
                gradients_finite=bool(np.isfinite(slopes[i]).all()),
                gradient=gradient_error(surfaces, start, rows[-1], slopes[i], eps)
                if arrives and not i % EVERY
                else 0.0,
            )
        )
    return _worst(found)


def _traced(lens: Lens, trial: Trial) -> Ray:
    """The rays of a trial at all surfaces, as any caller would trace them."""
    if trial.launched is not None:
        x, y, pupil_x, pupil_y = trial.launched.T
        return trace(lens, field=(x, y), pupil=(pupil_x, pupil_y))
    assert trial.rays is not None
    x, y, z, l, m, n = trial.rays.T
    return trace(lens, ray((x, y, z), (l, m, n)))


def _jacobian(system: System, start: jax.Array) -> np.ndarray:
    """(7, I): derivatives of x, y, z, l, m, n and opl of a ray at the image by its own six numbers and by those of the
    system, in the order of `input_numbers`, and by the asphere terms as the judge knows them, a_p of r^p."""
    rows = [_slopes(_bare(system), start, weights) for weights in np.eye(7, dtype=start.dtype)]
    slopes = np.stack(jax.device_get(rows)).astype(float)
    count = len(system.kinds)
    powers = np.array(max((kind.powers for kind in system.kinds), key=len), int)
    blocks = slopes[:, 6 + count :].reshape(7, count, -1)
    blocks[..., 2 : 2 + len(powers)] *= np.asarray(system.norm_radius, float)[:, None] ** (powers - 1)
    return slopes


def _slope(system: System, start: jax.Array, weights: jax.Array) -> jax.Array:
    """(I,): derivatives of a weighted sum of the seven results."""
    names = ("index", "curvature", "conic", "coefficients", "thickness", "decenter", "tilt")

    def result(start: jax.Array, numbers: dict[str, jax.Array]) -> jax.Array:
        x, y, z, l, m, n = start
        ray = Ray(x, y, z, l, m, n, failure=jnp.zeros((), jnp.int32), opl=jnp.zeros_like(x))
        sense = jnp.where(n < BACKWARD, -1.0, 1.0).astype(start.dtype)
        end = trace_system(system.replace(**numbers), ray, sense=sense)
        assert end.opl is not None
        return jnp.dot(weights, jnp.stack([end.x, end.y, end.z, end.l, end.m, end.n, end.opl]))

    numbers = {name: jnp.asarray(getattr(system, name)) for name in names}
    by_start, by = jax.grad(result, argnums=(0, 1))(start, numbers)
    gap = jnp.concatenate([jnp.zeros_like(by["curvature"][:1]), by["thickness"]])
    own = [by["curvature"][:, None], by["conic"][:, None], by["coefficients"], gap[:, None], by["decenter"], by["tilt"]]
    return jnp.concatenate([by_start, by["index"], jnp.concatenate(own, -1).reshape(-1)])


_slopes = jax.jit(_slope, compiler_options=QUICKLY)


def _bare(system: System) -> System:
    """What a trace needs and nothing else, so that lenses that are launched differently share a program."""
    return system.replace(object_distance=None, stop=1, aperture_kind="", field_kind="", ray_aiming=False)


def _scales(case: Case, precision: str) -> bool:
    """True where the lengths of the other trials are those of the first, scaled, and all else is the same."""
    first, *others = (_traced(trial.lens.astype(precision), trial) for trial in case.trials)
    for other, scale in zip(others, case.scales, strict=True):
        for name in ("x", "y", "z", "l", "m", "n", "opl"):
            factor = np.asarray(1.0 if name in "lmn" else scale, precision)
            if not np.array_equal(np.asarray(getattr(first, name)) * factor, np.asarray(getattr(other, name))):
                return False
    return True


def _is_afocal(lens: Lens) -> bool:
    """True where power is 0, what lies at infinity is inf, and nothing is nan."""
    found = first_order(lens)
    numbers = [np.asarray(value) for value in jax.tree.leaves(found)]
    infinite = np.isinf(found.focal_length).all() and np.isinf(found.rear_principal_plane).all()
    return bool(np.all(found.power == 0)) and bool(infinite) and not any(np.isnan(value).any() for value in numbers)
