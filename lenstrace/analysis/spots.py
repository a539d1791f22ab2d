"""Spot diagrams: where the rays of each field and wavelength meet the image surface, and how far they scatter."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.vignetting import Vignetting
from lenstrace.compute.blocks import each
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import LostRaysError, RayError
from lenstrace.optics.rays import RayStatus, has_course, split_failure
from lenstrace.optics.vectors import safe_sqrt
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import pupil_points
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace


@pytree
class Polychromatic:
    """All wavelengths of a field together, weighted; every array (F,), mm."""

    centroid_x: jax.Array
    centroid_y: jax.Array
    rms_centroid: jax.Array
    rms_primary_chief: jax.Array


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

    @property
    def rays(self) -> int:
        """N, the rays sent for each field and wavelength."""
        return self.x.shape[-1]

    def losses(self, field: int, wavelength: int) -> dict[tuple[int, RayStatus], int]:
        """How many rays of a spot failed at which surface for which reason."""
        codes, counts = np.unique(np.asarray(self.failure)[field, wavelength], return_counts=True)
        return {split_failure(int(code)): int(count) for code, count in zip(codes, counts, strict=True) if code}


def spots(lens: Lens, *, pattern: str = "hexapolar", rings: int = 6, vignetting: Vignetting | None = None) -> Spots:
    """The spots of every field and wavelength of a lens.

    pattern, rings: how the pupil is sampled, see `pupil_points`.
    vignetting:     see `vignetting`, of this lens; of each field the part of the pupil that it fills is sampled then.
    LostRaysError where no ray of a field arrives, ImageError where the image is at infinity.
    """
    if vignetting is not None and np.shape(vignetting.top) != (len(lens.fields.y),):
        raise RayError(f"vignetting is of {np.size(vignetting.top)} fields, the lens has {len(lens.fields.y)}")
    system, front = with_image(lens, "a spot")
    result = _spots(front, system, pupil_points(pattern, rings), vignetting)
    if not is_traced(result):
        check_arrivals(lens, result)
    return result


def loss_text(losses: dict[tuple[int, RayStatus], int]) -> str:
    """Losses in words: "12 missed at surface 3, 4 clipped at surface 5"."""
    return ", ".join(
        f"{count} {status.text} at surface {surface}" if surface else f"{count} not aimed at the stop"
        for (surface, status), count in losses.items()
    )


def _spots(front: Front, system: System, pupil: tuple[np.ndarray, np.ndarray], vignetting: Vignetting | None) -> Spots:
    """The chief ray goes first among the rays of a field."""
    fields, dtype = system.fields, system.curvature.dtype
    points = pupil if vignetting is None else vignetting.inside(*pupil)
    xp = jnp if any(isinstance(a, jax.Array) for a in (fields, *points)) else np
    shape = len(fields), len(pupil[0]) + 1
    first = (0, 0), (1, 0)
    pupil_x, pupil_y = (xp.pad(xp.broadcast_to(p, (shape[0], shape[1] - 1)), first).astype(dtype) for p in points)
    field_x, field_y = (xp.broadcast_to(fields[:, i : i + 1], shape) for i in (0, 1))
    arrived = each(_arriving, (front, system.index), (field_x, field_y, pupil_x, pupil_y))
    return _figures(arrived, system.weights, system.primary)


def _arriving(lens: tuple[Front, jax.Array], points: tuple[jax.Array, ...]) -> tuple[jax.Array, jax.Array, jax.Array]:
    """x, y and failure at the image, (W, N); lens: its front, and its index (W, S + 1)."""
    (front, indices), (field_x, field_y, pupil_x, pupil_y) = lens, points

    def at(index: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        image = trace(front.system.with_index(index), launch(front, index, (field_x, field_y), (pupil_x, pupil_y)))
        return image.x, image.y, image.failure

    return lax.map(at, jnp.asarray(indices))


@compiled
def _figures(arrived: tuple[jax.Array, jax.Array, jax.Array], weights: jax.Array, primary: jax.Array | int) -> Spots:
    """The spots out of `_arriving`, (W, F, 1 + N): of each field the chief ray, then N others."""
    x, y, failure = (jnp.swapaxes(a, 0, 1) for a in arrived)
    chief_x, chief_y = (jnp.where(has_course(failure[..., 0]), a[..., 0], jnp.nan) for a in (x, y))
    return statistics(x[..., 1:], y[..., 1:], failure[..., 1:], chief_x, chief_y, weights, primary)


def statistics(
    x: jax.Array,
    y: jax.Array,
    failure: jax.Array,
    chief_x: jax.Array,
    chief_y: jax.Array,
    weights: jax.Array,
    primary: jax.Array | int,
) -> Spots:
    """The figures of spots out of their rays: x, y, failure (F, W, N), chief rays (F, W), weights (W,)."""
    alive = failure == 0
    rays, sum_x, sum_y = (jnp.sum(jnp.where(alive, values, 0), -1) for values in (jnp.ones_like(x), x, y))
    count = jnp.maximum(rays, 1)
    centroid_x, centroid_y = sum_x / count, sum_y / count
    squares = jnp.where(alive, _square(x - centroid_x[..., None], y - centroid_y[..., None]), 0)
    variance = jnp.sum(squares, -1) / count
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
        lost=x.shape[-1] - rays.astype(int),
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


def check_arrivals(lens: Lens, result: Spots) -> None:
    """LostRaysError for the first field and wavelength none of whose rays arrives."""
    lost = np.asarray(result.lost)
    if (lost < result.rays).all():
        return
    field, wave = (int(i) for i in np.argwhere(lost == result.rays)[0])
    losses = result.losses(field, wave)
    before_stop = all(surface <= lens.stop for surface, _ in losses)
    stop = f", none reaches the stop (surface {lens.stop})" if before_stop else ""
    place = f"({float(lens.fields.x[field]):g}, {float(lens.fields.y[field]):g}) {lens.fields.unit}"
    raise LostRaysError(
        f"field {place} at {lens.wavelengths.um[wave]:g} um: all {result.rays} rays are lost{stop}: "
        f"{loss_text(losses)}; check its apertures, or reduce the field or the pupil"
    )
