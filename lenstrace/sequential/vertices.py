"""Where every surface stands in the axes of the first vertex."""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.optics.frames import Pose, placed
from lenstrace.sequential.system import Placement, System


def vertices(system: System) -> tuple[jax.Array, jax.Array]:
    """Global from local rotation (K, 3, 3) and vertex position (K, 3), mm, of surfaces 1 ... S + 1.

    A point p of a surface's own frame stands at rotation @ p + position. The frame of the first row before its
    own tilt is the global one.
    """
    dtype = system.curvature.dtype
    rotation, origin = jnp.eye(3, dtype=dtype), jnp.zeros(3, dtype)
    rotations, origins = [], []
    for i, kind in enumerate(system.kinds):
        if i > 0:
            origin = origin + rotation[:, 2] * system.thickness[i - 1]
        own = rotation, origin
        if kind.placement is not Placement.CENTRED:
            own = placed(rotation, origin, Pose(system.decenter[i], system.tilt[i]))
        if kind.placement is Placement.BREAK:
            rotation, origin = own
        rotations.append(own[0])
        origins.append(own[1])
    return jnp.stack(rotations), jnp.stack(origins)
