"""The pupil function: amplitude and phase of the light over directions at the image, on a grid for transforms.

Light from the exit pupil is a sum of plane waves. With t = n' (l, m) the direction cosines of a ray times the index
there, counted from the chief ray's, and W its path difference from a sphere about the image point seen from a far
pupil, the field near the image point is

    U(x, y) = integral P(t) exp(-2 pi i W / lambda) exp(2 pi i t . (x, y) / lambda) dt,     P = sqrt(dE / dt),

exact for scalar light up to an obliquity factor. Rays are sent to the nodes of a grid in t, so that W needs no
interpolation and distortion of the pupil no approximation; all wavelengths share one grid of image points.

Source: Goodman, Introduction to Fourier Optics (2005), chapter 6; Welford (1986), section 7.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis import pupil_map
from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.image_rays import ImageRays, image_rays
from lenstrace.analysis.path_difference import Sphere, differences
from lenstrace.analysis.pupil_grid import cell_coverage, check_samples
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import RayError
from lenstrace.optics.apertures import ApertureKind
from lenstrace.optics.rays import has_course
from lenstrace.sequential.lens import Lens

UM_PER_MM = 1000.0
SAMPLES, MOST_SAMPLES = 64, 512
# Cells of the grid left free at the edges of the pupil.
MARGIN = 2
SPHERE = Sphere("primary", far=True)
# Wavelengths from cell to cell: beyond, a transform takes light for other light.
MOST_STEP = 0.5
# Points of a cell, along each side, that find how much of it apertures leave.
FINE = 4


@pytree
class PupilFunction:
    """Of F fields and W wavelengths, n x n points of direction; rows run along y.

    amplitude:  (F, W, n, n), root of the light per cell, 1 at the centre of the pupil; of cells at its edge the mean.
    opd:        (F, W, n, n), wavelengths, from the sphere about the image point of the primary chief ray; 0 without
                light.
    energy:     (F, W), the light through the pupil: what the sum of amplitude^2 tends to as the cells shrink.
    refocus:    (F, W, n, n), what a shift of the image plane by 1 mm along z takes from the opd, wavelengths.
    cell:       (F, W, 2, 2), the edges of a cell in units of the pupil's radius: x and y of the edge toward +x in the
                image, then of that toward +y. The linear part of the map, to the scale that gives the pupil its area.
    pixel:      (), mm, the distance of image points of a transform of 2 n points.
    distorted:  (F, W), by how much the direction of a ray misses its node at most, in units of the half width.
    step:       (F, W), the largest change of opd from one cell to the next, wavelengths: transforms need 1/2 at most.
    um, weights: (W,), the wavelengths, micrometres, and their weights.
    """

    amplitude: jax.Array
    opd: jax.Array
    energy: jax.Array
    refocus: jax.Array
    cell: jax.Array
    pixel: jax.Array
    distorted: jax.Array
    step: jax.Array
    um: jax.Array
    weights: jax.Array


@pytree
class _Nodes:
    """Where the rays are sent. pupil_x, pupil_y: (W, F, n n); the rest (F, W, n, n), but cell and pixel."""

    pupil_x: jax.Array
    pupil_y: jax.Array
    covered: jax.Array
    density: jax.Array
    edges: jax.Array
    target: jax.Array
    half_width: jax.Array
    cell: jax.Array
    pixel: jax.Array


def pupil_function(lens: Lens, question: str, samples: int | None = None, step: float = MOST_STEP) -> PupilFunction:
    """The pupil function of every field and wavelength of a lens.

    samples: n, even; by default 64, or as many (up to 512) as keep the opd from changing by more than `step`
    wavelengths from one cell to the next. ImageError where the image is at infinity (`question` begins the message).
    """
    with_image(lens, question)
    x, y, _ = pupil_map.sampled()
    coarse = image_rays(lens, x, y)
    if samples is None:
        samples = SAMPLES if is_traced(coarse) else _enough(float(np.asarray(_steepest(coarse))), step)
    check_samples(samples)
    if samples % 2:
        raise RayError(f"samples across the pupil must be an even number for a transform, got {samples}")
    nodes = _nodes(coarse, np.arange(samples) - samples // 2)
    arrived = image_rays(lens, nodes.pupil_x, nodes.pupil_y)
    stopped = any(kind.aperture is not ApertureKind.NONE for kind in lens.system.kinds)
    share = _share(lens, nodes) if stopped else 1.0
    return _function(arrived, nodes, share)


@compiled
def _steepest(coarse: ImageRays) -> jax.Array:
    """The largest change of opd across the pupil's radius, wavelengths: that of a ray is its transverse aberration
    times the half width, over the wavelength."""
    found = differences(coarse, SPHERE)
    miss = jnp.where(found.failure == 0, jnp.maximum(jnp.abs(found.x), jnp.abs(found.y)), 0)
    um = jnp.asarray(coarse.um)
    return jnp.max(jnp.max(miss, -1) * pupil_map.pupil_map(coarse).half_width * UM_PER_MM / um)


def _enough(steepest: float, step: float) -> int:
    """The power of two, 64 to 512, with steps as small as asked for."""
    samples = SAMPLES
    while samples < MOST_SAMPLES and samples - MARGIN < 2 * steepest / step:
        samples *= 2
    return samples


@compiled
def _nodes(coarse: ImageRays, steps: jax.Array | np.ndarray) -> _Nodes:
    """The nodes of the grid; steps: -n/2 ... n/2 - 1."""
    n = len(steps)
    found = pupil_map.pupil_map(coarse)
    mm = jnp.asarray(coarse.um) / UM_PER_MM
    # a cell is lambda / (2 n pixel) wide: the widest pupil takes n - MARGIN of them
    pixel = (n - MARGIN) / (4 * n) * jnp.min(mm / found.half_width)
    width = mm / (2 * n * pixel)

    def of_one(coefficients: jax.Array, width: jax.Array) -> tuple[jax.Array, ...]:
        points, edges, known = pupil_map.pupil_on_grid(coefficients, width, n)
        x, y = points
        covered = cell_coverage(x, y, (edges[0, 0], edges[1, 0]), (edges[0, 1], edges[1, 1]))
        density = jnp.abs(edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0])
        linear = jnp.linalg.inv(jnp.array(pupil_map.linear_part(coefficients))) * width
        # where there is no pupil the rays go through its centre: they must go somewhere
        covered = jnp.where(known, covered, 0)
        x, y = (jnp.where(known, a, 0) for a in (x, y))
        flat = [a.reshape(*a.shape[:-2], -1) for a in (x, y, covered, density / density[n // 2, n // 2], edges)]
        return *flat, linear.T

    fields = found.half_width.shape[0]
    widths = jnp.broadcast_to(width, found.half_width.shape)
    x, y, covered, density, edges, cell = jax.vmap(jax.vmap(of_one))(found.coefficients, widths)
    up, right = (a.reshape(-1).astype(mm.dtype) for a in jnp.meshgrid(steps, steps, indexing="ij"))
    target = jnp.stack([right, up]) * width[:, None, None]
    return _Nodes(
        pupil_x=jnp.swapaxes(x, 0, 1),
        pupil_y=jnp.swapaxes(y, 0, 1),
        covered=covered,
        density=density,
        edges=edges,
        target=jnp.broadcast_to(target, (fields, *target.shape)),
        half_width=found.half_width,
        cell=cell,
        pixel=pixel,
    )


def _share(lens: Lens, nodes: _Nodes) -> jax.Array:
    """The part of each cell whose rays arrive, (F, W, n n): of FINE x FINE of them."""
    inside = (np.arange(FINE) + 0.5) / FINE - 0.5
    a, b = (jnp.asarray(p.ravel(), nodes.pupil_x.dtype) for p in np.meshgrid(inside, inside))
    points = []
    for axis, centre in enumerate((nodes.pupil_x, nodes.pupil_y)):
        edges = jnp.swapaxes(nodes.edges[:, :, axis], 0, 1)  # (W, F, 2, n n)
        fine = centre[..., None] + edges[:, :, 0, :, None] * a + edges[:, :, 1, :, None] * b
        points.append(fine.reshape(*centre.shape[:2], -1))
    arrives = image_rays(lens, *points).rays.failure[..., 1:] == 0
    share = jnp.mean(arrives.reshape(*nodes.pupil_x.shape, -1), -1, dtype=nodes.pupil_x.dtype)
    return jnp.swapaxes(share, 0, 1)


@compiled
def _function(arrived: ImageRays, nodes: _Nodes, share: jax.Array | float) -> PupilFunction:
    found = differences(arrived, SPHERE)
    fields, waves, count = found.opd.shape
    n = round(count**0.5)
    light = nodes.covered * share * jnp.where(has_course(found.failure), 1, 0)
    lit = light > 0
    rays = jax.tree.map(lambda a: jnp.swapaxes(a, 0, 1), arrived.rays)
    index, um = jnp.asarray(arrived.index)[:, None], jnp.asarray(arrived.um)
    directions = [index * (a[..., 1:] - a[..., :1]) for a in (rays.l, rays.m, rays.n)]
    missed = jnp.maximum(*(jnp.abs(d - nodes.target[:, :, i]) for i, d in enumerate(directions[:2])))

    def square(a: jax.Array) -> jax.Array:
        return jnp.where(lit, a, 0).reshape(fields, waves, n, n)

    opd, there = square(found.opd), lit.reshape(fields, waves, n, n)

    def steepest(axis: int) -> jax.Array:
        both = jnp.take(there, np.arange(1, n), axis) & jnp.take(there, np.arange(n - 1), axis)
        return jnp.max(jnp.where(both, jnp.abs(jnp.diff(opd, axis=axis)), 0), (-2, -1))

    return PupilFunction(
        amplitude=square(light * jnp.sqrt(nodes.density)),
        opd=opd,
        energy=jnp.sum(jnp.where(lit, light * nodes.density, 0), -1),
        refocus=square(directions[2] * (UM_PER_MM / um)[:, None]),
        cell=nodes.cell * jnp.sqrt(jnp.pi / (jnp.sum(nodes.covered, -1) * _size(nodes.cell)))[..., None, None],
        pixel=nodes.pixel,
        distorted=jnp.max(jnp.where(lit, missed, 0), -1) / nodes.half_width,
        step=jnp.maximum(steepest(-1), steepest(-2)),
        um=um,
        weights=jnp.asarray(arrived.weights),
    )


def _size(matrix: jax.Array) -> jax.Array:
    return jnp.abs(matrix[..., 0, 0] * matrix[..., 1, 1] - matrix[..., 0, 1] * matrix[..., 1, 0])
