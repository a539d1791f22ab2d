"""Metal, more or less polished: GGX small mirrors, each reflecting as metal does."""

from __future__ import annotations

from typing import Any, ClassVar

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import Vector, divide_where, dot, normalize, root_or_zero
from lenstrace.scene.colours import Colour, scaled
from lenstrace.scene.materials.material import Branch, Place, Scattering, mirrored, no_branches
from lenstrace.scene.materials.microfacets import distribution, masking, reflected, visible_normal


@pytree
class RoughConductor:
    """eta, k: RGB, the index eta + i k of the metal relative to what is around.    roughness: GGX alpha, to 1.

    The default is gold. Light that would be reflected more than once between the small mirrors is lost.
    """

    sends: ClassVar[tuple[bool, bool]] = (True, False)
    disperses: ClassVar[bool] = False
    eta: Any = (0.143, 0.375, 1.442)
    k: Any = (3.983, 2.386, 1.603)
    roughness: Any = 0.1

    def sample(self, place: Place, outgoing: Vector, u: jax.Array, v: jax.Array, w: jax.Array) -> Scattering:
        """A reflection in a small mirror that is seen; w makes no difference."""
        del place, w
        normal = visible_normal(self.roughness, outgoing, u, v)
        cosine = dot(outgoing, normal)
        incoming = reflected(outgoing, normal, cosine)
        seen, lit = masking(self.roughness, outgoing), masking(self.roughness, incoming)
        above = incoming[2] > 0
        weight = scaled(self._reflectance(cosine), jnp.where(above, lit, 0))
        density = seen * distribution(self.roughness, normal) / (4 * outgoing[2])
        return incoming, weight, jnp.where(above, density, 0)

    def evaluate(self, place: Place, outgoing: Vector, incoming: Vector) -> tuple[Colour, jax.Array]:
        """F D G / (4 o_z) and the density of `sample`; 0 for light from behind."""
        del place
        above = incoming[2] > 0
        x, y, z = outgoing[0] + incoming[0], outgoing[1] + incoming[1], outgoing[2] + jnp.maximum(incoming[2], 0)
        normal = normalize((x, y, z))
        density = masking(self.roughness, outgoing) * distribution(self.roughness, normal) / (4 * outgoing[2])
        density = jnp.where(above, density, 0)
        value = scaled(self._reflectance(dot(outgoing, normal)), density * masking(self.roughness, incoming))
        return value, density

    def branches(self, place: Place, outgoing: Vector, gloss: Any) -> tuple[Branch, Branch]:
        """The mirrored ray, or one of its gloss."""
        if gloss is None:
            return (mirrored(outgoing), self._reflectance(outgoing[2])), no_branches(outgoing)[1]
        u, v = gloss
        incoming, weight, _ = self.sample(place, outgoing, u, v, u)
        return (incoming, weight), no_branches(outgoing)[1]

    def _reflectance(self, cosine: jax.Array) -> Colour:
        r, g, b = (metal_reflectance(cosine, eta, k) for eta, k in zip(self.eta, self.k, strict=True))
        return r, g, b


def metal_reflectance(cosine: jax.Array, eta: jax.Array, k: jax.Array) -> jax.Array:
    """Of natural light at a clean metal of index eta + i k, relative to what is around; cosine: of incidence, 0 to 1.

    Source: Born & Wolf, Principles of Optics (7th ed.), section 14.4, Eqs. (8), (13)-(14), (17)-(18).
    """
    c2 = cosine * cosine
    s2 = 1 - c2
    difference = eta * eta - k * k - s2
    both = root_or_zero(difference * difference + 4 * eta * eta * k * k)
    larger = root_or_zero((both + jnp.abs(difference)) / 2)
    # of u and v, u v = eta k, the larger one has no digits cancelled
    u = jnp.where(difference > 0, larger, divide_where(larger > 0, eta * k, larger))
    most = both + c2 + 2 * cosine * u
    across = divide_where(most > 0, both + c2 - 2 * cosine * u, most)
    turn = 2 * cosine * u * s2
    level = c2 * both + s2 * s2
    # the mean of R_s and R_p = R_s (level - turn) / (level + turn); a quotient, so that it is computed once
    return divide_where(level + turn > 0, across * level, level + turn)
