"""Ways to a focal length and to the height of a chief ray: settings of questions of one ray, and their truth."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.accuracy.trade import Setting
from lenstrace.analysis.arrivals import Asked, arriving, launch_points
from lenstrace.analysis.cardinal import first_order
from lenstrace.analysis.conditions import conditions_of, with_pupil
from lenstrace.analysis.predictions import predicted_chief
from lenstrace.analysis.rays import trace
from lenstrace.analysis.settings.models import PRECISIONS, model_settings
from lenstrace.analysis.settings.samplings import newton_steps
from lenstrace.analysis.spot_figures import place
from lenstrace.analysis.symmetry import is_centred
from lenstrace.compute.compiled import COMPILER_OPTIONS
from lenstrace.optics.rays import Ray, living
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference import reference_trace
from lenstrace.sequential.reference_aim import reference_chief
from lenstrace.sequential.reference_launch import reference_focal_length

# Heights of the ray that a focal length is measured with, in units of the radius of the pupil.
ZONES = (1.0, 0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)


def focal_settings(lens: Lens) -> list[Setting]:
    """Ways to the focal length at the primary wavelength."""
    primary = lens.system.primary
    settings = []
    for precision in PRECISIONS:
        one = lens.astype(precision)
        settings.append(
            Setting(f"paraxial, {precision}", "paraxial", 0, lambda one=one: first_order(one).focal_length[primary])
        )
    radius = float(with_pupil(lens)[1].entrance.diameter) / 2
    # a real ray's slope tells a focal length where that of the axis is zero
    for precision in PRECISIONS if math.isfinite(radius) and is_centred(lens) else ():
        one = lens.astype(precision)
        settings.append(
            Setting(f"derivative of the exact trace, {precision}", "derivative", 1, _slope_at_axis(one, radius))
        )
        settings += [
            Setting(f"exact ray at {zone:g} of the pupil, {precision}", f"exact ray, {precision}", 1, how)
            for zone, how in ((zone, _zone(one, zone * radius)) for zone in ZONES)
        ]
    return settings


def chief_settings(lens: Lens) -> list[Setting]:
    """Ways to the height of the chief ray of the one field of a lens."""
    settings = model_settings(lens, predicted_chief)
    for precision in PRECISIONS:
        one = lens.astype(precision)
        settings.append(Setting(f"exact, {precision}", "exact", 1, _chief(one)))
    settings += [
        Setting(f"exact, Newton steps {steps}, float64", "Newton steps", 1, _chief(lens, steps))
        for steps in newton_steps(lens)
    ]
    return settings


def focal_truth(lens: Lens) -> tuple[float, float, float]:
    """The focal length of the judge's paraxial ray, mm; how far it may be off as a float; the rounding of float64."""
    # power that is rounding of the prescription alone is none
    value = math.inf if conditions_of(lens).powerless else float(reference_focal_length(lens))
    rounding = float(np.finfo(float).eps) * abs(value)
    return value, rounding / 2, rounding


def chief_truth(lens: Lens) -> tuple[float, float, float]:
    """The judge's chief ray of the one field of a lens: its height at the image, mm, along the field; as above."""
    x, y = float(lens.fields.x[0]), float(lens.fields.y[0])
    launched = jax.device_get(trace(lens, field=(x, y), path=True, opl=False))
    near = [float(a[0]) for a in (launched.x, launched.y, launched.z)]
    end = reference_trace(lens, *reference_chief(lens, (x, y), near))[-1]
    value = _along(lens, float(end.x), float(end.y))
    rounding = float(np.finfo(float).eps) * float(np.abs(lens.system.thickness).sum())
    return value, rounding / 2, rounding


def _along(lens: Lens, x: Any, y: Any) -> Any:
    """A point of the image as a height along the one field of a lens."""
    fx, fy = float(lens.fields.x[0]), float(lens.fields.y[0])
    size = math.hypot(fx, fy)
    return y if size == 0 else (fx * x + fy * y) / size


def _zone(lens: Lens, height: float) -> Callable[[], Any]:
    """-h / u' of an exact ray that comes in parallel to the axis, in a lens of one wavelength or its primary one."""
    rays = _parallel(height, lens)

    def how() -> Any:
        image = trace(lens, rays, path=False, opl=False)
        return -height * image.n / image.m

    return how


def _slope_at_axis(lens: Lens, radius: float) -> Callable[[], Any]:
    """-1 / (du'/dh) of a ray on the axis, by the derivative of the trace."""

    def slope(height: jax.Array) -> jax.Array:
        image = trace(lens, _parallel(height, lens), path=False, opl=False)
        return image.m / image.n

    def focal_length(scale: jax.Array) -> jax.Array:
        # in units of the pupil, so that a lens of any size does
        return -scale / jax.jvp(lambda share: slope(share * scale), (0 * scale,), (0 * scale + 1,))[1]

    asked = jax.jit(focal_length, compiler_options=COMPILER_OPTIONS)
    scale = np.asarray(radius, lens.system.curvature.dtype)
    return lambda: asked(scale)


def _parallel(height: Any, lens: Lens) -> Ray:
    """A ray parallel to the axis."""
    dtype = lens.system.curvature.dtype
    zero, one = jnp.zeros((), dtype), jnp.ones((), dtype)
    return living(zero, jnp.asarray(height, dtype), zero, zero, zero, one)


def _chief(lens: Lens, newton_steps: int | None = None) -> Callable[[], Any]:
    """The exact chief ray; newton_steps: at most, None as many as it takes."""
    one = lens.replace(wavelengths=lens.wavelengths.primary_alone)
    system, front = with_pupil(one)
    if newton_steps is not None:
        front = front._replace(system=front.system.with_newton_steps(newton_steps))
    asked = Asked(front, system.light, place)
    nowhere = np.zeros(0, system.curvature.dtype)  # no ray but the chief ray
    points = launch_points(asked, system.fields, nowhere, nowhere)

    def how() -> Any:
        x, y, _ = jax.device_get(arriving(asked, points))
        return _along(lens, x[0, 0, 0], y[0, 0, 0])

    return how
