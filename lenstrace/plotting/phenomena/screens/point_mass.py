"""The two images of a star behind a mass, and how much brighter they are than the star."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from lenstrace.phenomena.screens.point_mass import PointMass
from lenstrace.plotting.colours import AXIS, PALETTE


def plot_sky(found: PointMass, axes: Axes) -> Axes:
    """What is seen around the mass, in milliarcseconds."""
    turn = np.linspace(0, 2 * np.pi, 181)
    ring = {"color": AXIS, "linestyle": "--", "linewidth": 1, "label": "Einstein's ring"}
    axes.plot(found.einstein * np.cos(turn), found.einstein * np.sin(turn), **ring)
    axes.plot(0, 0, "o", color=PALETTE[5], label="the mass")
    if found.covers:
        # the rims of the two images are those of one ring
        outer, inner = found.images
        axes.fill(*np.concatenate([outer, inner[:, ::-1]], 1), color=PALETTE[0], linewidth=0, label="its image, a ring")
    else:
        for place, image in enumerate(found.images):
            axes.fill(*image, color=PALETTE[0], label="its two images" if place == 0 else None)
    axes.fill(*found.edge, color=PALETTE[4], alpha=0.6, label="the star, without the mass")
    axes.set(xlabel="x on the sky, mas", ylabel="y on the sky, mas", title="What is seen")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(fontsize="small", loc="upper left", bbox_to_anchor=(0, -0.14), ncols=2, frameon=False)
    return axes


def plot_magnification(found: PointMass, axes: Axes) -> Axes:
    """The light of both images over that of the star, against where the star is."""
    axes.plot(found.positions, found.magnification_theory, color=PALETTE[0], label="theory")
    axes.plot(found.positions, found.magnification, "o", color=PALETTE[1], markersize=4, label="traced")
    axes.set(
        xlabel="star from the line through the mass, Einstein's angles",
        ylabel="magnification of its light",
        title="Microlensing",
        yscale="log",
    )
    axes.grid(alpha=0.3, which="both")
    axes.legend()
    return axes


PANELS = (plot_sky, plot_magnification)
