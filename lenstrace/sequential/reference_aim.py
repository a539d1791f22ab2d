"""The judge's chief ray: through the middle of the stop where rays are aimed, of the paraxial entrance pupil else."""

from __future__ import annotations

from collections.abc import Sequence

from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference import GUARD_DIGITS, reference_trace
from lenstrace.sequential.reference_launch import reference_launch
from lenstrace.sequential.reference_surface import Number, Vector, mp, unit, vector

# Newton's steps: each doubles the digits of a start that has ten.
STEPS = 4
# Of differences, as a share of the digits.
DIFFERENCE = 0.4


def reference_chief(
    lens: Lens, field: Sequence[float], near: Sequence[float], digits: int = 50
) -> tuple[Vector, Vector]:
    """Point (mm) and direction of the chief ray of a field, x and y in degrees or mm, at the primary wavelength.

    near: a point of it to some ten digits, mm, from where the ray is sought if it is aimed; it is not used otherwise.
    """
    start, direction = reference_launch(lens.replace(ray_aiming=False), field, (0.0, 0.0), digits)
    if not lens.ray_aiming:
        return start, direction
    with mp.workdps(digits + GUARD_DIGITS):
        step = mp.mpf(10) ** -int(DIFFERENCE * digits)
        source = None
        if lens.object_distance is not None:
            source = start + (-mp.mpf(float(lens.object_distance)) - start[2]) / direction[2] * direction

        def through(point: Vector) -> tuple[Vector, Vector]:
            return point, direction if source is None else unit(point - source)

        def at_stop(point: Vector) -> tuple[Number, Number]:
            row = reference_trace(lens, *through(point), None, digits)[lens.stop]
            return row.x, row.y

        point = vector(*near)
        for _ in range(STEPS):
            (x, y), (xa, ya), (xb, yb) = (
                at_stop(point + shift) for shift in (vector(0, 0, 0), vector(step, 0, 0), vector(0, step, 0))
            )
            a, b, c, d = (xa - x) / step, (xb - x) / step, (ya - y) / step, (yb - y) / step
            point = point - vector(d * x - b * y, a * y - c * x, 0) / (a * d - b * c)
        return through(point)
