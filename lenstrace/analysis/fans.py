"""Ray fans: transverse aberration and optical path difference along two lines across the pupil."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from lenstrace.analysis.image_rays import ImageRays, check_light, image_rays
from lenstrace.analysis.path_difference import Sphere, check_reference, differences
from lenstrace.compute.compiled import compiled
from lenstrace.compute.pytree import is_traced, pytree
from lenstrace.errors import RayError
from lenstrace.sequential.lens import Lens

POINTS = 41
# Of a fan.
MOST_POINTS = 10_001


@pytree
class Fan:
    """The rays along one line across the pupil, of F fields and W wavelengths, N each.

    x, y:  transverse aberration, mm: where a ray meets the image surface, from the image point; of an afocal lens the
           angles between a ray and the image point's, radians. (F, W, N)
    opd:   optical path difference from the reference sphere, wavelengths; see `path_difference`. (F, W, N)
    A ray that does not arrive is nan in all three.
    """

    x: jax.Array
    y: jax.Array
    opd: jax.Array


@pytree
class Fans:
    """Both fans of F fields and W wavelengths.

    pupil:       (N,), from -1 to 1, in units of the pupil's radius.
    tangential:  along the pupil's y, in the plane of a field in y; sagittal: along its x.
    """

    pupil: jax.Array
    tangential: Fan
    sagittal: Fan


def fans(lens: Lens, *, points: int = POINTS, reference: str = "primary") -> Fans:
    """The ray fans of every field and wavelength of a lens.

    points:     of each fan, odd, so that the chief ray is among them (RayError).
    reference:  the image point: "primary" is where the chief ray of the primary wavelength arrives, so that lateral
                colour is seen; "chief" that of each wavelength; "best" as "chief", with the path differences from the
                sphere of least RMS along the two lines.
    For an afocal lens the path differences are from a plane. LostRaysError where a chief ray is lost,
    or all rays are.
    """
    check_reference(reference)
    whole = isinstance(points, int | np.integer) and not isinstance(points, bool)
    if not whole or not 3 <= points <= MOST_POINTS or points % 2 == 0:
        raise RayError(
            f"points of a fan must be an odd whole number, at least 3 and at most {MOST_POINTS}, got {points!r}"
        )
    along, none = np.linspace(-1, 1, points), np.zeros(points)
    arrived = image_rays(lens, np.append(none, along), np.append(along, none))
    result = _fans(arrived, Sphere(reference))
    if not is_traced(result):
        check_light(np.isfinite([result.tangential.opd, result.sagittal.opd]))
    return result


@compiled
def _fans(arrived: ImageRays, sphere: Sphere) -> Fans:
    found = differences(arrived, sphere)
    points = found.opd.shape[-1] // 2

    def fan(part: slice) -> Fan:
        lives = found.failure[..., part] == 0
        return Fan(*(jnp.where(lives, a[..., part], jnp.nan) for a in (found.x, found.y, found.opd)))

    first, second = slice(0, points), slice(points, None)
    return Fans(jnp.asarray(arrived.pupil_y)[0, first], fan(first), fan(second))
