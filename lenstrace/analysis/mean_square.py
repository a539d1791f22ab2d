"""The mean square spot: the merit that a search descends, and its gradient, at the cost of a few traces."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.conditions import require_image
from lenstrace.blocks import total
from lenstrace.sequential.launch import launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import pupil_points
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace


def mean_square_spot(lens: Lens, *, pattern: str = "hexapolar", rings: int = 6) -> jax.Array:
    """The mean square distance of the rays of each field from their centroid, (F,), mm^2.

    All wavelengths are pooled by weight: the square of `spots(lens).polychromatic.rms_centroid`, but no ray is kept, so
    that a million take no memory, and the gradient takes the time of about five traces. nan where no ray arrives.
    pattern, rings: how the pupil is sampled, see `pupil_points`. ImageError where the image is at infinity.
    """
    require_image(lens, "a spot")
    dtype = lens.system.curvature.dtype
    return _mean_square(lens.system, tuple(p.astype(dtype) for p in pupil_points(pattern, rings)))


@jax.custom_jvp
def _mean_square(system: System, pupil: tuple[np.ndarray, np.ndarray]) -> jax.Array:
    return _about(system, _centroids(system, pupil), pupil)


@_mean_square.defjvp
def _(primals: Any, tangents: Any) -> Any:
    """The mean square is least about the centroid: as the lens changes, the centroid may stay where it is."""
    system, pupil = primals
    cases = _centroids(system, pupil)
    return jax.jvp(lambda moved: _about(moved, cases, pupil), (system,), tangents[:1])


def _centroids(system: System, pupil: Any) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Of each field: itself (F, 2), the centroid (F, 2), and the sum of the weights of its rays (F,)."""
    fields = jnp.asarray(system.fields)
    weight, x, y = total(_weighted_places, system, fields, pupil)
    return fields, jnp.stack([x, y], -1) / weight[:, None], weight


def _about(system: System, cases: Any, pupil: Any) -> jax.Array:
    return total(_weighted_squares, system, cases, pupil) / cases[-1]


def _weighted_places(system: System, field: jax.Array, pupil: Any) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Weight, and weight times x and y, of the rays of a field, all wavelengths added."""
    x, y, weight = _arriving(system, field, pupil)
    return weight.sum(0), (weight * x).sum(0), (weight * y).sum(0)


def _weighted_squares(system: System, case: tuple[jax.Array, jax.Array, jax.Array], pupil: Any) -> jax.Array:
    """Weight times squared distance from the centre of the rays of a field, all wavelengths added."""
    field, centre, _ = case
    x, y, weight = _arriving(system, field, pupil)
    return (weight * ((x - centre[0]) ** 2 + (y - centre[1]) ** 2)).sum(0)


def _arriving(system: System, field: jax.Array, pupil: Any) -> tuple[jax.Array, jax.Array, jax.Array]:
    """x, y and weight at the image, (W, N); a lost ray has the weight 0."""
    primary = system.at(system.primary)

    def at(colour: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array, jax.Array]:
        index, weight = colour
        image = trace(system.with_index(index), launch(primary, index, (field[0], field[1]), pupil))
        return image.x, image.y, jnp.where(image.ok, weight, 0)

    return lax.map(at, (jnp.asarray(system.index), jnp.asarray(system.weights)))
