"""Spot diagrams: where the rays of each field and wavelength meet the image surface, and how far they scatter."""

from __future__ import annotations

import numpy as np

from lenstrace.analysis.arrivals import Asked, arrivals
from lenstrace.analysis.conditions import with_image
from lenstrace.analysis.spot_accuracy import accurate_spots
from lenstrace.analysis.spot_figures import Spots, figures, loss_text, place
from lenstrace.analysis.vignetting import Vignetting
from lenstrace.compute.pytree import is_traced
from lenstrace.errors import LostRaysError, RayError
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.sampling import pupil_points


def spots(
    lens: Lens,
    *,
    pattern: str = "hexapolar",
    rings: int = 6,
    vignetting: Vignetting | None = None,
    tolerance: float | None = None,
) -> Spots:
    """The spots of every field and wavelength of a lens.

    pattern, rings: how the pupil is sampled, see `pupil_points`.
    vignetting:     see `vignetting`, of this lens; of each field the part of the pupil that it fills is sampled then.
    tolerance:      relative error of each RMS about a centroid, against the integral over the open pupil: rays are then
                    chosen by need, not by pattern, rings and vignetting, and `Spots.error` says how far each may be
                    off.
    LostRaysError where no ray of a field arrives, ImageError where the image is at infinity.
    """
    if tolerance is not None:
        if (pattern, rings, vignetting) != ("hexapolar", 6, None):
            raise RayError("a tolerance chooses the rays by itself: give it without pattern, rings and vignetting")
        return accurate_spots(lens, tolerance)
    if vignetting is not None and np.shape(vignetting.top) != (len(lens.fields.y),):
        raise RayError(f"vignetting is of {np.size(vignetting.top)} fields, the lens has {len(lens.fields.y)}")
    system, front = with_image(lens, "a spot")
    points = pupil_points(pattern, rings)
    x, y = (points.x, points.y) if vignetting is None else vignetting.inside(points.x, points.y)
    arrived = arrivals(Asked(front, system.light, place), system.fields, x, y)
    result = figures(arrived, points.weight.astype(system.curvature.dtype), system.weights, system.primary)
    if not is_traced(result):
        check_arrivals(lens, result)
    return result


def check_arrivals(lens: Lens, result: Spots) -> None:
    """LostRaysError for the first field and wavelength none of whose rays arrives."""
    lost = np.asarray(result.lost)
    if (lost < result.rays).all():
        return
    field, wave = (int(i) for i in np.argwhere(lost == result.rays)[0])
    losses = result.losses(field, wave)
    before_stop = all(surface <= lens.stop for surface, _ in losses)
    stop = f", none reaches the stop (surface {lens.stop})" if before_stop else ""
    where = f"({float(lens.fields.x[field]):g}, {float(lens.fields.y[field]):g}) {lens.fields.unit}"
    raise LostRaysError(
        f"field {where} at {lens.wavelengths.um[wave]:g} um: all {result.rays} rays are lost{stop}: "
        f"{loss_text(losses)}; check its apertures, or reduce the field or the pupil"
    )
