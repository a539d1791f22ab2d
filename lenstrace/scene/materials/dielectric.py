"""Clear matter with a smooth surface: Fresnel's share of the light is reflected, the rest goes through, refracted."""

from __future__ import annotations

from typing import Any, ClassVar

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.fresnel import reflectances
from lenstrace.optics.vectors import Vector, root_or_zero
from lenstrace.scene.colours import Colour
from lenstrace.scene.materials.index import FlatIndex, disperses
from lenstrace.scene.materials.material import Branch, Place, Scattering, mirrored, none


@pytree
class Dielectric:
    """index: inside, behind the outward normal; outside: before it. A number, the name of a glass, or a medium."""

    sends: ClassVar[tuple[bool, bool]] = (True, True)
    index: Any
    outside: Any = FlatIndex(1.0)

    @property
    def disperses(self) -> bool:
        """Whether the wavelength makes a difference."""
        return disperses(self.index, self.outside)

    def sample(self, place: Place, outgoing: Vector, u: jax.Array, v: jax.Array, w: jax.Array) -> Scattering:
        """Reflected with the chance of the reflected share, else refracted; u and v make no difference.

        The radiance that comes from a medium of index n2 is weighted by (n1 / n2)^2, n1 the viewer's.
        """
        del u, v
        share, ratio, through = self._ways(place, outgoing)
        back = w < share
        incoming = tuple(jnp.where(back, a, b) for a, b in zip(mirrored(outgoing), through, strict=True))
        weight = jnp.where(back, 1, ratio * ratio)
        return incoming, (weight, weight, weight), jnp.full_like(weight, jnp.inf)  # type: ignore[return-value]

    def evaluate(self, place: Place, outgoing: Vector, incoming: Vector) -> tuple[Colour, jax.Array]:
        """Nothing: no light comes by chance from just there."""
        del place, incoming
        return none(outgoing)

    def branches(self, place: Place, outgoing: Vector, gloss: Any) -> tuple[Branch, Branch]:
        """Both rays, with their shares."""
        del gloss
        share, _, through = self._ways(place, outgoing)
        rest = 1 - share
        return (mirrored(outgoing), (share, share, share)), (through, (rest, rest, rest))

    def _ways(self, place: Place, outgoing: Vector) -> tuple[jax.Array, jax.Array, Vector]:
        """Reflected share, n1 / n2 and the refracted direction."""
        inside, outside = self.index.index(place.um), self.outside.index(place.um)
        here, there = jnp.where(place.outside, outside, inside), jnp.where(place.outside, inside, outside)
        x, y, z = outgoing
        s, p = reflectances(z, here, there)
        ratio = here / there
        # cos^2 of refraction is cos^2 of incidence plus what the indices differ by: nothing cancels at grazing angles
        cosine = root_or_zero(ratio * ratio * z * z + (there - here) * (there + here) / (there * there))
        return (s + p) / 2, ratio, (-ratio * x, -ratio * y, -cosine)
