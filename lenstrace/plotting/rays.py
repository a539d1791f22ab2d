"""Traced rays in the y-z plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lenstrace.optics.rays import Ray
from lenstrace.sequential.lens import Lens
from lenstrace.sequential.vertices import vertices

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_rays(path: Ray, lens: Lens, axes: Axes | None = None, *, color: str = "tab:blue") -> Axes:
    """The rays that `trace` followed through a lens, from the launch to the image or to where they failed.

    path:  with all surfaces along its leading axis.      lens: tells where each surface stands.
    axes:  such as those of `plot_layout`; new ones by default.
    """
    if axes is None:
        from matplotlib import pyplot

        axes = pyplot.subplots(figsize=(9, 4), layout="constrained")[1]
        axes.set(xlabel="z, mm", ylabel="y, mm", title="Rays", aspect="equal")
    rotation, origin = (np.asarray(part) for part in vertices(lens.system))
    rotation, origin = np.concatenate([np.eye(3)[None], rotation]), np.concatenate([np.zeros((1, 3)), origin])
    points = np.stack([np.asarray(part).reshape(len(origin), -1) for part in (path.x, path.y, path.z)], 1)
    places = rotation @ points + origin[:, :, None]
    failed_at = np.asarray(path.surface[-1]).reshape(-1)
    for ray, failed in enumerate(failed_at):
        last = len(origin) if failed == 0 else failed
        axes.plot(places[:last, 2, ray], places[:last, 1, ray], color=color, linewidth=1.0)
    return axes
