"""A sum of Zernike polynomials as a screen: aberrations to order, or the command of a deformable mirror."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.compute.pytree import is_traced, pytree, static
from lenstrace.optics.screens.screen import Number, Screen, plain, unless_sound
from lenstrace.optics.zernike import zernike_index, zernike_terms

# Of no polynomial beyond the disk, so that its derivatives are finite in float32 too.
LARGEST = 1e30


@pytree
class ZernikeScreen(Screen):
    """W = sum of c_j Z_j(x / R, y / R); beyond r = R the polynomials go on, up to |x| or |y| = `reach` R.

    coefficients:  mm, one for each of the static `numbers` j.      radius: R, mm.
    order:         noll, fringe or ansi, see `zernike_index`; static.
    """

    coefficients: tuple[Number, ...]
    radius: Number
    numbers: tuple[int, ...] = static()
    order: str = static()

    def path(self, x: jax.Array, y: jax.Array, wavelength: jax.Array) -> jax.Array:  # noqa: ARG002
        """W, mm."""
        u, v = (jnp.clip(a / self.radius, -self.reach, self.reach) for a in (x, y))
        terms = zernike_terms(self.order, self.numbers, u, v)
        return sum((c * term for c, term in zip(self.coefficients, terms, strict=True)), jnp.zeros_like(x))

    @property
    def reach(self) -> float:
        """Where the polynomials end, in units of R: from there W is constant along x or y, so that it stays finite.

        On the square |x|, |y| <= u R with u > 1 a polynomial of the degree n is below (4 u)^n: the leading terms are
        (2^(1/2) u)^n, their coefficients add up to at most (1 + 2^(1/2))^n. The table of all polynomials that are
        evaluated goes to n = max(n - |m|) + max |m|. For n = 4 the reach is 8e6, for n = 10 it is 250, for n = 20 it is
        7.9, and for n > 49 the square around the disk.
        """
        n, m = np.abs([zernike_index(self.order, number) for number in self.numbers]).T
        return max(1.0, float(LARGEST ** (1 / max(1, max(n - m) + max(m))) / 4))

    @property
    def label(self) -> str:
        """For the table of a lens."""
        terms = ", ".join(f"{j}: {plain(c)}" for j, c in zip(self.numbers, self.coefficients, strict=True))
        return f"Zernike ({self.order}) {terms} mm, radius {plain(self.radius)} mm"

    @property
    def mistake(self) -> str:
        """No terms, a radius that is none, a term that is not finite."""
        bad = [c for c in self.coefficients if not is_traced(c) and not abs(c) < float("inf")]
        return (
            unless_sound(self.radius, "zernike: the radius", positive=True)
            or ("" if self.numbers else "zernike: at least one term is needed, got none")
            or (f"zernike: a coefficient must be a finite number, got {bad[0]}" if bad else "")
        )
