"""Two rules of quadrature over the pupil of a lens, whose difference tells how accurate their mean is.

The first is Gauss's on 4 r spokes (the gaussian pattern of `pupil_points`), the second Lobatto's, rim and centre
included, on the spokes half-way between. Radially Lobatto's error is -(1 + 1/r) times Gauss's to leading order, and a
trapezoidal sum half a step further along the circle has the opposite error too: of a smooth function the two rules lie
on either side of the integral. Where apertures cut the pupil, or rays fail, each spoke is integrated over its open
parts.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.analysis.pupil_edges import arrival, edges_between
from lenstrace.compute.blocks import each
from lenstrace.sequential.launch import Front
from lenstrace.sequential.sampling import ON_AXIS, SPOKES, radial_rule, rim_rule, spoke_turns
from lenstrace.sequential.system import Light

# Steps along a spoke in which an edge of an opening is looked for: what is narrower may be overlooked.
TRIED = 256
# Spokes whose edges are looked for by one call.
AT_ONCE = 64
# Of the radius: how far inside an opening its outermost rays stay, so that rounding does not lose them.
INSIDE = 1e-12


class RulePair(NamedTuple):
    """N points of the pupil, and their weights in the two rules, each (N,) or (W, F, N). The weights of a rule add up
    to the part of the pupil that is open."""

    x: np.ndarray
    y: np.ndarray
    first: np.ndarray
    second: np.ndarray


def whole_pupil(rings: int) -> RulePair:
    """The pair with r rings over the whole disk: 8 r^2 + 1 points."""
    (gauss, share), (lobatto, rim_share) = radial_rule(rings), rim_rule(rings)
    turns = spoke_turns(SPOKES * rings)
    between = turns + 0.5 / len(turns)
    x, y = (
        np.concatenate([np.outer(gauss, f(turns)).ravel(), [0.0], np.outer(lobatto[1:], f(between)).ravel()])
        for f in (_cos, _sin)
    )
    first, second = (np.repeat(s / len(turns), len(turns)) for s in (share, rim_share[1:]))
    nothing = np.zeros(len(first)), np.zeros(len(second) + 1)
    return RulePair(x, y, np.append(first, nothing[1]), np.concatenate([nothing[0], [rim_share[0]], second]))


def right_half(pair: RulePair) -> RulePair:
    """The points with x >= 0: all that is to be traced of a lens that is its own mirror image, for a field in y.
    Together with their images at -x they weigh what the pair does."""
    kept = pair.x > -ON_AXIS
    share = np.where(pair.x > ON_AXIS, 1.0, 0.5)
    return RulePair(pair.x[kept], pair.y[kept], (share * pair.first)[kept], (share * pair.second)[kept])


def open_pupil(front: Front, light: Light, fields: Any, rings: int) -> RulePair:
    """The pair over what is open of the pupil of each wavelength and field, (W, F, N).

    light: of each wavelength.      fields: (F, 2), as `System.fields`.
    """
    turns = spoke_turns(SPOKES * rings)
    both = np.concatenate([turns, turns + 0.5 / len(turns)])
    found = [_edges_along(front, light, fields, some) for some in np.split(both, range(AT_ONCE, len(both), AT_ONCE))]
    alive, edges = (np.concatenate(some, 2) for some in zip(*found, strict=True))
    parts = _parts(alive, edges)
    halves = []
    for (radius, share), angle, part in zip(
        (radial_rule(rings), rim_rule(rings)), np.split(both, 2), np.split(parts, 2, axis=2), strict=True
    ):
        # nodes in the square of the radius, from the inner to the outer edge of each part
        inner, outer = part[..., :1] ** 2, part[..., 1:] ** 2
        r = np.sqrt(inner + (outer - inner) * radius**2)
        weight = (outer - inner) * share / len(angle)
        spoke = angle[:, None, None]
        halves.append([a.reshape(*parts.shape[:2], -1) for a in (r * _cos(spoke), r * _sin(spoke), weight)])
    (x, y, first), (more_x, more_y, second) = halves
    x, y = np.concatenate([x, more_x], -1), np.concatenate([y, more_y], -1)
    first, second = np.concatenate([first, 0 * second], -1), np.concatenate([0 * first, second], -1)
    # the points of empty parts weigh nothing; they are put where the pupil is open, so that no ray of theirs is lost
    open_place = (first + second).argmax(-1)[..., None]
    x, y = (np.where(first + second > 0, a, np.take_along_axis(a, open_place, -1)) for a in (x, y))
    return RulePair(x, y, first, second)


def _edges_along(front: Front, light: Light, fields: Any, turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Along M spokes, at most AT_ONCE: whether the rays at k / TRIED of the radius arrive, (W, F, M, TRIED + 1), and
    where within each step that changes, on the side where they arrive, (W, F, M, TRIED)."""
    dtype = front.system.curvature.dtype
    shape = len(fields), AT_ONCE
    spokes = np.resize(turns, AT_ONCE)  # always as many, so that one program does for all
    lines = (*(np.asarray(fields)[:, i : i + 1] for i in (0, 1)), _cos(spokes), _sin(spokes))
    alive, edges = each(_edges, (front, light), tuple(np.broadcast_to(a, shape).astype(dtype) for a in lines))
    alive, edges = (np.moveaxis(np.asarray(a), 0, -1)[..., : len(turns), :] for a in (alive, edges))
    return alive, edges


def _edges(asked: tuple[Front, Light], lines: tuple[jax.Array, ...]) -> tuple[jax.Array, jax.Array]:
    """(TRIED + 1, W, N) and (TRIED, W, N) of `_edges_along`; lines: field x and y, cosine and sine, (N,)."""
    front, lights = asked
    field_x, field_y, cosine, sine = lines

    def of_wave(light: Light) -> tuple[jax.Array, jax.Array]:
        arrives = arrival(front, light, (field_x, field_y), (0 * cosine, 0 * sine), (cosine, sine))

        def of_step(step: tuple[jax.Array, jax.Array, jax.Array]) -> jax.Array:
            inner, begins, ends = step
            here = 0 * cosine + inner
            return edges_between(arrives, here, here + 1 / TRIED, begins, ends)

        radii = jnp.linspace(0, 1, TRIED + 1, dtype=cosine.dtype)
        alive = lax.map(lambda r: arrives(r + 0 * cosine), radii)
        return alive, lax.map(of_step, (radii[:-1], alive[:-1], alive[1:]))

    alive, edge = lax.map(of_wave, jax.tree.map(jnp.asarray, lights))
    return jnp.swapaxes(alive, 0, 1), jnp.swapaxes(edge, 0, 1)


def _parts(alive: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Inner and outer radius of the open parts of every spoke, (W, F, M, J, 2): as many for all, some empty.

    alive: (W, F, M, TRIED + 1), edges: (W, F, M, TRIED), see `_edges_along`.
    """
    opens, closes = ~alive[..., :-1] & alive[..., 1:], alive[..., :-1] & ~alive[..., 1:]
    count = int((opens.sum(-1) + alive[..., 0]).max(initial=1))
    parts = np.zeros((*alive.shape[:-1], count, 2))
    for place in np.ndindex(alive.shape[:-1]):
        starts = [*([0.0] if alive[place][0] else []), *(edges[place][opens[place]] * (1 + INSIDE))]
        ends = [*(edges[place][closes[place]] * (1 - INSIDE)), *([1.0] if alive[place][-1] else [])]
        for j, pair in enumerate(zip(starts, ends, strict=True)):
            parts[place][j] = pair
    return parts


def _cos(turns: np.ndarray) -> np.ndarray:
    return np.cos(2 * np.pi * turns)


def _sin(turns: np.ndarray) -> np.ndarray:
    return np.sin(2 * np.pi * turns)
