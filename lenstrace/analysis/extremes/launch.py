"""How far a launched ray is from the judge's in front of the lens, and how it depends on what it is launched by.

The numbers that go in are those of the document, the field and the point of the pupil. What rounding adds is known to
the ray's own size at the first vertex: the distance of the object is no scale of it, and enters by its condition
number alone.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any

import jax
import numpy as np

from lenstrace.analysis.extremes.errors import worst_ratio
from lenstrace.analysis.extremes.moves import DIGITS
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.reference_launch import reference_launch
from lenstrace.sequential.reference_surface import Vector, exact, mp

LAUNCH_STEP = 2.0**-20  # relative, of the numbers that a launch depends on
TINY = 1e-20  # of field and pupil, for derivatives


@dataclasses.dataclass(frozen=True)
class JudgedLaunch:
    """A ray in front of the lens as the judge launches it.

    values:     (6,), point (mm) and direction.
    condition:  (6,), sum over all numbers that go in of |change of the ray / relative change of the number|.
    slopes:     (6, 4), derivatives by field x and y (radians or mm) and pupil x and y.
    nearby:     the same where all numbers are moved by an eps of the precision, and by its opposite.
    angular:    True where fields are angles.

    A lens may stand where a change one way turns the ray round, as where the pupil goes through infinity: of a change
    either way the smaller one counts.
    """

    values: Vector
    condition: np.ndarray
    slopes: np.ndarray
    nearby: tuple[np.ndarray, np.ndarray]
    angular: bool

    def field_size(self, length: float) -> float:
        """Of a field of about 1, or as long as this."""
        return 1.0 if self.angular else length


def judged_launch(lens: Lens, launched: np.ndarray, precision: str) -> JudgedLaunch:
    """launched: (4,), field x and y (in the lens's unit) and pupil x and y, as the tracer was given them."""
    # the document with the numbers that the compiled system has
    lens = jax.tree.map(lambda value: float(np.asarray(value).astype(precision)), lens)
    scale = float(lens.fields.scale)
    field = [float((value * scale).astype(precision)) for value in launched[:2].astype(float)]
    given = np.array([*field, *launched[2:].astype(precision).astype(float)])
    numbers, tree = jax.tree.flatten(lens)
    count = len(numbers)
    eps = float(np.finfo(precision).eps)
    signs = np.random.default_rng(0).choice([-1.0, 1.0], count + 4)

    def ray(parts: np.ndarray, shift: Sequence[Any] = (0, 0, 0, 0)) -> Vector:
        """Where numbers are moved by parts of themselves; field and pupil are then shifted too."""
        document = tree.unflatten([number * (1 + p) for number, p in zip(numbers, parts[:count], strict=True)])
        at = [exact(x) * (1 + exact(p)) + s for x, p, s in zip(given, parts[count:], shift, strict=True)]
        of_field = [x / exact(scale) for x in at[:2]]
        return np.concatenate(reference_launch(document, of_field, at[2:], DIGITS))

    def slopes(parts: np.ndarray) -> np.ndarray:
        here, tiny = ray(parts), exact(TINY)
        return np.stack([(ray(parts, tiny * axis) - here) / tiny for axis in np.eye(4, dtype=int)], -1).astype(float)

    def changes(true: Vector) -> Iterator[np.ndarray]:
        for i, number in enumerate([*numbers, *given]):
            if number and np.isfinite(number):
                part = np.zeros(count + 4)
                part[i] = LAUNCH_STEP
                yield np.minimum(*(np.abs(ray(p) - true).astype(float) for p in (part, -part)))

    with mp.workdps(DIGITS):
        unmoved = np.zeros(count + 4)
        values = ray(unmoved)
        condition = np.sum([np.zeros(6), *changes(values)], 0) / LAUNCH_STEP
        nearby = slopes(eps * signs), slopes(-eps * signs)
        return JudgedLaunch(values, condition, slopes(unmoved), nearby, lens.fields.kind == "angle")


def launch_error(judged: JudgedLaunch, start: np.ndarray, eps: float) -> float:
    """C of a launched ray (6,), point and direction in front of the lens."""
    with mp.workdps(DIGITS):
        error = np.array([float(abs(a - exact(b))) for a, b in zip(judged.values, start, strict=True)])
        length = float(max(map(abs, judged.values[:3])))
    return worst_ratio(error, eps * (np.array([length] * 3 + [1.0] * 3) + judged.condition))
