"""The sequential trace: rays through one surface after the other, in the order of the prescription.

All surfaces run in one `lax.scan`, whose body holds the kinds of surface that the lens has, each once: the
compiled program does not grow with their number and contains nothing that none of them needs. (Written out
surface by surface, XLA fuses each result with all that came before, and compiles for minutes.)

Optical path, where asked for, is carried as its excess over the axial path, W = sum n t - sum sigma n gap -
sigma n z, which loses no digits to the length of the lens:

    gap and crossing:  W += n1 t (l^2 + m^2) / (1 + sigma n),    surface:  W -= (sigma2 n2 - sigma1 n1) z,

sigma = +1 or -1 the sense of the light along z, t the path to the crossing at height z above the vertex plane.
"""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

from lenstrace.optics.apertures import ApertureKind, passes
from lenstrace.optics.frames import Pose
from lenstrace.optics.interactions import bend
from lenstrace.optics.rays import Ray, RayStatus, failure_code, has_course
from lenstrace.optics.screens.screen import Screen, path_and_slopes
from lenstrace.optics.shapes.asphere import Asphere
from lenstrace.optics.shapes.conic import Conic
from lenstrace.sequential.system import Kind, Placement, System


class Record(NamedTuple):
    """What one surface needs for a trace; a leading axis where several are stacked for a scan."""

    number: Any
    gap: Any
    curvature: Any
    conic: Any
    coefficients: Any
    norm_radius: Any
    index_before: Any
    index_after: Any
    side: Any
    orientation_before: Any
    orientation_after: Any
    aperture: Any
    decenter: Any
    tilt: Any


def trace(
    system: System,
    ray: Ray,
    *,
    last: int | None = None,
    path: bool = False,
    sense: Any = 1.0,
    axial: bool = True,
) -> Ray:
    """Rays through surfaces 1 ... last of a system at one wavelength.

    system:  at one wavelength, see `System.at`.
    ray:     in the frame of the first vertex, any shape; its optical path is traced if `ray.opl` is not None.
    last:    number of the surface to stop behind; None is the image.
    path:    give every surface instead of the last one: a leading axis, 0 the rays as launched, then one a surface.
    sense:   +1, or -1 for rays that run against the light; of the shape of the rays or a scalar. It is not read off
             the direction: light of a field beyond 90 degrees enters a lens with n < 0.
    axial:   False: optical path as its excess over the path along the axis from the first vertex to the surface's, for
             differences of paths: no digits are lost to the length of the lens.

    Returns the rays in the frame of the surface (position on it, mm; direction after it; optical path from the
    launch point to it, mm). Failed rays carry the first failure and go on with finite numbers.
    """
    last = len(system.kinds) if last is None else last
    records = _records(system, last)
    forward = jnp.broadcast_to(jnp.asarray(sense, ray.n.dtype), ray.n.shape)
    start = ray if ray.opl is None else _replace_opl(ray, ray.opl - forward * system.index[0] * ray.z)
    kinds = tuple(dict.fromkeys(system.kinds[:last]))
    branch = np.array([kinds.index(kind) for kind in system.kinds[:last]], np.int32)
    keep = path or system.kinds[last - 1].placement is Placement.POSED

    def step(state: Ray, surface: tuple[Record, jax.Array]) -> tuple[Ray, Ray | None]:
        record, branch = surface
        crossings = [functools.partial(cross, kind=kind, forward=forward, thin=_thin(system, kind)) for kind in kinds]
        after, here = crossings[0](state, record) if len(kinds) == 1 else lax.switch(branch, crossings, state, record)
        return after, here if keep else None

    end, met = lax.scan(jax.checkpoint(step, prevent_cse=False), start, (records, jnp.asarray(branch)))
    met = jax.tree.map(lambda a: a[None], end) if met is None else met
    met = met if ray.opl is None else _whole_opl(records, met, forward, axial)
    if not path:
        return jax.tree.map(lambda a: a[-1], met)
    return jax.tree.map(lambda a, b: jnp.concatenate([a[None], b]), ray, met)


def cross(
    ray: Ray, record: Record, kind: Kind, forward: jax.Array, thin: tuple[Screen, jax.Array] | None = None
) -> tuple[Ray, Ray]:
    """One surface: to it, through its aperture, bent.

    ray: in the frame of the vertex before.     forward: +1, or -1 for rays that run against the light.
    thin: a phase screen on the surface, and the wavelength, mm.
    Returns the ray in the frame that the next surface counts from, and the ray in this surface's own frame;
    the optical path is the excess W of the module's docstring, in each of the two frames.
    """
    side = record.side * forward
    before, after = record.orientation_before * forward, record.orientation_after * forward
    z_before = ray.z
    ray = _replace_z(ray, ray.z - record.gap)
    pose = Pose(record.decenter, record.tilt)
    centred = kind.placement is Placement.CENTRED
    ahead = jnp.zeros((), ray.z.dtype)
    if not centred:
        # near the vertex first: turning a point far away would round it across the ray, not along it
        ray, ahead = _nearest(ray, record.decenter)
        ray = _moved(ray, pose.local_point, pose.local_direction)

    point = (ray.x, ray.y, ray.z)
    direction = (ray.l, ray.m, ray.n)
    shape = (
        Asphere(record.curvature, record.conic, record.coefficients, record.norm_radius, kind.powers, kind.newton_steps)
        if kind.powers
        else Conic(record.curvature, record.conic)
    )
    crossing = shape.crossing(point, direction, side)
    x, y, z = crossing.point

    geometry = (direction, crossing.normal, crossing.normal_squared, crossing.cosine, side)
    added, push = None, None
    if thin is not None:
        # numbers of a ray without a course may be so large that a screen overflows there
        sound = crossing.met & has_course(ray.failure)
        added, push = path_and_slopes(thin[0], jnp.where(sound, x, 0), jnp.where(sound, y, 0), thin[1])
        added = jnp.where(sound, added, 0)
    # a ray that met nothing, or is totally reflected, goes straight on
    (l, m, n), bent = bend(kind.interaction, *geometry, record.index_before, record.index_after, crossing.met, push)
    reason = jnp.where(bent, int(RayStatus.OK), int(RayStatus.TIR))
    if kind.aperture is not ApertureKind.NONE:
        reason = jnp.where(passes(kind.aperture, record.aperture, x, y), reason, int(RayStatus.CLIPPED))
    reason = jnp.where(crossing.met, reason, crossing.reason).astype(ray.failure.dtype)
    fails = (ray.failure == 0) & (reason > 0)
    failure = jnp.where(fails, failure_code(record.number, reason), ray.failure)

    bent = Ray(x, y, z, l, m, n, failure, ray.opl)
    if ray.opl is None:
        return (
            _moved(bent, pose.global_point, pose.global_direction) if kind.placement is Placement.POSED else bent
        ), bent

    distance = crossing.distance
    if added is not None:
        ray = _replace_opl(ray, ray.opl + added)
    if centred:
        # a lost ray may run against the light: one along the axis that missed a mirror has 0 / 0
        advance = jnp.maximum(1 + before * ray.n, jnp.finfo(ray.n.dtype).eps)
        slant = (ray.l * ray.l + ray.m * ray.m) / advance
        step = after * record.index_after - before * record.index_before
        bent = _replace_opl(bent, ray.opl + record.index_before * distance * slant - step * z)
        return bent, bent
    arrived = ray.opl + record.index_before * (distance + ahead - before * (record.gap - z_before))
    bent = _replace_opl(bent, arrived - after * record.index_after * z)
    if kind.placement is Placement.BREAK:
        return bent, bent
    ray = _moved(bent, pose.global_point, pose.global_direction)
    return _replace_opl(ray, arrived - after * record.index_after * ray.z), bent


def _thin(system: System, kind: Kind) -> tuple[Screen, jax.Array] | None:
    return None if kind.screen is None else (system.screens[kind.screen], system.wavelength)


def _records(system: System, last: int) -> Record:
    """The arrays of surfaces 1 ... last, every one with a leading axis of that length."""
    dtype = system.curvature.dtype
    gap = jnp.concatenate([jnp.zeros(1, dtype), system.thickness])[:last]
    index = jnp.concatenate([system.index, system.index[-1:]])
    orientation = np.array([*system.orientation, system.orientation[-1]], dtype)
    return Record(
        number=np.arange(1, last + 1, dtype=np.int32),
        gap=gap,
        curvature=system.curvature[:last],
        conic=system.conic[:last],
        coefficients=system.coefficients[:last],
        norm_radius=system.norm_radius[:last],
        index_before=index[:last],
        index_after=index[1 : last + 1],
        side=np.array(system.sides, dtype)[:last],
        orientation_before=orientation[:last],
        orientation_after=orientation[1 : last + 1],
        aperture=system.aperture[:last],
        decenter=system.decenter[:last],
        tilt=system.tilt[:last],
    )


def _whole_opl(records: Record, ray: Ray, forward: jax.Array, axial: bool) -> Ray:
    """Optical path out of W; `ray` has the last surfaces, as many as its leading axis is long."""
    path = jnp.cumsum(records.orientation_before * records.index_before * records.gap)
    after = records.orientation_after * records.index_after
    count = ray.x.shape[0]
    shape = (count, *(1,) * (ray.x.ndim - 1))
    path, after = path[-count:].reshape(shape), after[-count:].reshape(shape)
    assert ray.opl is not None
    beyond = after * ray.z + (path if axial else 0)
    return _replace_opl(ray, ray.opl + forward * beyond)


def _replace_opl(ray: Ray, opl: jax.Array) -> Ray:
    return Ray(ray.x, ray.y, ray.z, ray.l, ray.m, ray.n, ray.failure, opl)


def _replace_z(ray: Ray, z: jax.Array) -> Ray:
    return Ray(ray.x, ray.y, z, ray.l, ray.m, ray.n, ray.failure, ray.opl)


def _nearest(ray: Ray, decenter: jax.Array) -> tuple[Ray, jax.Array]:
    """The ray from its point nearest to a vertex shifted across the axis, and how far along it that is, mm."""
    t = -((ray.x - decenter[0]) * ray.l + (ray.y - decenter[1]) * ray.m + ray.z * ray.n)
    x, y, z = ray.x + t * ray.l, ray.y + t * ray.m, ray.z + t * ray.n
    return Ray(x, y, z, ray.l, ray.m, ray.n, ray.failure, ray.opl), t


def _moved(ray: Ray, point: Any, direction: Any) -> Ray:
    """The ray seen from another frame."""
    x, y, z = point((ray.x, ray.y, ray.z))
    l, m, n = direction((ray.l, ray.m, ray.n))
    return Ray(x, y, z, l, m, n, ray.failure, ray.opl)
