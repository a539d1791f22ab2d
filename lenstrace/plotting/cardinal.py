"""The cardinal points of a lens on its axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lenstrace.sequential.paraxial import FirstOrder

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_first_order(points: FirstOrder, axes: Axes | None = None, *, wavelength: int = 0) -> Axes:
    """F, F', N, N' as marks on the axis, H, H' as dashed lines across it; z in mm from the first vertex.

    points: what `first_order` gives.      wavelength: place in the lens's wavelengths.
    axes:   such as those of `plot_layout`; new ones by default. Points at infinity are left out.
    """
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.subplots(figsize=(9, 2.5), layout="constrained")[1]
        axes.axhline(0, color="grey", linewidth=0.8, linestyle="-.")
        axes.set(xlabel="z, mm", ylabel="y, mm", title="Cardinal points")
    rear = float(np.asarray(points.rear_vertex)[wavelength])
    fronts, rears = [], []
    for letter, kind in (("F", "focal_point"), ("H", "principal_plane"), ("N", "nodal_point")):
        for side, start, sign, found in (("front", 0.0, "", fronts), ("rear", rear, "'", rears)):
            z = start + float(np.asarray(getattr(points, f"{side}_{kind}"))[wavelength])
            if not np.isfinite(z):
                continue
            if letter == "H":
                axes.axvline(z, color="black", linewidth=0.9, linestyle="--")
            else:
                axes.plot(z, 0, "ko" if letter == "F" else "kx", markersize=5)
            found.append((z, letter + sign))
    for found, height in ((fronts, 8), (rears, -14)):
        for z, label in _merged(found):
            axes.annotate(label, (z, 0), xytext=(3, height), textcoords="offset points", fontsize=9)
    return axes


def _merged(found: list[tuple[float, str]]) -> list[tuple[float, str]]:
    """Labels of points that coincide, such as H and N in air, written as one."""
    places: dict[float, list[str]] = {}
    for z, label in found:
        near = next((place for place in places if abs(place - z) <= 1e-9 * (1 + abs(z))), z)
        places.setdefault(near, []).append(label)
    return [(z, ", ".join(labels)) for z, labels in places.items()]
