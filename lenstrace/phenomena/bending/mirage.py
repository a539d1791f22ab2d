"""A mirage: over a hot road the index rises with height, and light from the sky or a car is bent up to the eye.

Rays are traced from the eye, against the light: some to where they turn and to where they are back at its height, and
many to an object, which is seen twice, the lower time upside down. See `hot_air` for the closed forms.
Source: M. Minnaert, Light and Color in the Outdoors (1993), for the phenomenon.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Annotated

import jax.numpy as jnp
import numpy as np

from lenstrace.errors import OptionError
from lenstrace.optics.graded import FLOOR, through
from lenstrace.optics.rays import Ray, living
from lenstrace.phenomena.bending.hot_air import Exponential, HotAir, Linear, fall_of, steepest
from lenstrace.phenomena.bending.tolerance import GROWTH, STEP_ERROR
from lenstrace.phenomena.demonstration import Comparison, Demonstration, result
from lenstrace.phenomena.options import Option, demonstration

PROFILES = {"exponential": Exponential, "linear": Linear}
RAYS = 61  # to the object; every few of them are drawn
SAMPLES = 201  # along each
GRAZING = 0.9999  # of the steepest angle that clears the road
TRIED = 2001  # angles, to find how much of the object to show
HIGHER = 1.1  # than the eye and than what is seen upside down, the object is shown
# Longer steps may pass over the layer, where it is thin and the object far, without meeting it.
FINE_STEPS = dataclasses.replace(STEP_ERROR, most=1e-9)
LONGER = 1.1  # than the closed form says, rays are followed


@result
class Mirage(Demonstration):
    """Rays from the eye to a distant object, traced against the light; lengths in m, they are those of a road.

    layer:           height of the warm layer.
    ray_z, ray_y:    (samples, N), the course of N rays from the eye, lowest first.
    angles:          (N,), at the eye above the horizontal, radians.
    heights, heights_theory:  (N,), where on the object they end.
    inverted:        (N,), True where a higher point of the object is seen lower.
    """

    layer: float
    ray_z: np.ndarray
    ray_y: np.ndarray
    angles: np.ndarray
    heights: np.ndarray
    heights_theory: np.ndarray
    inverted: np.ndarray


@demonstration
def mirage(
    profile: Annotated[str, Option("how n^2 rises with height", choices=tuple(PROFILES))] = "exponential",
    road: Annotated[float, Option("temperature of the road", "deg C", least=-50, most=200)] = 60.0,
    air: Annotated[float, Option("temperature of the air above", "deg C", least=-50, most=60)] = 30.0,
    layer: Annotated[float, Option("height of the warm layer", "m", least=0.02, most=5)] = 0.1,
    eye: Annotated[float, Option("height of the eye", "m", least=0.1, most=10)] = 1.5,
    distance: Annotated[float, Option("distance of the object", "m", least=1, most=1e4, slider=(300, 2000))] = 500.0,
    angles: Annotated[tuple[float, ...], Option("rays of the table, downward", "deg", least=1e-3, most=30)] = (
        *(0.1, 0.25, 0.38),
    ),
    tolerance: Annotated[float, FINE_STEPS] = 1e-12,
) -> Mirage:
    """A mirage over a hot road: rays that turn before they reach it, and an image upside down.

    OptionError where the road is not the warmer, a ray of the table ends on it, or the object is too near; and in the
    linear profile, where n^2 rises without end, for an eye or an object that would be above the layer.
    """
    if road <= air:
        raise OptionError(f"mirage: the road must be warmer than the air, got {road:g} and {air:g} deg C")
    if profile == "linear" and eye > layer:
        raise OptionError(
            f"mirage: in a linear profile the eye must be within the layer, got eye {eye:g} m and layer {layer:g} m; "
            "raise the layer, or lower the eye"
        )
    hot = PROFILES[profile](fall_of(road, air), layer)
    limit = steepest(hot, eye)
    below = np.radians(angles)
    if below.max() >= limit:
        raise OptionError(
            f"mirage: the ray at {math.degrees(below.max()):.4g} deg ends on the road; keep all below "
            f"{math.degrees(limit):.4g} deg"
        )
    nearest = hot.paths(eye, np.array([limit]), distance).turn[0]
    if distance <= nearest:
        raise OptionError(
            f"mirage: no ray is bent upward before the object {distance:g} m away; put it farther than {nearest:.4g} m"
        )
    seen = _seen(hot, eye, distance, GRAZING * limit)
    theory = hot.paths(eye, below, distance)
    of_object = hot.paths(eye, -seen, distance)

    count = len(below)

    def turned_or_back(points: np.ndarray, momenta: np.ndarray) -> np.ndarray:
        """Half of the rays end where they turn, the others where they are back at the height of the eye."""
        return np.concatenate([momenta[1, :count], points[1, count:] - eye])

    def at_object(points: np.ndarray, _: np.ndarray) -> np.ndarray:
        return points[2] - distance

    back_at = 2 * theory.turn
    reach = LONGER * (back_at / theory.invariant).max()
    # of the height behind a whole course, which moves the place where a flat ray is back
    height_error = eye + FLOOR * reach + back_at * (FLOOR + np.sin(below))
    back_error = back_at + height_error / np.tan(below)
    table = through(hot, _from_eye(eye, -np.tile(below, 2)), reach, turned_or_back, tolerance=tolerance)
    reach = LONGER * distance / of_object.invariant.min()
    # the closed form says how far an error of the angle carries
    carried = abs(np.gradient(of_object.height, seen)) * (FLOOR + abs(np.sin(seen)))
    object_error = (eye + of_object.height + FLOOR * reach + carried).max()
    drawn = through(hot, _from_eye(eye, seen), reach, at_object, tolerance=tolerance, samples=SAMPLES)

    turn, back = np.split(table.points[:, -1], 2, 1)
    invariant = (table.end_index * np.asarray(table.end.n))[count:]
    within = GROWTH * tolerance
    rows = []
    for i, angle in enumerate(angles):
        at = f"ray at {angle:.4g} deg"
        rows += [
            Comparison(f"{at}: height where it turns", "m", turn[1, i], theory.lowest[i], within * height_error[i]),
            Comparison(f"{at}: distance where it is back", "m", back[2, i], back_at[i], within * back_error[i]),
            Comparison(f"{at}: n cos t there", "", invariant[i], theory.invariant[i], within),
        ]
    heights = drawn.points[1, -1]
    off = abs(heights - of_object.height).max()
    rows.append(
        Comparison("largest departure of a ray from its height on the object", "m", off, 0, within * object_error)
    )
    return Mirage(
        setting=f"a road at {road:g} deg C, air at {air:g} deg C, {profile} in a layer of {layer:g} m; an eye "
        f"{eye:g} m high, an object {distance:g} m away",
        rows=tuple(rows),
        layer=layer,
        ray_z=drawn.points[2],
        ray_y=drawn.points[1],
        angles=seen,
        heights=heights,
        heights_theory=of_object.height,
        inverted=np.gradient(heights, seen) < 0,
    )


def _from_eye(eye: float, angles: np.ndarray) -> Ray:
    """Rays at angles above the horizontal."""
    zero = np.zeros(len(angles))
    return living(*map(jnp.asarray, (zero, zero + eye, zero, zero, np.sin(angles), np.cos(angles))))


def _seen(hot: HotAir, eye: float, distance: float, limit: float) -> np.ndarray:
    """Angles above the horizontal, radians, (RAYS,), under which the object is seen: from the steepest to where the
    upright image reaches higher than the inverted one, and than the eye, or to the top of the profile."""
    tried = np.linspace(-limit, limit + math.atan(2 * eye / distance), TRIED)
    heights = hot.paths(eye, -tried, distance).height
    if heights[:2].max() > hot.top:
        raise OptionError(
            f"mirage: an object {distance:g} m away is seen only above the layer of {hot.top:g} m; put it nearer"
        )
    upright = np.arange(TRIED) > heights.argmin()
    high = upright & (heights > min(HIGHER * max(heights[0], eye), hot.top))
    last = high.argmax() if high.any() else TRIED
    return np.linspace(-limit, tried[last - 1], RAYS)
