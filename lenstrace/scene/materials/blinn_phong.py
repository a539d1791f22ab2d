"""Matt with a highlight: Lambert's law and Blinn's for the shine.

    f = diffuse / pi + specular s (N.H)^n,     s = (n + 2) (n + 4) / (8 pi (2^(-n/2) + n))

H lies half way between the light and the viewer. With s the highlight, seen straight from above, gives back just
`specular` of the light that falls on it, whatever the exponent.
Source: J. Blinn, Computer Graphics 11 (2), 192 (1977); s: F. Giesen, Phong and Blinn-Phong normalization (2009).
"""

from __future__ import annotations

from typing import Any, ClassVar

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.turns import turned
from lenstrace.optics.vectors import Vector, divide_where, dot, normalize, root_or_zero
from lenstrace.scene.colours import Colour, plus, scaled
from lenstrace.scene.materials.diffuse import about_normal
from lenstrace.scene.materials.material import Branch, Place, Scattering, no_branches
from lenstrace.scene.materials.texture import colour_at


@pytree
class BlinnPhong:
    """diffuse, specular: RGB or textures, together at most 1; exponent: n, larger for a smaller highlight."""

    sends: ClassVar[tuple[bool, bool]] = (False, False)
    disperses: ClassVar[bool] = False
    diffuse: Any
    specular: Any
    exponent: Any = 50.0

    def sample(self, place: Place, outgoing: Vector, u: jax.Array, v: jax.Array, w: jax.Array) -> Scattering:
        """By turns as a matt surface does, and about the highlight."""
        n = self.exponent
        # H with density (n + 1) / (2 pi) cos^n
        cosine = _power(1 - u, 1 / (n + 1))
        radius, (cos, sin) = root_or_zero(1 - cosine * cosine), turned(v)
        half = radius * cos, radius * sin, cosine
        along = 2 * dot(outgoing, half)
        shine = tuple(along * h - o for h, o in zip(half, outgoing, strict=True))
        incoming = tuple(jnp.where(w < 1 / 2, a, b) for a, b in zip(about_normal(u, v), shine, strict=True))
        value, density = self.evaluate(place, outgoing, incoming)  # type: ignore[arg-type]
        weight = scaled(value, divide_where(density > 0, jnp.ones_like(density), density))
        return incoming, weight, density  # type: ignore[return-value]

    def evaluate(self, place: Place, outgoing: Vector, incoming: Vector) -> tuple[Colour, jax.Array]:
        """f cos and density, 0 for light from behind."""
        n, cosine = self.exponent, jnp.maximum(incoming[2], 0)
        half = normalize((outgoing[0] + incoming[0], outgoing[1] + incoming[1], outgoing[2] + cosine))
        lobe = _power(half[2], n)
        shine = (n + 2) * (n + 4) / (8 * jnp.pi * (2 ** (-n / 2) + n)) * lobe
        matt = scaled(colour_at(self.diffuse, place.point), jnp.full_like(lobe, 1 / jnp.pi))
        value = plus(matt, scaled(colour_at(self.specular, place.point), shine))
        toward = dot(outgoing, half)
        about = divide_where(toward > 0, (n + 1) * lobe, 8 * jnp.pi * toward)
        density = jnp.where(cosine > 0, cosine / (2 * jnp.pi) + about / 2, 0)
        return scaled(value, cosine), density

    def branches(self, place: Place, outgoing: Vector, gloss: Any) -> tuple[Branch, Branch]:
        """None: the highlight stands for all that it reflects."""
        del place, gloss
        return no_branches(outgoing)


def _power(base: jax.Array, exponent: jax.Array) -> jax.Array:
    """base^exponent for bases above 0: XLA has vectors of exp and log, and calls a library's power ray by ray."""
    return jnp.exp(exponent * jnp.log(base))
