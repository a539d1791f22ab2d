"""Cameras without a lens of glass: a pinhole, an ideal thin lens, and parallel sight.

A place in the picture is x to the right and y up, both in half the picture's shorter side.
"""

from __future__ import annotations

from typing import ClassVar

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree
from lenstrace.optics.vectors import normalize
from lenstrace.scene.cameras.view import CameraRay, View, on_disk


@pytree
class Pinhole:
    """All lines of sight through one point. field_of_view: degrees across the shorter side of the picture."""

    disperses: ClassVar[bool] = False
    view: View
    field_of_view: jax.Array

    def rays(self, x: jax.Array, y: jax.Array, u: jax.Array, v: jax.Array, um: jax.Array | None) -> CameraRay:
        """Of places in the picture; u, v and um make no difference."""
        del u, v, um
        width = jnp.tan(jnp.radians(self.field_of_view) / 2)
        direction = normalize(self.view.outer((x * width, y * width, jnp.ones_like(x))))
        point = tuple(jnp.broadcast_to(a, x.shape) for a in self.view.position)
        return CameraRay(point, direction, jnp.ones_like(x))  # type: ignore[arg-type]


@pytree
class ThinLens:
    """An ideal lens focused on one plane: what is nearer or farther is seen through the whole of its opening.

    focal_length f, film (the shorter side of the picture) and focus s, the distance of the plane that is sharp: lengths
    of the scene; f_number: f over the diameter of the opening. The film stands b = f s / (s - f) behind the lens.
    """

    disperses: ClassVar[bool] = False
    view: View
    focal_length: jax.Array
    f_number: jax.Array
    focus: jax.Array
    film: jax.Array

    def rays(self, x: jax.Array, y: jax.Array, u: jax.Array, v: jax.Array, um: jax.Array | None) -> CameraRay:
        """Of places in the picture and of the opening, u and v in [0, 1); um makes no difference."""
        del um
        half = self.film / 2 * self.focus / self.film_distance
        a, b = on_disk(u, v)
        radius = self.focal_length / self.f_number / 2
        a, b = a * radius, b * radius
        sharp = normalize(self.view.outer((x * half - a, y * half - b, jnp.broadcast_to(self.focus, x.shape))))
        return CameraRay(self.view.outer_point((a, b, jnp.zeros_like(a))), sharp, jnp.ones_like(x))

    @property
    def film_distance(self) -> jax.Array:
        """From the lens to the film."""
        return self.focal_length * self.focus / (self.focus - self.focal_length)

    def circle_of_confusion(self, distance: jax.Array) -> jax.Array:
        """Diameter on the film of the disk that a point becomes, `distance` before the lens.

        c = (f / N) |d - s| / d * f / (s - f), from similar triangles.
        """
        opening = self.focal_length / self.f_number
        share = jnp.abs(distance - self.focus) / distance
        return opening * share * self.focal_length / (self.focus - self.focal_length)


@pytree
class Orthographic:
    """Parallel lines of sight. height: the shorter side of what is seen, a length of the scene."""

    disperses: ClassVar[bool] = False
    view: View
    height: jax.Array

    def rays(self, x: jax.Array, y: jax.Array, u: jax.Array, v: jax.Array, um: jax.Array | None) -> CameraRay:
        """Of places in the picture; u, v and um make no difference."""
        del u, v, um
        half = self.height / 2
        forward = self.view.axes[2]
        point = self.view.outer_point((x * half, y * half, jnp.zeros_like(x)))
        direction = tuple(jnp.broadcast_to(a, x.shape) for a in forward)
        return CameraRay(point, direction, jnp.ones_like(x))  # type: ignore[arg-type]
