"""The figures of spots out of their rays: centroid, RMS, losses."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.rays import Ray, RayStatus, has_course, split_failure
from lenstrace.optics.vectors import safe_sqrt
from lenstrace.sequential.system import System


@pytree
class Polychromatic:
    """All wavelengths of a field together, weighted; every array (F,), mm."""

    centroid_x: jax.Array
    centroid_y: jax.Array
    rms_centroid: jax.Array
    rms_primary_chief: jax.Array


@pytree
class SpotErrors:
    """How far the figures of spots may be from the integral over the open pupil; mm, lengths on the image surface.

    rms_centroid:   (F, W), estimates of the error of `Spots.rms_centroid`.
    polychromatic:  (F,), of that of `Polychromatic.rms_centroid`.
    open:           (F, W), the part of the pupil that light comes through.
    tolerance:      what was asked for, relative.      reached: whether it was, for all of them.
    rounded:        where it was not, whether that is by rounding alone, which more rays do not lessen; of a perfect
                    spot nothing else is left.
    rings:          of the two rules, see `pupil_rules`.
    """

    rms_centroid: jax.Array
    polychromatic: jax.Array
    open: jax.Array
    tolerance: float = static()
    reached: bool = static()
    rounded: bool = static()
    rings: int = static()


@pytree
class Spots:
    """The spots of F fields and W wavelengths, N rays sent for each; lengths in mm on the image surface.

    lost:          (F, W), rays that did not arrive; they count in no other figure.
    centroid_x, centroid_y, chief_x, chief_y:  (F, W). The chief ray goes through the centre of the pupil; an
                   obscuration does not take it away. Where it fails otherwise its place, and what is measured
                   from it, is nan.
    rms_centroid:  (F, W), sqrt(mean((x - xc)^2 + (y - yc)^2)) about the centroid; rms_chief about the chief ray.
    largest:       (F, W), largest distance of a ray from the centroid.
    x, y, failure: (F, W, N), every ray; see `Ray.failure`.
    error:         estimates of the errors where a tolerance was asked for, else None.

    A spot without any ray is an error (LostRaysError); under `jit`, where none can be raised, its sizes are nan.
    """

    lost: jax.Array
    centroid_x: jax.Array
    centroid_y: jax.Array
    chief_x: jax.Array
    chief_y: jax.Array
    rms_centroid: jax.Array
    rms_chief: jax.Array
    largest: jax.Array
    polychromatic: Polychromatic
    x: jax.Array
    y: jax.Array
    failure: jax.Array
    error: SpotErrors | None = None

    @property
    def rays(self) -> int:
        """N, the rays sent for each field and wavelength."""
        return self.x.shape[-1]

    def losses(self, field: int, wavelength: int) -> dict[tuple[int, RayStatus], int]:
        """How many rays of a spot failed at which surface for which reason."""
        codes, counts = np.unique(np.asarray(self.failure)[field, wavelength], return_counts=True)
        return {split_failure(int(code)): int(count) for code, count in zip(codes, counts, strict=True) if code}


def place(_: System, ray: Ray) -> tuple[jax.Array, jax.Array, jax.Array]:
    """What a spot keeps of a ray."""
    return ray.x, ray.y, ray.failure


@compiled
def figures(arrived: tuple[Any, Any, Any], weight: Any, weights: Any, primary: Any) -> Spots:
    """`spots_of`, compiled."""
    return spots_of(arrived, weight, weights, primary)


def spots_of(arrived: tuple[Any, Any, Any], weight: Any, weights: Any, primary: Any) -> Spots:
    """The spots out of x, y and failure of the rays, (W, F, 1 + N): of each field the chief ray, then N others.

    weight: of the N others, (N,) or (W, F, N).      weights: of the wavelengths, (W,).
    """
    x, y, failure = (jnp.swapaxes(a, 0, 1) for a in arrived)
    weight = jnp.asarray(weight)
    weight = jnp.swapaxes(weight, 0, 1) if weight.ndim == 3 else weight
    chief_x, chief_y = (jnp.where(has_course(failure[..., 0]), a[..., 0], jnp.nan) for a in (x, y))
    return _statistics(x[..., 1:], y[..., 1:], failure[..., 1:], weight, chief_x, chief_y, weights, primary)


def loss_text(losses: dict[tuple[int, RayStatus], int]) -> str:
    """Losses in words: "12 missed at surface 3, 4 clipped at surface 5"."""
    return ", ".join(
        f"{count} {status.text} at surface {surface}" if surface else f"{count} not aimed at the stop"
        for (surface, status), count in losses.items()
    )


def _statistics(
    x: jax.Array,
    y: jax.Array,
    failure: jax.Array,
    weight: jax.Array,
    chief_x: jax.Array,
    chief_y: jax.Array,
    weights: jax.Array,
    primary: jax.Array | int,
) -> Spots:
    """The figures of spots out of their rays: x, y, failure (F, W, N), weight of each ray (N,) or (F, W, N), chief rays
    (F, W), weights (W,)."""
    alive = failure == 0
    share = jnp.where(alive, weight, 0)
    rays = jnp.sum(share, -1)
    count = jnp.where(rays > 0, rays, 1)
    centroid_x, centroid_y = jnp.sum(share * x, -1) / count, jnp.sum(share * y, -1) / count
    squares = jnp.where(alive, _square(x - centroid_x[..., None], y - centroid_y[..., None]), 0)
    variance = jnp.sum(share * squares, -1) / count
    from_chief = variance + _square(centroid_x - chief_x, centroid_y - chief_y)

    # wavelengths pooled; the mean square about any point is that about the centroid plus the centroid's own
    part = jnp.asarray(weights) * rays
    weight = jnp.sum(part, -1)
    part = part / jnp.where(weight > 0, weight, 1)[:, None]
    pooled_x, pooled_y = jnp.sum(part * centroid_x, -1), jnp.sum(part * centroid_y, -1)

    def pooled(about_x: jax.Array, about_y: jax.Array) -> jax.Array:
        distance = _square(centroid_x - about_x[:, None], centroid_y - about_y[:, None])
        return _root(jnp.sum(part * (variance + distance), -1)) + _none(weight)

    none = _none(rays)
    return Spots(
        lost=jnp.sum(~alive, -1),
        centroid_x=centroid_x,
        centroid_y=centroid_y,
        chief_x=chief_x,
        chief_y=chief_y,
        rms_centroid=_root(variance) + none,
        rms_chief=_root(from_chief) + none,
        largest=_root(jnp.max(squares, -1)) + none,
        polychromatic=Polychromatic(
            pooled_x, pooled_y, pooled(pooled_x, pooled_y), pooled(chief_x[:, primary], chief_y[:, primary])
        ),
        x=x,
        y=y,
        failure=failure,
    )


def _square(x: jax.Array, y: jax.Array) -> jax.Array:
    return x * x + y * y


def _none(rays: jax.Array) -> jax.Array:
    """0, but nan without any ray: no ray, no figure. 0 would look like a perfect spot to an optimizer under jit."""
    return jnp.where(rays > 0, 0.0, jnp.nan).astype(rays.dtype)


def _root(square: jax.Array) -> jax.Array:
    """sqrt, 0 at 0 with derivative 0: a perfect spot does not spoil a gradient. nan stays."""
    return jnp.where(square == 0, 0, safe_sqrt(square)) * jnp.where(jnp.isnan(square), jnp.nan, 1)
