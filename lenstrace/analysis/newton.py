"""Newton's equation X X' = f f', checked twice: with paraxial rays, and with real rays near the axis.

X and X' run along +z from F to the object and from F' to the image; f = -n / phi, f' = n' / phi, and n'
counts negative after an odd number of mirrors.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import ImageError
from lenstrace.optics.rays import living
from lenstrace.sequential import paraxial
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace

MAGNIFICATIONS = (-100.0, -10.0, -1.0, -0.1, -0.01, 0.01, 0.5, 2.0, 100.0)
# Heights of the real rays in units of the paraxial radius of the entrance pupil.
HEIGHTS = (8e-3, 4e-3, 2e-3)

# A residual below this many eps, times the longer of the two sides' magnifications, is rounding.
ROUNDING = 1e4


@pytree
class NewtonCheck:
    """Newton's equation at M conjugates, at the primary wavelength; lengths in mm.

    magnification, x_object:   (M,), m and X = -f / m.
    x_image, residual:         (M,), X' of a paraxial ray, and X X' / (f f') - 1.
    heights:                   (H,), of real rays on the first vertex plane.
    real_x_image, real_residual:  (H, M), of those rays; nan where a ray fails.
    expected:                  f f', mm^2.
    slope:                     (M,), d log|residual| / d log height of the two lowest rays, 2 for an exact trace;
                               nan where the lowest residual is rounding (an image without spherical aberration).
    """

    magnification: jax.Array
    x_object: jax.Array
    x_image: jax.Array
    residual: jax.Array
    heights: jax.Array
    real_x_image: jax.Array
    real_residual: jax.Array
    expected: jax.Array
    slope: jax.Array


def newton_check(lens: Lens) -> NewtonCheck:
    """Object moved through nine conjugates, real and virtual; ImageError for a lens without power."""
    result = _newton(lens.system)
    if not is_traced(result) and not np.isfinite(np.asarray(result.expected)):
        raise ImageError("Newton's equation needs focal points, and this lens is afocal (power 0)")
    return result


@compiled
def _newton(system: System) -> NewtonCheck:
    primary = system.at(system.primary)
    points = paraxial.first_order(primary)
    pupil = paraxial.entrance_pupil(primary).diameter / 2
    dtype = system.curvature.dtype
    m = jnp.array(MAGNIFICATIONS, dtype)
    x_object = -points.object_focal_length / m
    position = x_object + points.front_focal_point
    x_image = paraxial.image_distance(primary, position) - points.rear_focal_point
    expected = points.object_focal_length * points.focal_length
    heights = jnp.array(HEIGHTS, dtype) * jnp.where(jnp.isfinite(pupil), pupil, jnp.abs(points.focal_length) / 10)
    real = _crossing(primary, heights[:, None], position) - points.rear_focal_point
    real_residual = x_object * real / expected - 1
    low, lowest = jnp.abs(real_residual[-2]), jnp.abs(real_residual[-1])
    rounding = lowest <= ROUNDING * jnp.finfo(dtype).eps * jnp.maximum(jnp.abs(m), 1 / jnp.abs(m))
    return NewtonCheck(
        magnification=m,
        x_object=x_object,
        x_image=x_image,
        residual=x_object * x_image / expected - 1,
        heights=heights,
        real_x_image=real,
        real_residual=real_residual,
        expected=expected,
        slope=jnp.where(rounding, jnp.nan, jnp.log(low / lowest) / jnp.log(heights[-2] / heights[-1])),
    )


def _crossing(system: System, height: jax.Array, position: jax.Array) -> jax.Array:
    """Where the real ray from (or toward) the axial point at `position` that meets the first vertex plane at `height`
    crosses the axis, mm from the last vertex that bends; nan where it fails."""
    height, position = jnp.broadcast_arrays(height, position)
    sense = jnp.where(position < 0, 1.0, -1.0).astype(height.dtype)
    length = jnp.hypot(height, position)
    zero = jnp.zeros_like(height)
    start = living(zero, height, zero, zero, sense * height / length, -sense * position / length)
    # in the frame of the image, which breaks behind the last mirror have turned along the light
    end = trace(system, start)
    behind = system.thickness[-1] + jnp.sum(jnp.where(paraxial.gaps_behind(system), system.thickness[:-1], 0))
    return jnp.where(end.has_course, behind + end.z - end.y * end.n / end.m, jnp.nan)
