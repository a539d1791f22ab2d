"""A screen given by samples: the bicubic spline through them is exact for a cubic, convergent for what is smooth.

The spline's path has an error that falls with the fourth power of the step of the grid, and its slopes, which turn the
rays, with the third. Source: de Boor, A Practical Guide to Splines (2001), chapters V and XVII.
"""

from __future__ import annotations

from typing import Annotated, Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.rays import ray, trace
from lenstrace.optics.screens.grid import GridScreen
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.prescription import lens

HALF = 10.0  # mm, from the middle of the grid to its edge
AMOUNT = 1e-3  # mm, the size of both screens
STEPS = np.array([1.0, 0.7, 0.5, 0.35, 0.25, 0.18, 0.12])  # of the grid, radians of a wave, for the plot
PLACES = 200  # where it is looked at
ROUNDING = 1e-14  # of the path, in mm, and of a sine


@result
class SampledScreen(Demonstration):
    """What sampling costs.

    per_wave:      (K,), samples to a wave of a screen that is one.
    path_errors, slope_errors:  (K,), largest errors of its path and of its slopes, in units of their largest values.
    samples:       along a side, of the drawn screen.
    x:             (I,), mm, where it was sampled along either side.     values: (I, I), mm.
    """

    per_wave: np.ndarray
    path_errors: np.ndarray
    slope_errors: np.ndarray
    samples: int
    x: np.ndarray
    values: np.ndarray


@demonstration
def sampled_screen(
    samples: Annotated[int, Option("samples along a side", least=4, most=200, slider=(4, 60))] = 12,
    x: Annotated[float, Option("place of the ray in the table, x", "mm", least=-HALF, most=HALF)] = 3.0,
    y: Annotated[float, Option("place of the ray in the table, y", "mm", least=-HALF, most=HALF)] = -4.5,
) -> SampledScreen:
    """A screen known at a grid of points: exact for cubics, convergent for the rest."""
    plate = lens([{"stop": True, "screen": {"ideal_lens": 1.0}}], {"entrance_pupil_diameter": 1.0}, [0.0], [0.5876])
    u, v = x / HALF, y / HALF
    nodes = np.linspace(-1, 1, samples)
    cubic = AMOUNT * _cubic(nodes, nodes[:, None])
    path, *slopes = _through(plate, cubic, np.array([x]), np.array([y]))
    by_node = jax.device_get(_by_nodes(plate, cubic, nodes[:, None] * HALF + 0 * cubic, x, y))

    some = np.random.default_rng(1)
    px, py = some.uniform(-HALF, HALF, (2, PLACES))
    errors = []
    for number in STEPS * (samples - 1) / 2 / HALF:
        at = nodes * HALF
        found, along, _ = _through(plate, AMOUNT * np.sin(number * (at + at[:, None])), px, py)
        phase = number * (px + py)
        path_error = np.abs(found / AMOUNT - np.sin(phase)).max()
        errors.append([path_error, np.abs(along / AMOUNT / number - np.cos(phase)).max()])
    path_errors, slope_errors = np.array(errors).T
    along_x = AMOUNT / HALF * (1 - 0.9 * u**2 + v**2 + 2 * v)
    along_y = AMOUNT / HALF * (2 * u * v - 1.5 * v**2 + 2 * u)
    return SampledScreen(
        setting=f"{samples} x {samples} samples of a cubic polynomial within +-{HALF:g} mm, a ray along the axis at "
        f"({x:g}, {y:g}) mm",
        rows=(
            Comparison("added path", "um", 1e3 * path[0], 1e3 * AMOUNT * _cubic(u, v), 1e3 * ROUNDING),
            Comparison("direction cosine along x", "", slopes[0][0], along_x, ROUNDING),
            Comparison("direction cosine along y", "", slopes[1][0], along_y, ROUNDING),
            Comparison("its derivative as the samples rise like y", "1/mm", by_node, 1.0),
        ),
        per_wave=2 * np.pi / STEPS,
        path_errors=path_errors,
        slope_errors=slope_errors,
        samples=samples,
        x=nodes * HALF,
        values=cubic,
    )


def _cubic(u: Any, v: Any) -> Any:
    return u - 0.3 * u**3 + u * v**2 + 2 * u * v - 0.5 * v**3


def _through(plate: Lens, values: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
    """Added path, mm, and direction cosines of rays along the axis."""
    screen = GridScreen(values, (HALF, HALF))
    end = trace(plate.replace(surface=1, screen=screen), rays=ray((x, y, 0 * x), (0 * x, 0 * x, 1 + 0 * x)))
    assert end.opl is not None
    return np.asarray(end.opl[1]), np.asarray(end.l[1]), np.asarray(end.m[1])


@jax.jit
def _by_nodes(plate: Lens, values: jax.Array, toward: jax.Array, x: jax.Array, y: jax.Array) -> jax.Array:
    """How the direction cosine along y changes as the samples do, by automatic differentiation."""

    def slope(values: jax.Array) -> jax.Array:
        one = jnp.ones_like(x)
        start = ray((x, y, 0 * one), (0 * one, 0 * one, one))
        return trace(plate.replace(surface=1, screen=GridScreen(values, (HALF, HALF))), rays=start, opl=False).m[1]

    return jax.jvp(slope, (values,), (toward,))[1]
