"""What light loses on its way through a lens: reflected by uncoated surfaces, absorbed by glass."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.optics.fresnel import reflectances
from lenstrace.optics.interactions import Interaction
from lenstrace.optics.rays import Ray
from lenstrace.optics.vectors import dot, root_or_zero
from lenstrace.scene.cameras.focusing import in_chain
from lenstrace.sequential.normals import surface_normals
from lenstrace.sequential.system import Placement, System


def reflection_loss(system: System, path: Ray) -> jax.Array:
    """The part of natural light that uncoated surfaces let through, the product of 1 - (R_s + R_p) / 2.

    path: rays before surface 1 and behind surfaces 1 ... S, (S + 1, ...), each in the frame of its own surface but the
    first. Mirrors reflect all. What is reflected twice and comes back is not counted. The product of the means is that
    of light whose polarization is mixed again between surfaces.
    """
    count = system.surfaces
    first = system.replace(
        curvature=system.curvature[:count],
        conic=system.conic[:count],
        coefficients=system.coefficients[:count],
        norm_radius=system.norm_radius[:count],
        kinds=system.kinds[:count],
    )
    point = path.x[1:], path.y[1:], path.z[1:]
    normal = surface_normals(first, point)
    # behind a surface the angle is that of refraction: the same reflectances from the other side
    cosine = jnp.abs(dot(normal, (path.l[1:], path.m[1:], path.n[1:]))) / root_or_zero(dot(normal, normal))
    wide = jnp.reshape(system.index, (*system.index.shape, *(1,) * (cosine.ndim - system.index.ndim)))
    before, after = jnp.broadcast_to(wide[:-1], cosine.shape), jnp.broadcast_to(wide[1:], cosine.shape)
    s, p = reflectances(jnp.minimum(cosine, 1), after, before)
    mirror = np.array([kind.interaction is Interaction.REFLECT for kind in system.kinds[:count]])
    passed = jnp.where(mirror.reshape(-1, *(1,) * (cosine.ndim - 1)), 1, 1 - (s + p) / 2)
    return jnp.prod(passed, 0)


def absorption_loss(system: System, path: Ray, absorption: jax.Array) -> jax.Array:
    """exp(-sum of a_i t_i): the part of light that the glass lets through.

    path: as for `reflection_loss`.    absorption: (S + 1,), a_i of the film's space and behind each surface, 1/mm;
    t_i the length of the way in it, mm. The first way, from the film, is counted from where the rays begin.
    """
    exponent = jnp.zeros_like(path.x[0])
    for i in range(system.surfaces):
        here, there = (jax.tree.map(lambda a, j=j: a[j], path) for j in (i, i + 1))
        start = here if i == 0 else in_chain(system, i, here)
        end = in_chain(system, i + 1, there) if system.kinds[i].placement is Placement.POSED else there
        gap = system.thickness[i - 1] if i else jnp.zeros_like(system.thickness[0])
        way = end.x - start.x, end.y - start.y, end.z + gap - start.z
        exponent = exponent + absorption[i] * root_or_zero(dot(way, way))
    return jnp.exp(-exponent)
