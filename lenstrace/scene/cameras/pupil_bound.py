"""The pupil as the film sees it: from which directions light may come to a point of the film.

Directions are given by the stop: with y = A h + B u, the paraxial height at the stop of a ray that leaves the film at h
with slope u, and R the stop's radius, the point (s, t) of the pupil is the slope

    u = chief h + marginal (s, t),      chief = -A / B,   marginal = R / B,

so that (s, t) fills the unit disk wherever the film point is, but for the aberrations of the pupil and for vignetting.
The bound in (s, t) is a table over the radius of the film point, for a lens of revolution in axes turned toward that
point; else one for all points. It is an ellipse where all apertures are round, else a rectangle.

Source: C. Kolb, D. Mitchell, P. Hanrahan, A realistic camera model for computer graphics, SIGGRAPH 95, 317, section 4;
M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering (3rd ed.), section 6.4.5: the bound over the film's radius.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree, static


@pytree
class PupilBound:
    """Where in (s, t) light may come from, for film points at radius h.

    step:   mm of film radius from one node to the next.
    centre_s, centre_t, half_s, half_t:  (K,), at the nodes; between them linear, beyond the last one its own.
    turned: s is along the film point's radius, else along x.      ellipse: with those half axes, else a rectangle.
    """

    step: jax.Array
    centre_s: jax.Array
    centre_t: jax.Array
    half_s: jax.Array
    half_t: jax.Array
    turned: bool = static(default=True)
    ellipse: bool = static(default=True)

    @property
    def reach(self) -> jax.Array:
        """Radius of the last node, mm."""
        return self.step * (self.centre_s.shape[0] - 1)

    def at(self, radius: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array, jax.Array]:
        """Centre and half axes at a radius, mm."""
        last = self.centre_s.shape[0] - 1
        place = jnp.clip(radius / self.step, 0, last)
        node = jnp.clip(place.astype(jnp.int32), 0, last - 1)
        share = place - node.astype(place.dtype)
        s, t, a, b = (
            table[node] + share * (table[node + 1] - table[node])
            for table in (self.centre_s, self.centre_t, self.half_s, self.half_t)
        )
        return s, t, a, b
