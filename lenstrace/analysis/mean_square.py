"""The mean square spot: the merit that a search descends, and its gradient, at the cost of a few traces."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.conditions import with_image
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree
from lenstrace.compute.totals import moving, total
from lenstrace.optics.rays import Ray
from lenstrace.sequential.launch import Front, launch
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import PupilPoints, pupil_points
from lenstrace.sequential.system import Light
from lenstrace.sequential.trace import trace

# Rays that tell where the centroid is, to a part of the size of the spot.
FEW = 64


@pytree
class Imaged:
    """The front of a lens, its fields (F, 2), the light of its wavelengths and their weights (W,)."""

    front: Front
    fields: jax.Array
    light: Light
    weights: jax.Array


def mean_square_spot(lens: Lens, *, pattern: str = "hexapolar", rings: int = 6) -> jax.Array:
    """The mean square distance of the rays of each field from their centroid, (F,), mm^2.

    All wavelengths are pooled by weight: the square of `spots(lens).polychromatic.rms_centroid`, but no ray is kept, so
    that many take no memory, and the gradient takes the time of about five traces. nan where no ray arrives.
    pattern, rings: how the pupil is sampled, see `pupil_points`. ImageError where the image is at infinity.
    """
    system, front = with_image(lens, "a spot")
    points = jax.tree.map(lambda p: jnp.asarray(p, system.curvature.dtype), pupil_points(pattern, rings))
    return _mean_square(
        Imaged(front, *jax.tree.map(jnp.asarray, (system.fields, system.light, system.weights))), points
    )


@jax.custom_jvp
def _mean_square(lens: Imaged, pupil: PupilPoints) -> jax.Array:
    """In one pass over the rays: of their moments about a place near the centroid, so that no digits cancel."""
    few = jax.tree.map(lambda p: p[:: 1 + p.shape[0] // FEW], pupil)
    fields, waves = _pairs(lens)
    near = _pooled_places(total(_courses, lens, (fields, waves), few), lens.weights)[0]
    moments = total(_moments, lens, (fields, waves, jnp.repeat(near, len(lens.weights), 0)), pupil)
    return _pooled_moments(moments, lens.weights)


def _derivative(primals: Any, tangents: Any) -> Any:
    """The mean square is least about the centroid: as the lens changes, that point may stay where it is."""
    lens, pupil = primals
    fixed = _centres(lens, pupil)
    moves, along, rebuilt = moving(lens, tangents[0])
    return jax.jvp(lambda *moved: _about(rebuilt(moved), pupil, *fixed), moves, along)


_mean_square.defjvp(_derivative, symbolic_zeros=True)


def _centres(lens: Imaged, pupil: Any) -> tuple[jax.Array, jax.Array]:
    """The centroid of each field (F, 2), and the weight of the rays of each field and wavelength that arrive
    (F, W)."""
    return _pooled_places(total(_places, lens, _pairs(lens), pupil), lens.weights)


@compiled
def _pooled_places(sums: Any, weights: jax.Array) -> tuple[jax.Array, jax.Array]:
    rays, x, y = (a.reshape(-1, len(weights)) for a in sums)
    weight = rays @ weights
    each = jnp.where(weight > 0, weight, 1)
    return jnp.stack([x @ weights / each, y @ weights / each], -1), rays


def _about(lens: Imaged, pupil: Any, centres: jax.Array, rays: jax.Array) -> jax.Array:
    fields, waves = _pairs(lens)
    squares = total(_squares, lens, (fields, waves, jnp.repeat(centres, len(lens.weights), 0)), pupil)
    return _pooled_squares(squares, rays, lens.weights)


@compiled
def _pooled_moments(sums: Any, weights: jax.Array) -> jax.Array:
    weight, x, y, squares = (a.reshape(-1, len(weights)) @ weights for a in sums)
    each = jnp.where(weight > 0, weight, jnp.nan)
    # of a perfect spot rounding is left, of either sign
    return jnp.maximum(squares / each - (x / each) ** 2 - (y / each) ** 2, 0)


@compiled
def _pooled_squares(squares: jax.Array, rays: jax.Array, weights: jax.Array) -> jax.Array:
    weight = rays @ weights
    # nan for a field without rays, but in its own figure alone and not in the derivatives of the others
    return squares.reshape(rays.shape) @ weights / jnp.where(weight > 0, weight, 1) + jnp.where(weight > 0, 0, jnp.nan)


def _pairs(lens: Imaged) -> tuple[np.ndarray, np.ndarray]:
    """The numbers of field and wavelength of every pair of them, the fields in blocks."""
    fields, waves = np.divmod(np.arange(lens.fields.shape[0] * lens.weights.shape[0]), lens.weights.shape[0])
    return fields, waves


def _places(lens: Imaged, case: tuple[jax.Array, jax.Array], pupil: Any) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Of each ray: its weight where it arrives, else 0, and that times its x and y."""
    x, y, weight = _arriving(lens, *case, pupil)
    return weight, weight * x, weight * y


def _courses(lens: Imaged, case: tuple[jax.Array, jax.Array], pupil: Any) -> tuple[jax.Array, jax.Array, jax.Array]:
    """As `_places`, of rays that have a course to the image, also where an aperture stops them."""
    image = _image(lens, *case, pupil)
    weight = jnp.where(image.has_course, pupil.weight, 0)
    return weight, weight * image.x, weight * image.y


def _moments(lens: Imaged, case: tuple[jax.Array, jax.Array, jax.Array], pupil: Any) -> tuple[jax.Array, ...]:
    """Of each ray: its weight where it arrives, else 0, and that times x, y and the square of both from a place."""
    field, wave, place = case
    x, y, weight = _arriving(lens, field, wave, pupil)
    x, y = x - place[0], y - place[1]
    return weight, weight * x, weight * y, weight * (x * x + y * y)


def _squares(lens: Imaged, case: tuple[jax.Array, jax.Array, jax.Array], pupil: Any) -> jax.Array:
    """The squared distance of each ray from the centre, times its weight."""
    field, wave, centre = case
    x, y, weight = _arriving(lens, field, wave, pupil)
    return weight * ((x - centre[0]) ** 2 + (y - centre[1]) ** 2)


def _arriving(lens: Imaged, field: jax.Array, wave: jax.Array, pupil: Any) -> tuple[jax.Array, jax.Array, jax.Array]:
    """x and y at the image, and the weight of a ray where it arrives, else 0."""
    image = _image(lens, field, wave, pupil)
    return image.x, image.y, jnp.where(image.ok, pupil.weight, 0)


def _image(lens: Imaged, field: jax.Array, wave: jax.Array, pupil: Any) -> Ray:
    light = jax.tree.map(lambda a: lax.dynamic_index_in_dim(a, wave, keepdims=False), lens.light)
    angles = lax.dynamic_index_in_dim(lens.fields, field, keepdims=False)
    launched = launch(lens.front, light, (angles[0], angles[1]), (pupil.x, pupil.y))
    return trace(lens.front.system.with_light(light), launched)
