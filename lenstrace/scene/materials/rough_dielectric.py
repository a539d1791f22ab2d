"""Ground glass: GGX small surfaces, each reflecting and refracting as clear matter does.

With the viewer's index n1, the light's n2 and m the normal of the small surface,

    f |i_z| = F D G / (4 o_z)                                                    reflected,  m = o + i
    f |i_z| = |o.m| |i.m| n1^2 (1 - F) D G / (o_z (n1 o.m + n2 i.m)^2)           refracted,  m = -(n1 o + n2 i)

Source: B. Walter et al., EGSR 2007, Eqs. (16), (20), (21).
"""

from __future__ import annotations

from typing import Any, ClassVar

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.fresnel import reflectances
from lenstrace.optics.vectors import Vector, divide_where, dot, root_or_zero
from lenstrace.scene.colours import Colour
from lenstrace.scene.materials.dielectric import Dielectric
from lenstrace.scene.materials.index import FlatIndex, disperses
from lenstrace.scene.materials.material import Branch, Place, Scattering
from lenstrace.scene.materials.microfacets import distribution, masking, reflected, visible_normal


@pytree
class RoughDielectric:
    """index, outside: see `Dielectric`.    roughness: GGX alpha, to 1. Light scattered more than once is lost."""

    sends: ClassVar[tuple[bool, bool]] = (True, True)
    index: Any
    roughness: Any = 0.1
    outside: Any = FlatIndex(1.0)

    @property
    def disperses(self) -> bool:
        """Whether the wavelength makes a difference."""
        return disperses(self.index, self.outside)

    def sample(self, place: Place, outgoing: Vector, u: jax.Array, v: jax.Array, w: jax.Array) -> Scattering:
        """At a small surface that is seen, reflected with the chance of its reflectance, else refracted."""
        here, there = self._indices(place)
        normal = visible_normal(self.roughness, outgoing, u, v)
        cosine = dot(outgoing, normal)
        share = _reflectance(cosine, here, there)
        back = w < share
        incoming = tuple(
            jnp.where(back, a, b)
            for a, b in zip(
                reflected(outgoing, normal, cosine), _refracted(outgoing, normal, cosine, here / there), strict=True
            )
        )
        kept = back == (incoming[2] > 0)
        weight = masking(self.roughness, incoming) * jnp.where(back, 1, (here / there) ** 2)  # type: ignore[arg-type]
        weight = jnp.where(kept, weight, 0)
        seen = masking(self.roughness, outgoing) * cosine * distribution(self.roughness, normal) / outgoing[2]
        sight = dot(incoming, normal)  # type: ignore[arg-type]
        turned = here * cosine + there * sight
        spread = jnp.where(
            back,
            share * divide_where(cosine > 0, jnp.ones_like(cosine), 4 * cosine),
            (1 - share) * divide_where(turned != 0, there * there * jnp.abs(sight), turned * turned),
        )
        density = jnp.where(kept, seen * spread, 0)
        # between equal indices every small surface lets the ray go straight on: there is no other way
        density = jnp.where(kept & ~back & (here == there), jnp.inf, density)
        return incoming, (weight, weight, weight), density  # type: ignore[return-value]

    def evaluate(self, place: Place, outgoing: Vector, incoming: Vector) -> tuple[Colour, jax.Array]:
        """f |cos| and the density of `sample`."""
        here, there = self._indices(place)
        back = incoming[2] > 0
        half = tuple(jnp.where(back, o + i, -(here * o + there * i)) for o, i in zip(outgoing, incoming, strict=True))
        square = dot(half, half)  # type: ignore[arg-type]
        scale = divide_where(square > 0, jnp.sign(half[2]), jnp.sqrt(jnp.where(square > 0, square, 1)))
        x, y, z = (h * scale for h in half)
        cosine, sight = dot(outgoing, (x, y, z)), dot(incoming, (x, y, z))
        # a small surface has the viewer before it, and the light on the side that the large one has it
        real = (cosine > 0) & ((sight > 0) == back) & (square > 0)
        share = _reflectance(jnp.maximum(cosine, 0), here, there)
        seen = masking(self.roughness, outgoing) * distribution(self.roughness, (x, y, z)) / outgoing[2]
        turned = here * cosine + there * sight
        through = divide_where(real & ~back, jnp.abs(sight) * cosine, turned * turned) * (1 - share)
        density = jnp.where(real, seen * jnp.where(back, share / 4, there * there * through), 0)
        value = masking(self.roughness, incoming) * density * jnp.where(back, 1, (here / there) ** 2)
        return (value, value, value), density

    def branches(self, place: Place, outgoing: Vector, gloss: Any) -> tuple[Branch, Branch]:
        """Both rays with their shares, those of a smooth surface or of a small one that is seen."""
        smooth = Dielectric(self.index, self.outside)
        if gloss is None:
            return smooth.branches(place, outgoing, None)
        here, there = self._indices(place)
        normal = visible_normal(self.roughness, outgoing, *gloss)
        cosine = dot(outgoing, normal)
        share = _reflectance(cosine, here, there)
        back, through = reflected(outgoing, normal, cosine), _refracted(outgoing, normal, cosine, here / there)
        r = jnp.where(back[2] > 0, share * masking(self.roughness, back), 0)
        t = jnp.where(through[2] < 0, (1 - share) * masking(self.roughness, through), 0)
        return (back, (r, r, r)), (through, (t, t, t))

    def _indices(self, place: Place) -> tuple[jax.Array, jax.Array]:
        inside, outside = self.index.index(place.um), self.outside.index(place.um)
        return jnp.where(place.outside, outside, inside), jnp.where(place.outside, inside, outside)


def _reflectance(cosine: jax.Array, here: jax.Array, there: jax.Array) -> jax.Array:
    s, p = reflectances(cosine, here, there)
    return (s + p) / 2


def _refracted(outgoing: Vector, normal: Vector, cosine: jax.Array, ratio: jax.Array) -> Vector:
    """Through a small surface; along it where nothing goes through."""
    along = ratio * cosine - root_or_zero(1 - ratio * ratio * (1 - cosine * cosine))
    x, y, z = (along * n - ratio * o for n, o in zip(normal, outgoing, strict=True))
    return x, y, z
