"""What every material says, and the place it is asked about.

A surface is looked at in axes of its own: z is the normal on the side of the viewer, `outgoing` the direction back to
the viewer, z > 0, and `incoming` the one that light comes from: z > 0 on the same side, z < 0 from behind.
Scattering f is for radiance. Through a refraction radiance grows by the square of the index, so that
f(i -> o) / n_o^2 = f(o -> i) / n_i^2. Materials are pytrees of numbers with

    sample(place, outgoing, u, v, w) -> (incoming, weight, density)     f |cos| / density, for u, v, w in [0, 1)
    evaluate(place, outgoing, incoming) -> (f |cos|, density)           both 0 for a material that leaves no choice
    branches(place, outgoing, gloss) -> ((incoming, share), (incoming, share))    one reflected, one refracted ray

where density is that of `sample` per solid angle, inf where the material leaves no choice, and a share is that of the
light's power. `gloss`: two numbers in [0, 1) for a direction about the mirror's one; None for that itself.
Source: E. Veach, PhD thesis, Stanford (1997), section 5.2.
"""

from __future__ import annotations

from typing import NamedTuple

import jax
import jax.numpy as jnp

from lenstrace.optics.vectors import Vector
from lenstrace.scene.colours import Colour

Scattering = tuple[Vector, Colour, jax.Array]
Branch = tuple[Vector, Colour]


class Place(NamedTuple):
    """point: in the scene.    outside: whether the viewer is on the side of the outward normal.
    um: wavelength; None where no material asks for it."""

    point: Vector
    outside: jax.Array
    um: jax.Array | None


def mirrored(outgoing: Vector) -> Vector:
    """The direction whose mirror image is `outgoing`."""
    return -outgoing[0], -outgoing[1], outgoing[2]


def none(outgoing: Vector) -> tuple[Colour, jax.Array]:
    """No scattering, no density."""
    zero = jnp.zeros_like(outgoing[2])
    return (zero, zero, zero), zero


def no_branches(outgoing: Vector) -> tuple[Branch, Branch]:
    """A surface that sends no ray on."""
    nothing = mirrored(outgoing), none(outgoing)[0]
    return nothing, nothing
