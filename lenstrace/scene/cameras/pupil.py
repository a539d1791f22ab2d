"""Finding the pupil by tracing: a bound that cuts nothing off, and how much light comes through it.

Boxes in (s, t), see `pupil_bound.py`, are fitted to what passes a grid of rays, from a number of film points; between
the nodes of the table they are widened until they hold all that was found, and a little on every side. The light of all
wavelengths is meant. A lens without rims has glass without an edge: on strange ways, far outside its pupil and its
field, light may come through that the grids do not see; it counts only where the bound holds it.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import pytree, static
from lenstrace.optics.rays import living
from lenstrace.scene.cameras.pupil_bound import PupilBound
from lenstrace.scene.cameras.pupil_edges import moving
from lenstrace.sequential import paraxial
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace

NODES = 17  # of the table
FINE = 2  # film points searched for each step of the table
FIRST_HALF = 2.0  # of the box that is searched first, stop radii
GRID = 48  # points across the box
GROWING, ROUNDS = 2, 5  # rounds in which a box may still grow, and in which it is fitted to what passes
SIDE_POINTS = 5  # film points across, for a lens that is not one of revolution
AXIS_GRIDS = 4  # such grids across the pupil of the axial film point, for its irradiance
MARGIN = 0.01  # of the half width of a box: a pointed pupil may reach farther than the rays of a grid see
ROUNDNESS = (1.0, 1.42)  # of its inscribed ellipse, up to the corners of the box
SIGNS = (-1, 1, -1, 1)  # of the sides of a box: low s, high s, low t, high t
BATCH = 11, 5  # film points traced at once, of the table and of the others; they divide their number


@pytree
class PupilSearch:
    """What is searched. system: the reversed lens, its object the film; index: (W, S + 1), the first the primary's;
    radius: of the stop, mm; widest: the largest film radius, mm; moving: derivatives are wanted."""

    system: System
    index: jax.Array
    radius: jax.Array
    widest: jax.Array
    turned: bool = static()
    ellipse: bool = static()
    moving: bool = static()


@pytree
class PupilFound:
    """chief (1/mm), marginal: see above. bound: of what passes. irradiance: on the axial film point from a unit of
    radiance, without losses. reach: how far from the axis light passes there, stop radii."""

    chief: jax.Array
    marginal: jax.Array
    bound: PupilBound
    irradiance: jax.Array
    reach: jax.Array


@compiled
def search(asked: PupilSearch) -> PupilFound:
    """Find the bound. What passes at any of the wavelengths lies inside it, as far as the grids see, and each box is
    wider by one step of its grid on every side."""
    chief, marginal = _paraxial(asked)
    fixed = jax.tree.map(lax.stop_gradient, asked)
    slopes = lax.stop_gradient((chief, marginal))
    bound = (_round_bound if asked.turned else _common_bound)(fixed, slopes)
    if asked.moving:
        bound = moving(asked.system, chief, marginal, bound)
    irradiance, reach = _on_axis(asked, (chief, marginal), bound)
    return PupilFound(chief, marginal, bound, irradiance, reach)


def _paraxial(asked: PupilSearch) -> tuple[jax.Array, jax.Array]:
    system = asked.system
    assert system.object_distance is not None
    m = paraxial.matrix(system, 1, system.stop, bend_last=False)
    b = m.a * system.object_distance + m.b * system.index[0]
    return -m.a / b, asked.radius / b


@jax.jit
def _passes(asked: PupilSearch, film: tuple[jax.Array, jax.Array], x: jax.Array, y: jax.Array) -> jax.Array:
    """(W, ...), whether rays of each wavelength that leave a film point with slopes x and y arrive. Traced once."""
    n = _cosine(x, y)
    distance = jnp.asarray(asked.system.object_distance)
    rays = living(film[0], film[1], -distance, x * n, y * n, n)

    def at(index: jax.Array) -> jax.Array:
        return trace(asked.system.replace(index=index), rays, last=asked.system.surfaces).ok

    return jax.vmap(at)(asked.index)


def _cosine(x: jax.Array, y: jax.Array) -> jax.Array:
    return 1 / jnp.sqrt(1 + x * x + y * y)


def _any_passes(
    asked: PupilSearch,
    slopes: tuple[jax.Array, jax.Array],
    film: tuple[jax.Array, jax.Array],
    s: jax.Array,
    t: jax.Array,
) -> jax.Array:
    """Whether light of any wavelength comes from (s, t)."""
    chief, marginal = slopes
    return jnp.any(_passes(asked, film, chief * film[0] + marginal * s, chief * film[1] + marginal * t), 0)


def _shape(asked: PupilSearch) -> tuple[int, int]:
    """Points of a grid in s and t; in t half as many where one half of the pupil is as the other."""
    return GRID, GRID // 2 if asked.turned else GRID


def _grid(asked: PupilSearch, box: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Points of a box (low s, high s, low t, high t), its edges among them, and their steps, (4,)."""
    ends, steps, shape = [], [], _shape(asked)
    for i, count in zip((0, 2), shape, strict=True):
        share = jnp.asarray(np.linspace(0, 1, count), box.dtype)
        ends.append(box[i] + (box[i + 1] - box[i]) * share)
        steps += [(box[i + 1] - box[i]) / (count - 1)] * 2
    return jnp.broadcast_to(ends[0][:, None], shape), jnp.broadcast_to(ends[1], shape), jnp.stack(steps)


def _boxes(
    asked: PupilSearch, slopes: tuple[jax.Array, jax.Array], x: jax.Array, y: jax.Array
) -> tuple[jax.Array, jax.Array]:
    """(P, 4), the box of each film point, and whether anything passes."""
    signs = jnp.asarray(SIGNS, asked.radius.dtype)

    def fitted(film: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        def step(i: jax.Array, state: tuple[jax.Array, jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array, jax.Array]:
            box, before, found = state
            # at first all of the box; then, side by side, the strip of the last step, where the edge must be
            side = i - ROUNDS
            region = jnp.where(jnp.arange(4) == (side ^ 1), (box - signs * before)[side], box)
            region = jnp.where(side < 0, box, region)
            if asked.turned:
                region = region.at[2].set(jnp.where(side == 3, region[2], 0))
            s, t, steps = _grid(asked, region)
            passing = _any_passes(asked, slopes, film, s, t)
            ends = jnp.stack(
                [
                    end(jnp.where(passing, a, other))
                    for a in (s, t)
                    for end, other in ((jnp.min, jnp.inf), (jnp.max, -jnp.inf))
                ]
            )
            if asked.turned:
                ends = ends.at[2].set(-ends[3])
            here, may_grow = jnp.any(passing), i < GROWING
            at_edge = signs * (box - ends) < steps / 2
            # a box that is too small grows by half on that side
            grown = jnp.where(may_grow, box + signs * jnp.repeat(box[1::2] - box[::2], 2) / 2, box)
            fit = jnp.where(at_edge & may_grow, grown, ends + signs * steps)
            whole = jnp.where(here, fit, grown)
            of_side = jnp.arange(4) == side
            if asked.turned:
                # low t goes with high t
                of_side = (of_side | (jnp.arange(4) == 2) & (side == 3)) & (side != 2)
            narrowed = jnp.where(of_side & here, ends + signs * steps, box)
            first = side < 0
            return (
                jnp.where(first, whole, narrowed),
                jnp.where(first, steps, before),
                jnp.where(first, here, found),
            )

        begin = (FIRST_HALF * signs, jnp.zeros_like(signs), jnp.asarray(False))
        box, _, found = lax.fori_loop(0, ROUNDS + 4, step, begin)
        return box + signs * MARGIN * jnp.repeat(box[1::2] - box[::2], 2) / 2, found

    return lax.map(fitted, (x, y), batch_size=BATCH[0] if asked.turned else BATCH[1])


def _roundness(
    asked: PupilSearch, slopes: tuple[jax.Array, jax.Array], film: tuple[jax.Array, jax.Array], box: jax.Array
) -> jax.Array:
    """(P,), by how much the ellipse in the box must be scaled to hold what passes."""
    radii, angles = _shape(asked)
    radius = jnp.asarray(np.linspace(*ROUNDNESS, radii), asked.radius.dtype)[:, None]
    angle = np.linspace(0, np.pi, angles) if asked.turned else np.arange(angles) * 2 * np.pi / angles
    across, along = (jnp.asarray(f(angle), radius.dtype) for f in (np.cos, np.sin))

    def at(each: tuple[tuple[jax.Array, jax.Array], jax.Array]) -> jax.Array:
        film, box = each
        s = (box[0] + box[1]) / 2 + (box[1] - box[0]) / 2 * radius * across
        t = (box[2] + box[3]) / 2 + (box[3] - box[2]) / 2 * radius * along
        passing = _any_passes(asked, slopes, film, s, t)
        step = (ROUNDNESS[1] - ROUNDNESS[0]) / (radii - 1)
        return jnp.max(jnp.where(passing, radius + step, 1))

    return lax.map(at, (film, box), batch_size=BATCH[0] if asked.turned else BATCH[1])


def _round_bound(asked: PupilSearch, slopes: tuple[jax.Array, jax.Array]) -> PupilBound:
    """The table over the film's radius."""
    dtype = asked.radius.dtype
    count = (NODES - 1) * FINE + 1
    radii = asked.widest * jnp.asarray(np.linspace(0, 1, count), dtype)
    boxes, found = _boxes(asked, slopes, radii, jnp.zeros_like(radii))
    # where nothing passes the last box that something passes stands for it: blocked rays count nothing
    last = lax.cummax(jnp.where(found, jnp.arange(count), 0))
    boxes = boxes[last]
    signs = jnp.asarray(SIGNS, dtype)
    nodes = boxes[::FINE]
    excess = jnp.where(found[:, None], signs * (boxes - _between(nodes)), 0)
    nodes = nodes + signs * _worst(excess)
    whole = _between(nodes)
    scale = jnp.ones((NODES, 1), dtype)
    if asked.ellipse:
        scale = _worst(_roundness(asked, slopes, (radii, jnp.zeros_like(radii)), whole)[:, None])
    return _bound(asked, nodes, scale[:, 0], asked.widest / (NODES - 1))


def _common_bound(asked: PupilSearch, slopes: tuple[jax.Array, jax.Array]) -> PupilBound:
    """One for all points of the film."""
    dtype = asked.radius.dtype
    side = np.linspace(-1, 1, SIDE_POINTS)
    x, y = (asked.widest * jnp.asarray(a.ravel(), dtype) for a in np.meshgrid(side, side))
    boxes, found = _boxes(asked, slopes, x, y)
    low = jnp.min(jnp.where(found[:, None], boxes, jnp.inf), 0)
    high = jnp.max(jnp.where(found[:, None], boxes, -jnp.inf), 0)
    box = jnp.where(jnp.asarray([True, False, True, False]), low, high)
    box = jnp.where(jnp.any(found), box, 0)
    scale = jnp.ones((), dtype)
    if asked.ellipse:
        scale = jnp.max(_roundness(asked, slopes, (x, y), jnp.broadcast_to(box, boxes.shape)))
    both = jnp.stack([box, box])
    return _bound(asked, both, jnp.broadcast_to(scale, (2,)), asked.widest)


def _bound(asked: PupilSearch, boxes: jax.Array, scale: jax.Array, step: jax.Array) -> PupilBound:
    centre_s, centre_t = (boxes[:, 0] + boxes[:, 1]) / 2, (boxes[:, 2] + boxes[:, 3]) / 2
    half_s, half_t = (boxes[:, 1] - boxes[:, 0]) / 2 * scale, (boxes[:, 3] - boxes[:, 2]) / 2 * scale
    return PupilBound(step, centre_s, centre_t, half_s, half_t, asked.turned, asked.ellipse)


def _between(nodes: jax.Array) -> jax.Array:
    """Values at the fine places, linear between the nodes."""
    share = jnp.asarray(np.arange(FINE) / FINE, nodes.dtype)[:, None]
    inner = nodes[:-1, None] + share * (nodes[1:] - nodes[:-1])[:, None]
    return jnp.concatenate([inner.reshape(-1, nodes.shape[1]), nodes[-1:]])


def _worst(fine: jax.Array) -> jax.Array:
    """For each node the largest value at the fine places up to its neighbours."""
    parts = jnp.stack([fine[i : i + fine.shape[0] - FINE : FINE] for i in range(FINE + 1)])
    largest = jnp.max(parts, 0)
    return jnp.maximum(jnp.concatenate([largest[:1], largest]), jnp.concatenate([largest, largest[-1:]]))


def _on_axis(asked: PupilSearch, slopes: tuple[jax.Array, jax.Array], bound: PupilBound) -> tuple[jax.Array, jax.Array]:
    """Irradiance at the axial film point: the integral of cos^4 over the slopes that pass; and how far they reach."""
    fixed, zero = jax.tree.map(lax.stop_gradient, asked), jnp.zeros((), asked.radius.dtype)
    count = GRID * AXIS_GRIDS
    share = jnp.asarray((np.arange(count) + 0.5) / count * 2 - 1, asked.radius.dtype)
    s = jnp.broadcast_to((bound.centre_s[0] + bound.half_s[0] * share)[:, None], (count, count))
    t = jnp.broadcast_to(bound.centre_t[0] + bound.half_t[0] * share, (count, count))
    x, y = slopes[1] * s, slopes[1] * t
    shape = (-1, GRID, GRID // 2 if asked.turned else GRID)  # that of the other grids: one program
    grids = [lax.stop_gradient(a).reshape(shape) for a in (x, y)]
    passing = lax.map(lambda grid: _passes(fixed, (zero, zero), *grid)[0], tuple(grids)).reshape(x.shape)
    cell = 4 * bound.half_s[0] * bound.half_t[0] / count**2
    irradiance = jnp.sum(jnp.where(passing, _cosine(x, y) ** 4, 0)) * cell * slopes[1] ** 2
    return irradiance, jnp.sqrt(jnp.max(jnp.where(passing, s * s + t * t, 0)))
