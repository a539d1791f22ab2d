"""The focus of the waves: where the image surface makes the RMS of the wavefront least."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.image_rays import ImageRays, image_rays
from lenstrace.analysis.path_difference import UM_PER_MM, Sphere, differences, residual
from lenstrace.analysis.pupil_grid import grid_points
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import divide_where, root_or_zero
from lenstrace.sequential.lens import Lens

SAMPLES = 33


@pytree
class WaveFocus:
    """Shifts of the image surface along its +z, mm, and RMS wavefronts about tilted spheres, wavelengths; each
    wavelength in its own, the squares pooled by weight.

    shift, rms:              (), of least mean square over all fields, of equal weight; and the root of that mean there.
    given_rms:               (), the same where the lens has its image surface.
    field_shift, field_rms:  (F,), of each field by itself.
    """

    shift: jax.Array
    rms: jax.Array
    given_rms: jax.Array
    field_shift: jax.Array
    field_rms: jax.Array


def wave_focus(lens: Lens) -> WaveFocus:
    """Where the RMS wavefront of a lens is least: a shift s takes s n' (n - n of the chief ray) from the path
    differences (to first order in s over the radius of the sphere), so that their mean square is a parabola in s.
    ImageError where the image is at infinity, LostRaysError where a chief ray is lost."""
    with_image(lens, "a focus")
    x, y, share = grid_points(SAMPLES)
    return _wave_focus(image_rays(lens, x, y), share)


@compiled
def _wave_focus(arrived: ImageRays, cells: jax.Array | np.ndarray) -> WaveFocus:
    found = differences(arrived, Sphere())
    share = jnp.where(found.failure == 0, cells, 0).astype(found.opd.dtype)
    cosine = jnp.swapaxes(arrived.rays.n, 0, 1)
    scale = (UM_PER_MM * jnp.asarray(arrived.index) / jnp.asarray(arrived.um))[:, None]
    x, y = (
        jnp.broadcast_to(jnp.asarray(a), found.opd[:, 0].shape)[:, None] for a in (arrived.pupil_x, arrived.pupil_y)
    )
    tilts = tuple(jnp.broadcast_to(a, found.opd.shape) for a in (x, y))
    path, slope = (
        residual(a, tilts, share) for a in (found.opd, jnp.broadcast_to(scale * cosine[..., 1:], found.opd.shape))
    )
    weights = jnp.asarray(arrived.weights)
    part = share * weights[:, None]
    part = part / jnp.maximum(jnp.sum(part, (1, 2), keepdims=True), jnp.finfo(part.dtype).tiny)

    def mean(a: jax.Array) -> jax.Array:
        return jnp.sum((part * a).reshape(len(a), -1), -1)

    square, mixed, steep = mean(path * path), mean(path * slope), mean(slope * slope)

    def square_at(shift: jax.Array) -> jax.Array:
        """The mean square of each field where the image is shifted."""
        moved = path - jnp.reshape(shift, (-1, 1, 1)) * slope
        return mean(moved * moved)

    least = divide_where(steep > 0, mixed, steep)
    together = divide_where(jnp.sum(steep) > 0, jnp.sum(mixed), jnp.sum(steep))
    return WaveFocus(
        shift=together,
        rms=root_or_zero(jnp.mean(square_at(together))),
        given_rms=root_or_zero(jnp.mean(square)),
        field_shift=least,
        field_rms=root_or_zero(square_at(least)),
    )
