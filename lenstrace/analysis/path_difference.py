"""How far rays miss the image point, and by how much their optical path differs from that to a perfect sphere.

With e from the image point to a ray's place on the image surface, d its direction, n' the index there, R the distance
from the sphere to the image point along the light (kappa = 1 / R, 0 for a far pupil), the path of a ray from the sphere
to the image surface exceeds that of the chief ray by n' t,

    t = d . e - kappa q / (1 + sqrt(1 - kappa^2 q)),      q = e . e - (d . e)^2,

and W = path of the chief ray - path of the ray, both up to the sphere, so that W = (path of the chief ray - path of the
ray, up to the image) + n' t: nothing large is subtracted, whatever R is. W > 0 where the wavefront is ahead of the
sphere (Welford, Aberrations of Optical Systems, 1986, section 7.2). For an afocal lens the sphere becomes the plane
across the chief ray's direction d0: t = e . d0 / d . d0.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax

from lenstrace.analysis.image_rays import ImageRays
from lenstrace.compute.pytree import pytree, static
from lenstrace.errors import RayError
from lenstrace.optics.vectors import Vector, dot, root_or_zero, safe_divide

REFERENCES = ("chief", "primary", "best")
UM_PER_MM = 1000.0
# Toward the best centre: the first alone leaves 6 % of the RMS of a lens as in phones, three 1e-3 of it.
BEST_STEPS = 3


@pytree
class Sphere:
    """With what wavefronts are compared.

    reference:  the image point is where the chief ray meets the image surface, "chief": each wavelength its own,
                "primary": the primary wavelength's for all; "best": the point (of each wavelength) for which the
                mean square of W is least.
    far:        the sphere is taken through a pupil at infinity, so that W is the phase of a plane wave (what
                diffraction needs); else through the centre of the exit pupil.
    """

    reference: str = static(default="chief")
    far: bool = static(default=False)


class Differences(NamedTuple):
    """Of N rays of F fields and W wavelengths, all (F, W, N).

    x, y:    transverse aberration, mm, in the frame of the image surface; of an afocal lens the angles that a ray makes
             with the image point's in the planes x-z and y-z, radians.
    opd:     W, in wavelengths; 0 for the chief ray ("best": of mean 0).
    l, m:    direction cosines.
    failure: see `Ray.failure`.
    """

    x: jax.Array
    y: jax.Array
    opd: jax.Array
    l: jax.Array
    m: jax.Array
    failure: jax.Array


def check_reference(reference: str) -> None:
    """RayError for an unknown word."""
    if reference not in REFERENCES:
        raise RayError(f"unknown reference {reference!r}; one of {', '.join(REFERENCES)}")


def differences(arrived: ImageRays, sphere: Sphere, weights: Any = 1.0) -> Differences:
    """Transverse aberrations and path differences of rays; weights (N,): of the rays, for the best sphere."""
    rays = jax.tree.map(lambda a: jnp.swapaxes(a, 0, 1), arrived.rays)
    chief, others = (jax.tree.map(lambda a, part=part: a[..., part], rays) for part in (slice(0, 1), slice(1, None)))
    assert chief.opl is not None
    assert others.opl is not None
    origin = jax.tree.map(lambda a: a[:, arrived.primary, None], chief) if sphere.reference == "primary" else chief
    index = jnp.asarray(arrived.index)[:, None]

    def path(ray: Any, centre: Vector, kappa: Any) -> jax.Array:
        """n' t, mm."""
        apart = ray.x - centre[0], ray.y - centre[1], ray.z - centre[2]
        direction, across = (ray.l, ray.m, ray.n), (origin.l, origin.m, origin.n)
        along = dot(apart, direction)
        q = kappa * (dot(apart, apart) - along * along)
        to_sphere = along - q / (1 + root_or_zero(1 - kappa * q))
        return index * jnp.where(arrived.afocal, safe_divide(dot(apart, across), dot(direction, across)), to_sphere)

    def about(centre: Vector) -> jax.Array:
        """W, mm."""
        kappa = 0.0 if sphere.far else _curvature(arrived, centre)
        return chief.opl - others.opl + path(others, centre, kappa) - path(chief, centre, kappa)

    centre = origin.x, origin.y, origin.z
    opd = about(centre)
    if sphere.reference == "best":
        share = jnp.where(others.failure == 0, weights, 0.0)

        def nearer(_: int, centre: Vector) -> Vector:
            """A step of Gauss and Newton: a centre shifted by s adds n' d . s to -W, to first order in s / R."""
            shift = _factors(about(centre), (others.l, others.m, others.n), share)
            x, y, z = (c + s / index for c, s in zip(centre, shift, strict=True))
            return x, y, z

        # of a plane there is no centre: tilt and bending, x, y and x^2 + y^2, are taken away
        plane = residual(opd, (others.x, others.y, others.x**2 + others.y**2), share)
        point = lax.fori_loop(0, BEST_STEPS, nearer, tuple(jnp.broadcast_to(c, chief.x.shape) for c in centre))
        opd = jnp.where(arrived.afocal, plane, residual(about(point), (), share))

    def angle(across: jax.Array, along: jax.Array) -> jax.Array:
        return jnp.arctan2(arrived.sense * across, arrived.sense * along)

    return Differences(
        jnp.where(arrived.afocal, angle(others.l, others.n) - angle(origin.l, origin.n), others.x - origin.x),
        jnp.where(arrived.afocal, angle(others.m, others.n) - angle(origin.m, origin.n), others.y - origin.y),
        opd * (UM_PER_MM / jnp.asarray(arrived.um)[:, None]),
        others.l,
        others.m,
        others.failure,
    )


def _curvature(arrived: ImageRays, centre: Vector) -> jax.Array:
    """1 / R, from the centre of the exit pupil to the image point, > 0 where the light comes from there.
    0 for a pupil at the image itself, where no sphere can be."""
    pupil = jnp.asarray(arrived.pupil_z)
    near = jnp.isfinite(pupil)
    x, y, z = centre
    behind = jnp.where(near, z - jnp.where(near, pupil, 0.0), 0.0)
    distance = jnp.sqrt(jnp.where(behind == 0, 1.0, x * x + y * y + behind * behind))
    return jnp.where(behind == 0, 0.0, jnp.sign(behind) * arrived.sense / distance)


def _factors(values: jax.Array, terms: tuple[jax.Array, ...], weights: jax.Array) -> list[jax.Array]:
    """Of the weighted least squares fit of values (..., N) by a constant and some terms (..., N): how much of each term
    it holds, (..., 1); 0 of a term that is constant."""
    weights = weights.astype(values.dtype)
    total = jnp.sum(weights, -1, keepdims=True)
    share = weights / jnp.where(total > 0, total, 1)

    def about_mean(a: jax.Array) -> jax.Array:
        return a - jnp.sum(share * a, -1, keepdims=True)

    centred = jnp.stack([about_mean(term) for term in terms], -2)
    size = jnp.sqrt(jnp.sum(share[..., None, :] * centred**2, -1, keepdims=True))
    size = jnp.where(size > 0, size, 1)
    unit = centred / size
    weighted = unit * share[..., None, :]
    least = jnp.finfo(values.dtype).eps * jnp.eye(len(terms), dtype=values.dtype)
    matrix = jnp.einsum("...in,...jn->...ij", weighted, unit, precision="highest") + least
    held = jnp.einsum("...in,...n->...i", weighted, about_mean(values), precision="highest")[..., None]
    factors = jnp.linalg.solve(matrix, held) / size
    return [factors[..., i, :] for i in range(len(terms))]


def residual(values: jax.Array, terms: tuple[jax.Array, ...], weights: jax.Array) -> jax.Array:
    """What is left of values (..., N) after the weighted least squares fit by a constant and some terms (..., N).

    Rays of weight 0 do not count. A term that is constant, or that others make up, is left out.
    """
    weights = jnp.broadcast_to(weights, values.shape).astype(values.dtype)
    total = jnp.sum(weights, -1, keepdims=True)
    share = weights / jnp.where(total > 0, total, 1)

    def mean(a: jax.Array) -> jax.Array:
        return jnp.sum(share * a, -1, keepdims=True)

    left = values - mean(values)
    basis: list[jax.Array] = []
    for term in terms:
        # Gram and Schmidt, each against what is orthogonal already
        size = mean((term - mean(term)) ** 2)
        part = term - mean(term)
        for other in basis:
            part = part - mean(part * other) * other
        square = mean(part * part)
        new = square > 1e3 * jnp.finfo(values.dtype).eps ** 2 * size
        unit = jnp.where(new, part / jnp.sqrt(jnp.where(new, square, 1.0)), 0.0)
        basis.append(unit)
        left = left - mean(left * unit) * unit
    return left
