"""Real rays infinitely near the axis: the trace of the ray on the axis, differentiated by where it starts."""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike

from lenstrace.analysis.rays import trace
from lenstrace.optics.rays import Ray, living
from lenstrace.sequential.lens import Lens


class Neighbours(NamedTuple):
    """Heights and slopes dy/dz of N rays, (S + 2, N): on the first vertex plane, behind surfaces 1 ... S, and on the
    image surface; all in one unit as small as one likes. path: the rays that they are neighbours of."""

    path: Ray
    y: jax.Array
    slope: jax.Array


class Cardinal(NamedTuple):
    """Focal length, and the cardinal points as rays near the axis show them, mm: z from the first vertex.

    focal_length:     f' = -y / u' of the ray that comes in parallel to the axis.
    rear_focus, rear_principal:    where that ray crosses the axis, and where it has the height at which it came in.
    front_focus, front_principal:  the same of the ray that goes out parallel.
    front_node, rear_node:         where the ray that goes out as it came in crosses the axis before and behind.
    """

    focal_length: float
    rear_focus: float
    rear_principal: float
    front_focus: float
    front_principal: float
    front_node: float
    rear_node: float


def neighbours(lens: Lens, heights: jax.Array, slopes: jax.Array, around: ArrayLike = 0.0) -> Neighbours:
    """Rays through a centred lens; heights, slopes: (N,), on the first vertex plane.

    around: mm, the height of the ray parallel to the axis that each is infinitely near to; the axis by default.
    """

    def through(y: jax.Array, slope: jax.Array) -> tuple[tuple[jax.Array, jax.Array], Ray]:
        zero, cosine = jnp.zeros_like(y), 1 / jnp.sqrt(1 + slope * slope)
        path = trace(lens, rays=living(zero, y, zero, zero, slope * cosine, cosine))
        return (path.y, path.m / path.n), path

    from_axis = jnp.broadcast_to(jnp.asarray(around, heights.dtype), heights.shape)
    _, changes, path = jax.jvp(through, (from_axis, 0 * heights), (heights, slopes), has_aux=True)
    return Neighbours(path, *changes)


def cardinal(parallel: np.ndarray, oblique: np.ndarray, image: float) -> Cardinal:
    """The points that two rays give, since all rays near the axis are their sums.

    parallel:  height and slope on the image surface of the ray that comes in parallel to the axis at the height 1.
    oblique:   of the ray through the first vertex with the slope 1.
    image:     z of the image surface, mm.

    The ray of height h and slope s goes out as h (a, c) + s (b, d): parallel with h / s = -d / c, undeviated with
    h / s = (1 - d) / c.
    """
    (a, c), (b, d) = parallel, oblique
    # a d - b c: the height at which the ray from F goes out, against that of the focal length
    turned = a * d - b * c
    return Cardinal(
        focal_length=-1 / c,
        rear_focus=image - a / c,
        rear_principal=image + (1 - a) / c,
        front_focus=d / c,
        front_principal=(d - turned) / c,
        front_node=(d - 1) / c,
        rear_node=image + (turned - a) / c,
    )
