"""Spot diagrams: where the rays of each field and wavelength meet the image surface, and how far they scatter."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.conditions import require_image
from lenstrace.errors import LostRaysError
from lenstrace.optics.rays import Ray, RayStatus, split_failure
from lenstrace.optics.vectors import safe_sqrt
from lenstrace.pytree import is_traced, pytree
from lenstrace.sequential.launch import launch
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


def spots(lens: Lens, *, pattern: str = "hexapolar", rings: int = 6) -> Spots:
    """The spots of every field and wavelength of a lens.

    pattern, rings: how the pupil is sampled, see `pupil_points`.
    LostRaysError where no ray of a field arrives, ImageError where the image is at infinity.
    """
    require_image(lens, "a spot")
    result = _spots(lens.system, *pupil_points(pattern, rings))
    if not is_traced(result):
        _check_arrivals(lens, result)
    return result


def loss_text(losses: dict[tuple[int, RayStatus], int]) -> str:
    """Losses in words: "12 missed at surface 3, 4 clipped at surface 5"."""
    return ", ".join(
        f"{count} {status.text} at surface {surface}" if surface else f"{count} not aimed at the stop"
        for (surface, status), count in losses.items()
    )


@jax.jit
def _spots(system: System, pupil_x: jax.Array, pupil_y: jax.Array) -> Spots:
    dtype = system.curvature.dtype
    pupil_x, pupil_y = (jnp.concatenate([jnp.zeros(1, dtype), jnp.asarray(p, dtype)]) for p in (pupil_x, pupil_y))
    fields = jnp.asarray(system.fields)
    count = system.index.shape[0]

    def arriving(wavelength: jax.Array) -> Ray:
        start = launch(system, (fields[:, :1], fields[:, 1:]), (pupil_x, pupil_y), wavelength)
        return trace(system.at(wavelength), start)

    image = jax.vmap(arriving, out_axes=1)(jnp.arange(count))
    chief_x, chief_y = (jnp.where(image.has_course, a, jnp.nan)[..., 0] for a in (image.x, image.y))
    x, y, failure = (a[..., 1:] for a in (image.x, image.y, image.failure))
    return statistics(x, y, failure, chief_x, chief_y, system.weights, system.primary)


def statistics(
    x: jax.Array,
    y: jax.Array,
    failure: jax.Array,
    chief_x: jax.Array,
    chief_y: jax.Array,
    weights: jax.Array,
    primary: int,
) -> Spots:
    """The figures of spots out of their rays: x, y, failure (F, W, N), chief rays (F, W), weights (W,)."""
    alive = failure == 0
    living = jnp.sum(alive, -1)
    one_each = alive.astype(x.dtype)
    share = one_each / jnp.maximum(living, 1)[..., None].astype(x.dtype)

    def mean(values: jax.Array) -> jax.Array:
        return jnp.sum(jnp.where(alive, values, 0) * share, -1)

    centroid_x, centroid_y = mean(x), mean(y)
    # no ray, no figure: 0 would look like a perfect spot to an optimizer that runs under jit
    some = jnp.where(living > 0, 1.0, jnp.nan).astype(x.dtype)
    about_centroid = (x - centroid_x[..., None]) ** 2 + (y - centroid_y[..., None]) ** 2
    about_chief = (x - chief_x[..., None]) ** 2 + (y - chief_y[..., None]) ** 2

    part = jnp.asarray(weights)[:, None] * one_each
    part = part / jnp.maximum(jnp.sum(part, (-2, -1), keepdims=True), jnp.finfo(x.dtype).tiny)

    def pooled(values: jax.Array) -> jax.Array:
        return jnp.sum(jnp.where(alive, values, 0) * part, (-2, -1))

    pooled_x, pooled_y = pooled(x), pooled(y)
    any_wave = jnp.where(jnp.sum(living, -1) > 0, 1.0, jnp.nan).astype(x.dtype)
    spread = pooled((x - pooled_x[..., None, None]) ** 2 + (y - pooled_y[..., None, None]) ** 2)
    chief = chief_x[:, primary, None, None], chief_y[:, primary, None, None]
    from_chief = pooled((x - chief[0]) ** 2 + (y - chief[1]) ** 2)
    return Spots(
        lost=x.shape[-1] - living,
        centroid_x=centroid_x,
        centroid_y=centroid_y,
        chief_x=chief_x,
        chief_y=chief_y,
        rms_centroid=_root(mean(about_centroid)) * some,
        rms_chief=_root(mean(about_chief)) * some,
        largest=_root(jnp.max(jnp.where(alive, about_centroid, 0), -1)) * some,
        polychromatic=Polychromatic(pooled_x, pooled_y, _root(spread) * any_wave, _root(from_chief) * any_wave),
        x=x,
        y=y,
        failure=failure,
    )


def _root(square: jax.Array) -> jax.Array:
    """sqrt, 0 at 0 with derivative 0: a perfect spot does not spoil a gradient. nan stays."""
    return jnp.where(square == 0, 0, safe_sqrt(square)) * jnp.where(jnp.isnan(square), jnp.nan, 1)


def _check_arrivals(lens: Lens, result: Spots) -> None:
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
