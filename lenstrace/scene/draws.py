"""Random numbers of a ray: a hash of its pixel, its sample and what the number is for; nothing is remembered.

The same key gives the same numbers, in whatever order, in whatever tile and on whatever thread they are asked for.
`INDEPENDENT` numbers are a hash of four words. `SOBOL` numbers are pairs of Sobol's sequence, Owen-scrambled and
shuffled for every pixel and purpose: the samples of a pixel fill the square of each pair evenly.
Source: M. Jarzynski, M. Olano, J. Computer Graphics Techniques 9 (3), 20 (2020), pcg4d; B. Burley, JCGT 9 (4), 1
(2020), with S. Laine, T. Karras, Computer Graphics Forum 30, 1263 (2011) for the scrambling.
"""

from __future__ import annotations

import enum

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import pytree, static

# What a number is for: each purpose takes four of them, bounce b the next `PER_BOUNCE` purposes from FIRST_BOUNCE on.
PIXEL, MOMENT, FIRST_BOUNCE = 0, 1, 2
LIGHT, SCATTER, PER_BOUNCE = 0, 1, 2

Four = tuple[jax.Array, jax.Array, jax.Array, jax.Array]


class Sampler(enum.Enum):
    """How the samples of a pixel lie; the value is the word in a command."""

    INDEPENDENT = "independent"
    SOBOL = "sobol"


@pytree
class Draws:
    """Where random numbers come from. pixel, sample: unsigned, one for each ray; key: one word."""

    pixel: jax.Array
    sample: jax.Array
    key: jax.Array
    sampler: Sampler = static(default=Sampler.INDEPENDENT)

    def four(self, purpose: jax.Array | int, dtype: jnp.dtype) -> Four:
        """Four numbers in [0, 1) for each ray; of another purpose, other ones."""
        words = [jnp.broadcast_to(jnp.asarray(each, jnp.uint32), self.pixel.shape) for each in (purpose, self.key)]
        if self.sampler is Sampler.SOBOL:
            hashed = _hash(self.pixel, jnp.zeros_like(self.pixel), *words)
            return tuple(fraction(word, dtype) for word in _two_pairs(self.sample, hashed))  # type: ignore[return-value]
        return tuple(fraction(word, dtype) for word in _hash(self.pixel, self.sample, *words))  # type: ignore[return-value]


def fraction(word: jax.Array, dtype: jnp.dtype) -> jax.Array:
    """Numbers in [0, 1) of 32 random bits: as many of them as the precision holds, so that none is rounded up to 1."""
    bits = min(32, jnp.finfo(dtype).nmant + 1)
    kept = word >> np.uint32(32 - bits)
    # signed integers convert in one instruction
    kept = kept.astype(jnp.int32 if bits < 32 else jnp.int64)
    return kept.astype(dtype) * jnp.asarray(0.5**bits, dtype)


def _hash(a: jax.Array, b: jax.Array, c: jax.Array, d: jax.Array) -> Four:
    """pcg4d: four words out of four, every bit of each depends on all."""
    a, b, c, d = (word * np.uint32(1664525) + np.uint32(1013904223) for word in (a, b, c, d))
    for shift in (True, False):
        a = a + b * d
        b = b + c * a
        c = c + a * b
        d = d + b * c
        if shift:
            a, b, c, d = (word ^ (word >> np.uint32(16)) for word in (a, b, c, d))
    return a, b, c, d


def _two_pairs(sample: jax.Array, seeds: Four) -> Four:
    """Two pairs of Sobol's first two coordinates, each pair of a shuffled order and scrambled by seeds of its own."""
    words: list[jax.Array] = []
    for order, scramble in (seeds[:2], seeds[2:]):
        index = _scrambled(sample, order)
        words.append(_scrambled(_reversed(index), scramble))
        words.append(_scrambled(_second(index), _mixed(scramble)))
    return tuple(words)  # type: ignore[return-value]


def _reversed(word: jax.Array) -> jax.Array:
    """The bits from the last to the first: Sobol's first coordinate, van der Corput's sequence."""
    for shift, mask in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF)):
        shift, mask = np.uint32(shift), np.uint32(mask)
        word = ((word >> shift) & mask) | ((word & mask) << shift)
    return (word >> np.uint32(16)) | (word << np.uint32(16))


def _second(index: jax.Array) -> jax.Array:
    """Sobol's second coordinate: the bits of the index times Pascal's triangle modulo 2, reversed.

    Of the triangle of 2 m rows out of that of m (bit i takes bit j > i where C(j, i) is odd): the upper half of the
    bits is added to the lower one, in each block of 2 m, for m = 16, 8, ... 1.
    """
    for shift, mask in ((16, 0x0000FFFF), (8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555)):
        index = index ^ ((index >> np.uint32(shift)) & np.uint32(mask))
    return _reversed(index)


def _scrambled(word: jax.Array, seed: jax.Array) -> jax.Array:
    """Owen's scrambling by a hash: whether a bit is flipped depends on the seed and the bits above it."""
    word = _reversed(word) + seed
    word = word ^ (word * np.uint32(0x6C50B47C))
    word = word ^ (word * np.uint32(0xB82F1E52))
    word = word ^ (word * np.uint32(0xC7AFE638))
    word = word ^ (word * np.uint32(0x8D22F6E6))
    return _reversed(word)


def _mixed(seed: jax.Array) -> jax.Array:
    """Another seed."""
    return (seed ^ (seed >> np.uint32(15))) * np.uint32(0x2C1B3C6D) + np.uint32(0x297A2D39)
