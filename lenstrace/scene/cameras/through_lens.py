"""Rays from the film through a lens of glass into the scene.

A point of the film and one of the pupil give a ray, which the sequential tracer follows through the reversed lens into
the scene. Its weight turns the mean of the radiance over the pupil into the irradiance of the film,

    E = integral of L cos^4(theta) / Z^2 dA = mean of L (area of the bound) cos^4(theta) / Z^2,

theta the angle at the film, for points spread evenly over a bound of the pupil on a plane at distance Z; rays that a
rim or a stop blocks count nothing. Here Z = 1: points of the plane are the slopes of the rays.

Source: C. Kolb, D. Mitchell, P. Hanrahan, A realistic camera model for computer graphics, SIGGRAPH 95, 317, Eqs.
(1)-(3); M. Pharr, W. Jakob, G. Humphreys, Physically Based Rendering (3rd ed.), section 6.4.
"""

from __future__ import annotations

import math
from typing import Any

import jax
import jax.numpy as jnp

from lenstrace.compute.pytree import pytree, static
from lenstrace.errors import CameraError
from lenstrace.optics.rays import Ray, living
from lenstrace.optics.vectors import divide_where, safe_sqrt
from lenstrace.scene.cameras.focusing import in_chain
from lenstrace.scene.cameras.losses import absorption_loss, reflection_loss
from lenstrace.scene.cameras.pupil_bound import PupilBound
from lenstrace.scene.cameras.view import CameraRay, View, on_disk
from lenstrace.scene.dispersion import Dispersion
from lenstrace.sequential.system import System
from lenstrace.sequential.trace import trace

MM_PER_UM = 1e-3
COVERED = 1e-6  # rounding of the film's size


@pytree
class LensCamera:
    """A lens, focused and stopped down, and the film behind it; made by `lens_camera`. All numbers are leaves, so that
    other curvatures, glasses, focus or f-number compile nothing anew.

    view:           its position is that of the entrance pupil.
    system:         the reversed lens at its primary wavelength, its object the film; mm.
    dispersion:     of the S + 1 media, from the film on; None where one is not known in visible light.
    half_film:      half the shorter side, mm; negative where the image is upside down, as it is in most lenses.
    pupil_ahead:    from the entrance pupil to the first vertex, mm along the view.
    chief, marginal, bound:  see `pupil_bound.py`.
    gain:           by what cos^4 / Z^2 dA is multiplied.
    unit_mm:        mm in a length of the scene.
    absorption:     (S + 1,), 1/mm, of the media, from the film on; None: clear.
    fresnel:        surfaces without a coating reflect.

    Derivatives. Directions, focus and weights have those of the trace; the bound moves as the rims do that limit the
    pupil in four directions (`pupil_edges.py`), so that what a sample finds blocked is blocked still. Were it held
    fixed, the derivative of a pixel would miss the light that comes and goes at the edge of the pupil. What is left out
    is a change of form of the edge between the four, and the edge of a central obstruction: where the stop limits the
    light derivatives of the irradiance of a double Gauss are right to 0.5 %, where rims cut it as well to 10 %.
    """

    view: View
    system: System
    dispersion: Dispersion | None
    half_film: jax.Array
    pupil_ahead: jax.Array
    chief: jax.Array
    marginal: jax.Array
    bound: PupilBound
    gain: jax.Array
    unit_mm: jax.Array
    absorption: jax.Array | None
    fresnel: bool = static(default=False)

    def rays(self, x: jax.Array, y: jax.Array, u: jax.Array, v: jax.Array, um: jax.Array | None) -> CameraRay:
        """Of places in the picture, in half its shorter side, and of the pupil, u and v in [0, 1).

        um: wavelengths, micrometres, one for each ray; None: the primary one of the lens.
        """
        film_x, film_y = x * self.half_film, y * self.half_film
        slope_x, slope_y, area = self._slopes(film_x, film_y, u, v)
        n = 1 / jnp.sqrt(1 + slope_x * slope_x + slope_y * slope_y)
        square = n * n
        system = self.system_at(um)
        start = jnp.broadcast_to(-jnp.asarray(self.system.object_distance), x.shape)
        ray, passed = self._through(system, living(film_x, film_y, start, slope_x * n, slope_y * n, n))
        weight = jnp.where(ray.ok, self.gain * area * square * square * passed, 0)
        return self._in_scene(ray, weight)

    @property
    def disperses(self) -> bool:
        """Whether a ray goes another way for every wavelength."""
        return self.dispersion is not None

    def require_covers(self, width: int, height: int) -> None:
        """CameraError for a picture longer than the camera was made for: in its corners the pupil is not known."""
        aspect = max(width, height) / min(width, height)
        corner = abs(float(self.half_film)) * math.hypot(1, aspect)
        if corner > float(self.bound.reach) * (1 + COVERED):
            raise CameraError(
                f"size: {width}x{height} is {aspect:.3g} times as long as wide, longer than the camera was made for; "
                f"make it with aspect = {aspect:.3g}"
            )

    def system_at(self, um: jax.Array | None) -> System:
        """The reversed lens with the indices (S + 1, ...) of wavelengths, micrometres; None: the primary."""
        if um is None:
            return self.system
        if self.dispersion is None:
            raise CameraError(
                "wavelengths: a glass of this lens is not known in visible light; take a picture without them"
            )
        wide = jax.tree.map(lambda a: jnp.reshape(a, (-1, *(1,) * um.ndim)), self.dispersion)
        return self.system.replace(index=wide.index(um), wavelength=um * MM_PER_UM)

    def astype(self, dtype: Any) -> LensCamera:
        """The same camera in another precision."""
        return jax.tree.map(lambda a: jnp.asarray(a, dtype), self)

    def _slopes(
        self, film_x: jax.Array, film_y: jax.Array, u: jax.Array, v: jax.Array
    ) -> tuple[jax.Array, jax.Array, jax.Array]:
        """Slopes dx/dz, dy/dz of rays behind the lens, and the area of the bound in them."""
        bound = self.bound
        square = film_x * film_x + film_y * film_y
        off = square > 0
        radius = jnp.where(off, safe_sqrt(square), 0)
        centre_s, centre_t, half_s, half_t = bound.at(radius)
        a, b = on_disk(u, v) if bound.ellipse else (2 * u - 1, 2 * v - 1)
        s, t = centre_s + half_s * a, centre_t + half_t * b
        if bound.turned:
            cosine = jnp.where(off, divide_where(off, film_x, radius), 1)
            sine = divide_where(off, film_y, radius)
            s, t = cosine * s - sine * t, sine * s + cosine * t
        area = (math.pi if bound.ellipse else 4) * half_s * half_t * self.marginal * self.marginal
        return self.chief * film_x + self.marginal * s, self.chief * film_y + self.marginal * t, area

    def _through(self, system: System, ray: Ray) -> tuple[Ray, jax.Array | float]:
        """Behind the reversed lens, in the frame of its last vertex; and what part of the light passes."""
        if not self.fresnel and self.absorption is None:
            return in_chain(system, system.surfaces, trace(system, ray, last=system.surfaces)), 1
        path = trace(system, ray, last=system.surfaces, path=True)
        passed = jnp.ones_like(ray.x)
        if self.fresnel:
            passed = passed * reflection_loss(system, path)
        if self.absorption is not None:
            passed = passed * absorption_loss(system, path, self.absorption)
        return in_chain(system, system.surfaces, jax.tree.map(lambda a: a[-1], path)), passed

    def _in_scene(self, ray: Ray, weight: jax.Array) -> CameraRay:
        sense = self.system.orientation[-1]
        unit = 1 / self.unit_mm
        local = ray.x * unit, ray.y * unit, (sense * ray.z + self.pupil_ahead) * unit
        return CameraRay(self.view.outer_point(local), self.view.outer((ray.l, ray.m, sense * ray.n)), weight)
